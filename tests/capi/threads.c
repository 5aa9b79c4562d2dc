/* Servo loops ask for forces of two tools while another thread attaches and detaches one of them. Prints
 * nothing and returns 0 where all is as it should be; ThreadSanitizer and AddressSanitizer see the rest.
 * Argument: the folder data/. */
#define _POSIX_C_SOURCE 200809L /* nanosleep() */
#include <lobe_c.h>
#include <pthread.h>
#include <stdio.h>
#include <time.h>

static const char* scene =
    "{\"mesh\": \"meshes/liver_2k.vtu\", \"materials\": [{\"lame_lambda\": 4e4, \"lame_mu\": 1e4}],"
    " \"boundary\": [{\"fix\": true, \"where\": {\"box\": {\"min\": [-1, 0.015, -1], \"max\": [-0.02, 1, "
    "1]}}}],"
    " \"time\": {\"damping\": 20}}";

typedef struct servo {
  lobe_session* session;
  const double* at; /* where its tool has taken hold */
  uint32_t tool;
  int* ends;
  long felt, not_led, wrong;
} servo;

static void* feel(void* argument) {
  servo* mine = argument;
  double v[3] = {0, 0, 0}, f[3];
  while (!__atomic_load_n(mine->ends, __ATOMIC_ACQUIRE)) {
    switch (lobe_haptic_force(mine->session, mine->tool, mine->at, v, f)) {
      case LOBE_OK:
        __atomic_fetch_add(&mine->felt, 1, __ATOMIC_RELAXED);
        break;
      case LOBE_WRONG_STATE:
        ++mine->not_led;
        break;
      default:
        ++mine->wrong;
    }
  }
  return NULL;
}

/* Waits until it has felt a force again; 0 if it does not within 10 s. */
static int feels_again(servo* one) {
  const long before = __atomic_load_n(&one->felt, __ATOMIC_RELAXED);
  const struct timespec pause = {0, 100000};
  for (int i = 0; i < 100000; ++i) {
    if (__atomic_load_n(&one->felt, __ATOMIC_RELAXED) > before) return 1;
    nanosleep(&pause, NULL);
  }
  return 0;
}

int main(int argc, char** argv) {
  lobe_session* session = NULL;
  lobe_options options = {.size = sizeof options, .unpaced = 1};
  if (argc != 2 || lobe_open_text(scene, argv[1], &options, &session) != LOBE_OK) return 2;
  const double points[2][3] = {{0.082, -0.045, 0.035}, {0.03, -0.06, 0.03}};
  int ends = 0, failures = 0;
  servo servos[2] = {{session, points[0], 1, &ends, 0, 0, 0}, {session, points[1], 2, &ends, 0, 0, 0}};
  pthread_t threads[2];
  for (int i = 0; i < 2; ++i) {
    failures += lobe_grasp(session, servos[i].tool, points[i], 0.02) != LOBE_OK;
    failures += lobe_haptic_attach(session, servos[i].tool, NULL) != LOBE_OK;
  }
  failures += lobe_start(session) != LOBE_OK;
  for (int i = 0; i < 2; ++i) failures += pthread_create(&threads[i], NULL, feel, &servos[i]) != 0;
  for (int i = 0; i < 50; ++i) {
    failures += lobe_haptic_detach(session, 1) != LOBE_OK;
    failures += lobe_haptic_detach(session, 1) != LOBE_WRONG_STATE;
    failures += lobe_haptic_attach(session, 1, NULL) != LOBE_OK;
    failures += !feels_again(&servos[0]);
  }
  __atomic_store_n(&ends, 1, __ATOMIC_RELEASE);
  for (int i = 0; i < 2; ++i) pthread_join(threads[i], NULL);
  lobe_close(session);
  if (failures || servos[0].wrong || servos[1].wrong || servos[1].not_led || !servos[1].felt ||
      !servos[0].felt)
    fprintf(stderr, "%d calls failed (%s); tool 1: %ld felt, %ld not led, %ld wrong; tool 2: %ld, %ld, %ld\n",
            failures, lobe_last_error(), servos[0].felt, servos[0].not_led, servos[0].wrong, servos[1].felt,
            servos[1].not_led, servos[1].wrong);
  return failures || servos[0].wrong || servos[1].wrong || servos[1].not_led || !servos[1].felt ||
         !servos[0].felt;
}
