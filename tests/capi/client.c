/* A caller in C99: takes hold of the liver, lifts it, burns it, in the axes of Unity; and everything
 * that a caller can do wrong. Prints nothing and returns 0 where all is as it should be. Arguments: the
 * folder data/, a folder to write to. */
#include <lobe_c.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;
#define CHECK(condition)                                                                      \
  do {                                                                                        \
    if (!(condition)) {                                                                       \
      fprintf(stderr, "%s:%d: %s (%s)\n", __FILE__, __LINE__, #condition, lobe_last_error()); \
      ++failures;                                                                             \
    }                                                                                         \
  } while (0)

static const char* scene =
    "{\"mesh\": \"meshes/liver_2k.vtu\", \"materials\": [{\"lame_lambda\": 4e4, \"lame_mu\": 1e4, "
    "\"density\": 1000}],"
    " \"boundary\": [{\"fix\": true, \"where\": {\"box\": {\"min\": [-1, 0.015, -1], \"max\": [-0.02, 1, "
    "1]}}}],"
    " \"time\": {\"damping\": 20}}";

static double enclosed(const lobe_surface* s) { /* [m3], by the divergence theorem */
  double six = 0;
  for (uint32_t t = 0; t < s->triangles; ++t) {
    const float *a = s->position + 3 * s->index[3 * t], *b = s->position + 3 * s->index[3 * t + 1],
                *c = s->position + 3 * s->index[3 * t + 2];
    six += (double)a[0] * ((double)b[1] * c[2] - (double)b[2] * c[1]) +
           (double)a[1] * ((double)b[2] * c[0] - (double)b[0] * c[2]) +
           (double)a[2] * ((double)b[0] * c[1] - (double)b[1] * c[0]);
  }
  return six / 6;
}

/* Sews with a thread in a scene whose axes have y up and millimetres: a block of 80 x 60 x 12 mm. */
static void sew(const char* data) {
  static const char* block =
      "{\"mesh\": \"meshes/flank_5k.vtu\", \"materials\": [{\"lame_lambda\": 4e4, \"lame_mu\": 1e4}],"
      "\"boundary\": [{\"fix\": true, \"where\": {\"plane\": {\"point\": [0, 0, 0], \"normal\": [1, 0, 0],"
      "\"within\": 1e-6}}}], \"time\": {\"damping\": 20}}";
  const lobe_options options = {.size = sizeof options, .axes = {1e3, 0, 0, 0, 0, 0, 1e3, 0, 0, 1e3, 0, 0}};
  lobe_session* session = NULL;
  CHECK(lobe_open_text(block, data, &options, &session) == LOBE_OK);
  if (!session) return;
  const lobe_thread_material material = {.size = sizeof material, .strength = 20, .friction = -1};
  const double down[3] = {0, -1, 0}, left[3] = {30, 100, 30}, inside[3] = {50, 6, 30},
               outside[3] = {50, 17, 30}, above[3] = {40, 30, 30}, higher[3] = {40, 36, 30},
               up[3] = {0, 1, 0};
  CHECK(lobe_thread(session, 3, &material) == LOBE_OK);
  CHECK(lobe_bite_ray(session, 3, left, down, 6) == LOBE_OK);
  CHECK(lobe_bite(session, 3, outside) == LOBE_BAD_INPUT && strstr(lobe_last_error(), "0.005 m outside"));
  CHECK(lobe_bite_ray(session, 3, left, up, 6) == LOBE_BAD_INPUT && strstr(lobe_last_error(), "no tissue"));
  CHECK(lobe_bite_ray(session, 3, left, down, 20) == LOBE_BAD_INPUT && strstr(lobe_last_error(), "thinner"));
  CHECK(lobe_bite(session, 3, inside) == LOBE_OK);
  CHECK(lobe_pull_on(session, 3, up, 0.1, 20) == LOBE_BAD_INPUT);
  CHECK(lobe_pull(session, 3, above) == LOBE_OK && lobe_advance(session, 2) == LOBE_OK);
  CHECK(lobe_thread_lines(session, 0, NULL, NULL) == 3); /* from the hand, between the bites, to the hand */
  CHECK(lobe_pull(session, 3, higher) == LOBE_OK && lobe_advance(session, 40) == LOBE_OK);
  float ends[18], tensions[3];
  CHECK(lobe_thread_lines(session, 3, ends, tensions) == 3);
  CHECK(tensions[0] > 0 && fabsf(ends[0] - 40) < 0.01f && fabsf(ends[1] - 36) < 0.01f);
  CHECK(!memcmp(ends + 3, ends + 6, 3 * sizeof(float)) && !memcmp(ends, ends + 15, 3 * sizeof(float)));
  CHECK(ends[4] < ends[1] && fabsf(ends[5] - 30) < 2); /* the first bite */
  CHECK(lobe_tie(session, 3, 0, -1, 2, 0.05) == LOBE_OK && lobe_advance(session, 20) == LOBE_OK);
  CHECK(lobe_thread_lines(session, 3, ends, tensions) == 2 && tensions[0] > 0);
  CHECK(lobe_cut_thread(session, 3, 0) == LOBE_OK && lobe_tie(session, 3, 0, 1, 0, 0) == LOBE_OK);
  CHECK(lobe_advance(session, 1) == LOBE_OK);
  char text[2000];
  lobe_messages(session, 0, text, sizeof text);
  CHECK(strstr(text, "what is cut cannot be tied"));
  CHECK(lobe_remove_thread(session, 3) == LOBE_OK && lobe_advance(session, 1) == LOBE_OK);
  CHECK(lobe_thread_lines(session, 3, ends, tensions) == 0);
  CHECK(lobe_remove_thread(session, 4) == LOBE_BAD_INPUT && lobe_pull(session, 3, NULL) == LOBE_OK);
  const lobe_thread_material limp = {.size = sizeof limp, .stiffness = -1};
  CHECK(lobe_thread(session, 5, &limp) == LOBE_BAD_INPUT && strstr(lobe_last_error(), "stiffness above 0"));
  CHECK(lobe_thread(NULL, 5, NULL) == LOBE_BAD_INPUT && lobe_thread_lines(NULL, 0, NULL, NULL) == 0);
  CHECK(lobe_bite(session, 3, NULL) == LOBE_BAD_INPUT &&
        lobe_pull_on(session, 3, NULL, 1, 1) == LOBE_BAD_INPUT);
  lobe_close(session);
}

/* A needle is turned through a block, whose top is at 12 mm, and its thread is tied. */
static void sew_with_needle(const char* data) {
  static const char* block =
      "{\"mesh\": \"meshes/flank_5k.vtu\", \"materials\": [{\"lame_lambda\": 4e4, \"lame_mu\": 1e4}],"
      "\"boundary\": [{\"fix\": true, \"where\": {\"plane\": {\"point\": [0, 0, 0], \"normal\": [0, 0, 1],"
      "\"within\": 1e-6}}}], \"time\": {\"damping\": 40}}";
  lobe_session* session = NULL;
  CHECK(lobe_open_text(block, data, NULL, &session) == LOBE_OK);
  if (!session) return;
  CHECK(lobe_bring(session, 4,
                   "{\"type\": \"needle\", \"radius\": 0.01, \"puncture\": 0, \"friction\": 20, "
                   "\"at\": [0.04, 0.03, 0.015]}") == LOBE_BAD_INPUT &&
        strstr(lobe_last_error(), "/puncture: 0, must be above 0"));
  CHECK(lobe_bring(session, 4,
                   "{\"type\": \"needle\", \"radius\": 0.01, \"puncture\": 0.2, \"friction\": 20, "
                   "\"thread\": 3, \"at\": [0.0403, 0.0302, 0.015, 0, -0.7071067811865476, "
                   "0.7071067811865476, 0]}") == LOBE_OK);
  double most = 0; /* force on the needle [N] */
  for (int i = 1; i <= 60; ++i) {
    const double half = acos(-1.0) * i / 60.0; /* of the turn about -y since it was brought */
    const double pose[7] = {0.0403, 0.0302, 0.015, 0, -sin(half), 0, cos(half)};
    lobe_tool needle = {.size = sizeof needle};
    CHECK(lobe_move(session, 4, pose) == LOBE_OK && lobe_advance(session, 1) == LOBE_OK);
    CHECK(lobe_get_tool(session, 4, &needle) == LOBE_OK);
    most = fmax(most, hypot(needle.force[0], needle.force[2]));
  }
  CHECK(most > 0.1 && most < 1);
  CHECK(lobe_advance(session, 20) == LOBE_OK);
  char text[2000];
  lobe_messages(session, 0, text, sizeof text);
  CHECK(strstr(text, "has gone in, at 0.2") && strstr(text, "has come out, at 0.2"));
  CHECK(lobe_thread_lines(session, 0, NULL, NULL) == 2); /* between the bites, and to the needle */
  CHECK(lobe_tie(session, 3, 0, 1, 0.002, 0.05) == LOBE_OK && lobe_release(session, 4) == LOBE_OK);
  CHECK(lobe_advance(session, 10) == LOBE_OK);
  float ends[18], tensions[3] = {0};
  CHECK(lobe_thread_lines(session, 3, ends, tensions) == 2 && tensions[0] > 0);
  lobe_close(session);
}

/* Names of bodies, and the body of each triangle. */
static void two_bodies(const char* data) {
  static const char* organs =
      "{\"bodies\": [{\"name\": \"left\", \"mesh\": \"meshes/beam_1k.vtu\"},"
      "{\"name\": \"right\", \"mesh\": \"meshes/beam_1k.vtu\", \"position\": [0.2, 0, 0]}],"
      "\"materials\": [{\"lame_lambda\": 4e4, \"lame_mu\": 1e4}], \"contact\": {\"self\": true}}";
  lobe_session* session = NULL;
  CHECK(lobe_open_text(organs, data, NULL, &session) == LOBE_OK);
  if (!session) return;
  CHECK(lobe_body_count(session) == 2 && lobe_body_count(NULL) == 0);
  CHECK(!strcmp(lobe_body_name(session, 0), "left") && !strcmp(lobe_body_name(session, 1), "right"));
  CHECK(!strcmp(lobe_body_name(session, 2), "") && !strcmp(lobe_body_name(NULL, 0), ""));
  lobe_surface surface = {.size = sizeof surface};
  CHECK(lobe_surface_bodies(&surface) == NULL && lobe_surface_bodies(NULL) == NULL);
  CHECK(lobe_surface_acquire(session, &surface) == LOBE_OK);
  const uint8_t* body = lobe_surface_bodies(&surface);
  CHECK(body != NULL && surface.triangles > 0);
  uint32_t wrong = 0;
  for (uint32_t t = 0; body != NULL && t < surface.triangles; ++t)
    wrong += body[t] != (surface.position[3 * surface.index[3 * t]] > 0.15f);
  CHECK(wrong == 0);
  lobe_surface_release(session, &surface);
  CHECK(lobe_surface_bodies(&surface) == NULL);
  lobe_close(session);
}

/* The layout that callers in other languages have written down. */
static void layout(void) {
  CHECK(lobe_abi_version() == LOBE_ABI_VERSION);
  CHECK(sizeof(lobe_options) == 128 && offsetof(lobe_options, frame) == 8 &&
        offsetof(lobe_options, axes) == 32);
  CHECK(sizeof(lobe_state) == 40 && offsetof(lobe_state, time) == 16 && offsetof(lobe_state, running) == 32);
  CHECK(sizeof(lobe_tool) == 120 && offsetof(lobe_tool, pose) == 16 && offsetof(lobe_tool, force) == 72);
  CHECK(sizeof(lobe_surface) == 88 && offsetof(lobe_surface, position) == 40 &&
        offsetof(lobe_surface, owner) == 80);
}

static void lift_and_burn(const char* data, const char* folder) {
  lobe_session* session = NULL;
  CHECK(lobe_open_text(scene, data, NULL, &session) == LOBE_OK);
  if (!session) return;
  lobe_surface surface = {.size = sizeof surface};
  lobe_tool hand = {.size = sizeof hand};
  CHECK(lobe_surface_acquire(session, &surface) == LOBE_OK); /* of the body at the start */
  lobe_surface_release(session, &surface);
  const double point[3] = {0.082, -0.045, 0.035};
  CHECK(lobe_get_tool(session, 7, &hand) == LOBE_NOT_YET);
  CHECK(lobe_grasp(session, 7, point, 0.02) == LOBE_OK);
  CHECK(lobe_advance(session, 2) == LOBE_OK);
  CHECK(lobe_get_tool(session, 7, &hand) == LOBE_OK && hand.holds == 1 && hand.vertices > 3);
  for (int i = 1; i <= 120; ++i) {
    const double pose[7] = {point[0], point[1], point[2] + 0.02 * i / 120, 0, 0, 0, 1};
    CHECK(lobe_move(session, 7, pose) == LOBE_OK);
    CHECK(lobe_advance(session, 1) == LOBE_OK);
  }
  CHECK(lobe_advance(session, 60) == LOBE_OK);
  CHECK(lobe_get_tool(session, 7, &hand) == LOBE_OK);
  CHECK(hand.force[2] < -1 && hand.force[2] > -10); /* the body pulls it down */
  CHECK(fabs(hand.pose[2] - point[2] - 0.02) < 1e-3);

  CHECK(lobe_surface_acquire(session, &surface) == LOBE_OK);
  const uint64_t topology = surface.topology;
  const double before = enclosed(&surface);
  CHECK(before > 1e-4 && before < 5e-3);
  CHECK(surface.position && surface.cut && surface.cut[0] == 0);
  lobe_surface kept = surface;
  const float first = surface.position[0];
  const double tip[3] = {0.03, -0.06, 0.03};
  CHECK(lobe_cautery(session, 8, tip, 0.01) == LOBE_OK && lobe_switch(session, 8, 1) == LOBE_OK);
  CHECK(lobe_advance(session, 2) == LOBE_OK);
  for (int i = 1; i <= 40; ++i) {
    const double pose[7] = {tip[0], tip[1] + 0.001 * i, tip[2], 0, 0, 0, 1};
    CHECK(lobe_move(session, 8, pose) == LOBE_OK && lobe_advance(session, 1) == LOBE_OK);
  }
  memset(&surface, 0, sizeof surface);
  surface.size = sizeof surface;
  CHECK(lobe_surface_acquire(session, &surface) == LOBE_OK);
  CHECK(surface.topology > topology && enclosed(&surface) < before);
  CHECK(kept.position[0] == first); /* until it is released */
  lobe_surface_release(session, &kept);
  CHECK(kept.position == NULL);
  lobe_surface_release(session, &kept); /* twice: nothing */
  lobe_surface_release(session, &surface);

  CHECK(lobe_bring(session, 11,
                   "{\"type\": \"probe\", \"shape\": {\"sphere\": {\"radius\": 0}}, \"at\": [0, 0, 1]}") ==
            LOBE_BAD_INPUT &&
        strstr(lobe_last_error(), "/shape/sphere/radius") != NULL);
  CHECK(lobe_bring(session, 11, "{\"type\": \"grasp\", \"at\": [0, 0, 1]}") == LOBE_BAD_INPUT);
  CHECK(lobe_bring(session, 11, NULL) == LOBE_BAD_INPUT);
  CHECK(lobe_bring(session, 11,
                   "{\"type\": \"probe\", \"shape\": {\"sphere\": {\"radius\": 0.01}}, "
                   "\"at\": [0.03, -0.03, 0.3]}") == LOBE_OK);
  CHECK(lobe_advance(session, 2) == LOBE_OK);
  lobe_tool probe = {.size = sizeof probe};
  CHECK(lobe_get_tool(session, 11, &probe) == LOBE_OK && probe.force[2] == 0);
  double highest = 0; /* that the organ pushes the probe back up [N] */
  for (int i = 1; i <= 120 && highest == 0; ++i) {
    const double pose[7] = {0.03, -0.03, 0.3 - 0.004 * i, 0, 0, 0, 1};
    CHECK(lobe_move(session, 11, pose) == LOBE_OK && lobe_advance(session, 1) == LOBE_OK);
    if (lobe_get_tool(session, 11, &probe) == LOBE_OK && probe.force[2] > highest) highest = probe.force[2];
  }
  CHECK(highest > 0);
  CHECK(lobe_release(session, 11) == LOBE_OK && lobe_advance(session, 1) == LOBE_OK);

  const double from[3] = {0.05, -0.2, -0.2}, to[3] = {0.05, -0.2, 0.2};
  lobe_state uncut = {.size = sizeof uncut}, state = {.size = sizeof state};
  CHECK(lobe_get_state(session, &uncut) == LOBE_OK);
  CHECK(lobe_scalpel(session, 9, from, to) == LOBE_OK && lobe_switch(session, 9, 1) == LOBE_OK);
  CHECK(lobe_advance(session, 2) == LOBE_OK);
  for (int i = 1; i <= 80; ++i) {
    const double pose[7] = {from[0], from[1] + 0.005 * i, from[2], 0, 0, 0, 1};
    CHECK(lobe_move(session, 9, pose) == LOBE_OK && lobe_advance(session, 1) == LOBE_OK);
  }
  CHECK(lobe_get_state(session, &state) == LOBE_OK && state.tetrahedra > uncut.tetrahedra);
  CHECK(lobe_release(session, 9) == LOBE_OK && lobe_advance(session, 1) == LOBE_OK);

  state.size = sizeof state;
  CHECK(lobe_get_state(session, &state) == LOBE_OK && uncut.tetrahedra < 2103 && state.running == 1);
  CHECK(lobe_release(session, 7) == LOBE_OK && lobe_release(session, 8) == LOBE_OK &&
        lobe_advance(session, 1) == LOBE_OK);
  char file[4096];
  snprintf(file, sizeof file, "%s/kept.json", folder);
  CHECK(lobe_save_scene(session, file) == LOBE_OK);
  snprintf(file, sizeof file, "%s/kept.rec", folder);
  CHECK(lobe_save_recording(session, file) == LOBE_OK);
  CHECK(lobe_save_recording(session, "/nowhere/at/all") == LOBE_BAD_INPUT &&
        strstr(lobe_last_error(), "nowhere"));
  lobe_close(session);
}

static int by_bytes(const void* a, const void* b) { return memcmp(a, b, 3 * sizeof(float)); }

/* Positions of the surface's vertices in an order that is always the same: 3 per vertex, to be freed. */
static float* positions(lobe_session* session, uint32_t* count) {
  lobe_surface surface = {.size = sizeof surface};
  CHECK(lobe_surface_acquire(session, &surface) == LOBE_OK);
  *count = 3 * surface.vertices;
  float* copy = malloc(*count * sizeof *copy);
  if (copy) {
    memcpy(copy, surface.position, *count * sizeof *copy);
    qsort(copy, surface.vertices, 3 * sizeof *copy, by_bytes);
  }
  lobe_surface_release(session, &surface);
  return copy;
}

/* To the last bit. The numbers of vertices may differ: they depend on the order of cuts. */
static int same_surface(lobe_session* one, lobe_session* other) {
  uint32_t m = 0, n = 0;
  float *a = positions(one, &m), *b = positions(other, &n);
  const int same = a && b && m == n && memcmp(a, b, m * sizeof *a) == 0;
  free(a);
  free(b);
  return same;
}

static void pull(lobe_session* session, double up, uint32_t frames) {
  const double point[3] = {0.082, -0.045, 0.035};
  CHECK(lobe_grasp(session, 1, point, 0.02) == LOBE_OK && lobe_advance(session, 2) == LOBE_OK);
  const double pose[7] = {point[0], point[1], point[2] + up, 0, 0, 0, 1};
  CHECK(lobe_move(session, 1, pose) == LOBE_OK && lobe_advance(session, frames) == LOBE_OK);
}

/* Another session goes on from the saved state, after a cut, to the same bits. */
static void save_and_restore(const char* data, const char* folder) {
  char file[4096];
  snprintf(file, sizeof file, "%s/saved.lobe", folder);
  lobe_session *first = NULL, *second = NULL;
  CHECK(lobe_open_text(scene, data, NULL, &first) == LOBE_OK &&
        lobe_open_text(scene, data, NULL, &second) == LOBE_OK);
  if (!first || !second) return;
  const double tip[3] = {0.03, -0.06, 0.03};
  CHECK(lobe_cautery(first, 8, tip, 0.02) == LOBE_OK && lobe_switch(first, 8, 1) == LOBE_OK);
  pull(first, 0.01, 30);
  lobe_state state = {.size = sizeof state}, restored = {.size = sizeof restored};
  CHECK(lobe_get_state(first, &state) == LOBE_OK && state.tetrahedra < 2103);
  CHECK(lobe_save(first, file) == LOBE_OK);
  pull(second, -0.01, 7);
  CHECK(!same_surface(first, second));
  CHECK(lobe_restore(second, file) == LOBE_OK);
  CHECK(lobe_get_state(second, &restored) == LOBE_OK);
  CHECK(restored.time == state.time && restored.tetrahedra == state.tetrahedra);
  CHECK(same_surface(first, second)); /* at once, before any frame */
  lobe_tool hand = {.size = sizeof hand};
  CHECK(lobe_get_tool(second, 1, &hand) == LOBE_NOT_YET); /* it has let go */
  CHECK(lobe_advance(first, 9) == LOBE_OK && lobe_restore(first, file) == LOBE_OK);
  pull(first, 0.02, 20);
  pull(second, 0.02, 20);
  CHECK(same_surface(first, second));

  /* What cannot be restored changes nothing. */
  char other[4096];
  snprintf(other, sizeof other, "%s/other.rec", folder);
  CHECK(lobe_save_recording(first, other) == LOBE_OK && lobe_restore(first, other) == LOBE_BAD_INPUT);
  CHECK(lobe_restore(first, "no such state") == LOBE_BAD_INPUT && strstr(lobe_last_error(), "no such state"));
  CHECK(lobe_restore(first, NULL) == LOBE_BAD_INPUT && lobe_restore(NULL, file) == LOBE_BAD_INPUT);
  CHECK(lobe_save(first, NULL) == LOBE_BAD_INPUT && lobe_save(NULL, file) == LOBE_BAD_INPUT);
  CHECK(lobe_save(first, "/nowhere/at/all") == LOBE_BAD_INPUT);
  CHECK(same_surface(first, second));
  CHECK(lobe_start(second) == LOBE_OK && lobe_restore(second, file) == LOBE_OK &&
        lobe_stop(second) == LOBE_OK);
  lobe_close(first);
  lobe_close(second);
}

/* Forces on a hand that lifts the end of a beam and stays there: 0.5 s later, and 4.5 s later. */
static void forces_of_a_lift(const char* data, const char* series, double forces[2]) {
  char beam[600];
  snprintf(
      beam, sizeof beam,
      "{\"mesh\": \"meshes/beam_1k.vtu\", \"gravity\": [0, 0, 0],"
      " \"materials\": [{\"lame_lambda\": 2e4, \"lame_mu\": 1e4, \"viscosity\": %s}],"
      " \"boundary\": [{\"fix\": true, \"where\": {\"box\": {\"min\": [-1, -1, -1], \"max\": [0, 1, 1]}}}],"
      " \"time\": {\"damping\": 40}}",
      series);
  lobe_session* session = NULL;
  lobe_tool hand = {.size = sizeof hand};
  const double point[3] = {0.12, 0.015, 0.03};
  CHECK(lobe_open_text(beam, data, NULL, &session) == LOBE_OK);
  if (!session) return;
  CHECK(lobe_grasp(session, 1, point, 0.012) == LOBE_OK && lobe_advance(session, 2) == LOBE_OK);
  for (int i = 1; i <= 10; ++i) {
    const double pose[7] = {0.12, 0.015, 0.03 + 4e-4 * i, 0, 0, 0, 1};
    CHECK(lobe_move(session, 1, pose) == LOBE_OK && lobe_advance(session, 1) == LOBE_OK);
  }
  for (int i = 0; i < 2; ++i) {
    CHECK(lobe_advance(session, i == 0 ? 30 : 240) == LOBE_OK);
    CHECK(lobe_get_tool(session, 1, &hand) == LOBE_OK);
    forces[i] = -hand.force[2];
  }
  lobe_close(session);
}

/* A material with a Prony series pushes back harder at first, and in the end as one without. */
static void relaxation(const char* data) {
  double elastic[2] = {0, 0}, viscous[2] = {0, 0};
  forces_of_a_lift(data, "[{\"shear\": 1e-9, \"time\": 0.25}]", elastic);
  forces_of_a_lift(data, "[{\"shear\": 0.5, \"bulk\": 0.5, \"time\": 0.25}]", viscous);
  CHECK(elastic[0] > 0.01 && viscous[0] > 1.2 * elastic[0] && viscous[0] < 2 * elastic[0]);
  CHECK(fabs(elastic[1] - elastic[0]) < 0.05 * elastic[1]);
  CHECK(fabs(viscous[1] - elastic[1]) < 0.01 * elastic[1]);
  lobe_session* session = NULL;
  CHECK(lobe_open_text("{\"mesh\": \"meshes/beam_1k.vtu\", \"materials\": [{\"lame_lambda\": 2e4, "
                       "\"lame_mu\": 1e4, \"viscosity\": [{\"shear\": 1, \"time\": 0.1}]}]}",
                       data, NULL, &session) == LOBE_BAD_INPUT &&
        strstr(lobe_last_error(), "/materials/0/viscosity"));
}

/* In left-handed axes with y up, in centimetres, the same body has the same volume and the hand the same
 * force. */
static void other_axes(const char* data) {
  lobe_options options = {.size = sizeof options};
  const double axes[12] = {100, 0, 0, 5, 0, 0, 100, 6, 0, 100, 0, 7};
  memcpy(options.axes, axes, sizeof axes);
  lobe_session *plain = NULL, *turned = NULL;
  CHECK(lobe_open_text(scene, data, NULL, &plain) == LOBE_OK &&
        lobe_open_text(scene, data, &options, &turned) == LOBE_OK);
  if (!plain || !turned) return;
  const double here[3] = {0.082, -0.045, 0.035}, there[3] = {5 + 8.2, 6 + 3.5, 7 - 4.5};
  CHECK(lobe_grasp(plain, 1, here, 0.02) == LOBE_OK && lobe_grasp(turned, 1, there, 2) == LOBE_OK);
  CHECK(lobe_advance(plain, 2) == LOBE_OK && lobe_advance(turned, 2) == LOBE_OK);
  const double s = sin(0.1), c = cos(0.1); /* half of 0.2 about x: mirrored axes turn the other way */
  for (int i = 0; i < 60; ++i) {
    const double pose[7] = {here[0], here[1], here[2] + 0.01, s, 0, 0, c};
    const double other[7] = {there[0], there[1] + 1, there[2], -s, 0, 0, c};
    CHECK(lobe_move(plain, 1, pose) == LOBE_OK && lobe_move(turned, 1, other) == LOBE_OK);
    CHECK(lobe_advance(plain, 1) == LOBE_OK && lobe_advance(turned, 1) == LOBE_OK);
  }
  lobe_tool a = {.size = sizeof a}, b = {.size = sizeof b};
  CHECK(lobe_get_tool(plain, 1, &a) == LOBE_OK && lobe_get_tool(turned, 1, &b) == LOBE_OK);
  const double size = fabs(a.force[0]) + fabs(a.force[1]) + fabs(a.force[2]);
  CHECK(size > 0.1);
  CHECK(fabs(a.force[0] - b.force[0]) + fabs(a.force[2] - b.force[1]) + fabs(a.force[1] - b.force[2]) <
        1e-3 * size);
  const double turn = fabs(a.torque[0]) + fabs(a.torque[1]) + fabs(a.torque[2]);
  CHECK(fabs(a.torque[0] + b.torque[0]) + fabs(a.torque[2] + b.torque[1]) + fabs(a.torque[1] + b.torque[2]) <
        1e-3 * turn);
  CHECK(fabs(a.pose[3] + b.pose[3]) < 1e-6 && fabs(a.pose[6] - b.pose[6]) < 1e-6);
  lobe_surface p = {.size = sizeof p}, q = {.size = sizeof q};
  CHECK(lobe_surface_acquire(plain, &p) == LOBE_OK && lobe_surface_acquire(turned, &q) == LOBE_OK);
  CHECK(p.vertices == q.vertices);
  /* Mirrored, with the triangles turned round for left-handed axes: the sign changes twice. */
  double far = 0;
  for (uint32_t v = 0; v < p.vertices; ++v) {
    far = fmax(far, fabs(5 + 100.0 * p.position[3 * v] - q.position[3 * v]));
    far = fmax(far, fabs(6 + 100.0 * p.position[3 * v + 2] - q.position[3 * v + 1]));
    far = fmax(far, fabs(p.normal[3 * v + 1] - q.normal[3 * v + 2]));
  }
  CHECK(far < 1e-2);
  CHECK(fabs(enclosed(&q) * 1e-6 / enclosed(&p) - 1) < 1e-3);
  lobe_surface_release(plain, &p);
  lobe_surface_release(turned, &q);
  lobe_close(plain);
  lobe_close(turned);
}

static void own_thread(const char* data) {
  lobe_options options = {.size = sizeof options};
  options.unpaced = 1;
  lobe_session* session = NULL;
  CHECK(lobe_open_text(scene, data, &options, &session) == LOBE_OK);
  if (!session) return;
  CHECK(lobe_start(session) == LOBE_OK);
  CHECK(lobe_start(session) == LOBE_WRONG_STATE && strstr(lobe_last_error(), "own thread"));
  CHECK(lobe_advance(session, 1) == LOBE_WRONG_STATE);
  lobe_state state = {.size = sizeof state};
  for (long i = 0; i < 400000000L && !(lobe_get_state(session, &state) == LOBE_OK && state.frame > 20); ++i) {
  }
  CHECK(state.frame > 20 && state.time > 0.1);
  CHECK(lobe_stop(session) == LOBE_OK && lobe_stop(session) == LOBE_OK &&
        lobe_advance(session, 1) == LOBE_OK);
  lobe_close(session);
}

/* Each option within its bounds opens a session, beyond them none; *session is NULL then. */
static void bounds_of_options(const char* data) {
  const struct {
    double frame, speed;
    uint32_t threads;
    const char* field; /* at fault; NULL: none */
  } cases[] = {
      {1, 0, 0, NULL},        {1e-4, 0.001, 2, NULL},
      {0, 100, 256, NULL},    {1.001, 0, 0, "frame"},
      {1e9, 0, 0, "frame"},   {-1, 0, 0, "frame"},
      {NAN, 0, 0, "frame"},   {INFINITY, 0, 0, "frame"},
      {0, 1e9, 0, "speed"},   {0, 0.0009, 0, "speed"},
      {0, -1, 0, "speed"},    {0, NAN, 0, "speed"},
      {0, 0, 257, "threads"}, {0, 0, 0xffffffffu, "threads"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    lobe_options options = {.size = sizeof options};
    options.frame = cases[i].frame;
    options.speed = cases[i].speed;
    options.threads = cases[i].threads;
    options.paused = 1;
    char garbage;
    lobe_session* session = (lobe_session*)&garbage;
    const lobe_status status = lobe_open_text(scene, data, &options, &session);
    if (cases[i].field == NULL) {
      CHECK(status == LOBE_OK && session != NULL);
      lobe_close(session);
    } else {
      CHECK(status == LOBE_BAD_INPUT && session == NULL && strstr(lobe_last_error(), cases[i].field));
    }
  }
  lobe_session* session = NULL;
  CHECK(lobe_open_text(scene, data, NULL, &session) == LOBE_OK);
  CHECK(lobe_set_speed(session, 0.001) == LOBE_OK && lobe_set_speed(session, 100) == LOBE_OK);
  const double wrong[] = {0, -1, 0.0009, 101, NAN, INFINITY};
  for (int i = 0; i < 6; ++i)
    CHECK(lobe_set_speed(session, wrong[i]) == LOBE_BAD_INPUT && strstr(lobe_last_error(), "speed"));
  lobe_close(session);
}

/* Files that are not there, or are something else, give one status in every function. */
static void wrong_files(const char* data) {
  char garbage, loop[4096];
  lobe_session *session = NULL, *none = NULL;
  lobe_session* const start = (lobe_session*)&garbage;
  CHECK(lobe_open_text(scene, data, NULL, &session) == LOBE_OK && lobe_advance(session, 1) == LOBE_OK);
  if (!session) return;
  char* too_long = malloc(6000);
  if (!too_long) return;
  memset(too_long, 'x', 5999);
  too_long[5999] = 0;
  snprintf(loop, sizeof loop, "%s/scenes/liver_hands.json/below", data); /* below a file */
  const char* const files[] = {"/nowhere/at/all", "/", "", loop, too_long};
  for (int i = 0; i < 5; ++i) {
    CHECK(lobe_save(session, files[i]) == LOBE_BAD_INPUT);
    CHECK(lobe_save_scene(session, files[i]) == LOBE_BAD_INPUT);
    CHECK(lobe_save_recording(session, files[i]) == LOBE_BAD_INPUT);
    CHECK(lobe_restore(session, files[i]) == LOBE_BAD_INPUT);
    none = start;
    CHECK(lobe_open(files[i], NULL, &none) == LOBE_BAD_INPUT && none == NULL);
    none = start;
    CHECK(lobe_open_text(scene, files[i], NULL, &none) == LOBE_BAD_INPUT && none == NULL);
  }
  free(too_long);
  none = start;
  CHECK(lobe_open(NULL, NULL, &none) == LOBE_BAD_INPUT && none == NULL);
  none = start;
  CHECK(lobe_open_text(NULL, NULL, NULL, &none) == LOBE_BAD_INPUT && none == NULL);
  CHECK(lobe_open(loop, NULL, NULL) == LOBE_BAD_INPUT);
  CHECK(lobe_advance(session, 1) == LOBE_OK);
  lobe_close(session);
}

static void what_is_wrong(const char* data) {
  lobe_session* session = NULL;
  CHECK(lobe_open("no such scene.json", NULL, &session) == LOBE_BAD_INPUT &&
        strstr(lobe_last_error(), "no such scene"));
  CHECK(lobe_open(NULL, NULL, &session) == LOBE_BAD_INPUT &&
        lobe_open_text("{", data, NULL, &session) == LOBE_BAD_INPUT);
  CHECK(lobe_open_text(scene, data, NULL, NULL) == LOBE_BAD_INPUT && session == NULL);
  lobe_options bad = {.size = sizeof bad};
  bad.axes[0] = 1;
  CHECK(lobe_open_text(scene, data, &bad, &session) == LOBE_BAD_INPUT && strstr(lobe_last_error(), "axes"));
  lobe_options none = {.size = 0};
  CHECK(lobe_open_text(scene, data, &none, &session) == LOBE_BAD_INPUT && strstr(lobe_last_error(), "size"));
  lobe_options old = {.size =
                          8}; /* a caller that knows size and threads alone; what follows is not looked at */
  old.threads = 1;
  old.frame = NAN;
  CHECK(lobe_open_text(scene, data, &old, &session) == LOBE_OK && session != NULL);
  if (!session) return;

  lobe_state state = {.size = 8};
  state.time = -1;
  CHECK(lobe_advance(session, 1) == LOBE_OK && lobe_get_state(session, &state) == LOBE_OK);
  CHECK(state.size == 8 && state.time == -1 && state.tetrahedra == 2103);
  lobe_surface small = {.size = 16};
  CHECK(lobe_surface_acquire(session, &small) == LOBE_BAD_INPUT);
  const double point[3] = {NAN, 0, 0}, up[7] = {0, 0, 0, 0, 0, 0, 0};
  char text[2000];
  CHECK(lobe_grasp(session, 1, NULL, 0.1) == LOBE_BAD_INPUT && lobe_move(session, 1, NULL) == LOBE_BAD_INPUT);
  lobe_grasp(session, 1, point, 0.1);
  lobe_move(session, 3, up);
  lobe_grasp(session, 2, up, -1);
  CHECK(lobe_advance(session, 2) == LOBE_OK);
  const uint64_t last = lobe_messages(session, 0, text, sizeof text);
  CHECK(last >= 1 && strstr(text, "refused"));
  CHECK(lobe_messages(session, last, text, sizeof text) == last && text[0] == 0);
  CHECK(lobe_messages(session, 0, text, 1) == 0 && text[0] == 0);
  lobe_status status = LOBE_OK;
  for (int i = 0; i < 5000 && status == LOBE_OK; ++i) status = lobe_release(session, (uint32_t)i);
  CHECK(status == LOBE_BUSY);
  CHECK(lobe_advance(session, 1) == LOBE_OK && lobe_release(session, 1) == LOBE_OK);
  lobe_close(session);

  CHECK(lobe_start(NULL) == LOBE_BAD_INPUT && lobe_stop(NULL) == LOBE_BAD_INPUT &&
        lobe_advance(NULL, 1) == LOBE_BAD_INPUT);
  CHECK(lobe_pause(NULL, 1) == LOBE_BAD_INPUT && lobe_get_state(NULL, &state) == LOBE_BAD_INPUT);
  CHECK(lobe_get_tool(NULL, 1, NULL) == LOBE_BAD_INPUT && lobe_surface_acquire(NULL, NULL) == LOBE_BAD_INPUT);
  CHECK(lobe_save_scene(NULL, "a") == LOBE_BAD_INPUT && lobe_messages(NULL, 3, text, 10) == 3);
  lobe_surface_release(NULL, NULL);
  lobe_close(NULL);
}

/* A device presses what it holds, and is pushed back; what is not finite, and nothing at all, fades. Forces
 * grow and fade by the clock: what is waited for is that they do, not how soon. */
static void servo(const char* data) {
  lobe_session* session = NULL;
  CHECK(lobe_open_text(scene, data, NULL, &session) == LOBE_OK);
  const double point[3] = {0.082, -0.045, 0.035};
  double x[3] = {0, 0, 0}, v[3] = {0, 0, 0}, f[3] = {9, 9, 9};
  lobe_haptic_device device = {.size = sizeof device, .force = 10};
  CHECK(sizeof device == 48 && offsetof(lobe_haptic_device, force) == 8);
  CHECK(lobe_haptic_force(session, 3, x, v, f) == LOBE_WRONG_STATE);
  CHECK(lobe_grasp(session, 3, point, 0.02) == LOBE_OK && lobe_advance(session, 2) == LOBE_OK);
  CHECK(lobe_haptic_attach(session, 3, &device) == LOBE_OK);
  CHECK(lobe_haptic_attach(session, 3, NULL) == LOBE_WRONG_STATE);
  device.damping = -1;
  CHECK(lobe_haptic_attach(session, 4, &device) == LOBE_BAD_INPUT &&
        strstr(lobe_last_error(), "damping") != NULL);
  CHECK(lobe_advance(session, 2) == LOBE_OK);
  CHECK(lobe_haptic_force(session, 3, x, v, f) == LOBE_OK);
  lobe_tool hand = {.size = sizeof hand};
  double highest = 0;
  for (int i = 0; i < 40000 && !(f[2] < -0.05 && hand.pose[2] > point[2] + 0.001); ++i) {
    x[2] = 0.01 * (i < 100 ? i : 100) / 100; /* 1 cm up, and stays */
    CHECK(lobe_haptic_force(session, 3, x, v, f) == LOBE_OK);
    if (i % 8 == 0) CHECK(lobe_advance(session, 1) == LOBE_OK);
    CHECK(lobe_get_tool(session, 3, &hand) == LOBE_OK);
    highest = fmax(highest, sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
  }
  CHECK(f[2] < -0.05 && highest <= 10 * (1 + 1e-9));
  CHECK(hand.pose[2] > point[2] + 0.001 && hand.pose[2] < point[2] + 0.0101);
  x[1] = NAN;
  for (int i = 0; i < 20000000 && f[2] != 0; ++i)
    CHECK(lobe_haptic_force(session, 3, x, v, f) == LOBE_BAD_INPUT);
  CHECK(f[0] == 0 && f[1] == 0 && f[2] == 0 && strstr(lobe_last_error(), "finite") != NULL);
  CHECK(lobe_haptic_force(session, 3, NULL, NULL, f) == LOBE_OK && f[2] == 0);
  CHECK(lobe_haptic_detach(session, 3) == LOBE_OK && lobe_haptic_detach(session, 3) == LOBE_WRONG_STATE);
  CHECK(lobe_haptic_attach(session, 3, NULL) == LOBE_OK); /* closed with it */
  lobe_close(session);
}

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  layout();
  two_bodies(argv[1]);
  sew(argv[1]);
  sew_with_needle(argv[1]);
  lift_and_burn(argv[1], argv[2]);
  save_and_restore(argv[1], argv[2]);
  relaxation(argv[1]);
  other_axes(argv[1]);
  servo(argv[1]);
  own_thread(argv[1]);
  bounds_of_options(argv[1]);
  wrong_files(argv[1]);
  what_is_wrong(argv[1]);
  return failures != 0;
}
