/* A game of somebody else's in C: a second of the scene that it is given. */
#include <lobe_c.h>
#include <stdio.h>

int main(int argc, char** argv) {
  lobe_session* session;
  lobe_state state = {.size = sizeof state};
  if (argc != 2 || lobe_open(argv[1], NULL, &session) != LOBE_OK) {
    fprintf(stderr, "%s\n", lobe_last_error());
    return 1;
  }
  if (lobe_advance(session, 120) == LOBE_OK && lobe_get_state(session, &state) == LOBE_OK)
    printf("%.3f s, %u tetrahedra\n", state.time, state.tetrahedra);
  lobe_close(session);
  return 0;
}
