/* lobe for engines: a session (docs/live.md) behind C functions, in one shared library. docs/c.md
 *
 * Units are SI. Positions, directions and forces are in the engine's axes, where lobe_options gives some.
 * Every function but lobe_close() may be called by any thread. None throws, and what lobe allocates it frees.
 * Structs begin with their size, so that a library that knows more fields goes with a caller that knows
 * fewer. Handles that are NULL are LOBE_BAD_INPUT.
 */
#ifndef LOBE_C_H
#define LOBE_C_H

#include <stdint.h>

#if defined(__GNUC__)
#define LOBE_API __attribute__((visibility("default")))
#else
#define LOBE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define LOBE_ABI_VERSION 1u
LOBE_API uint32_t lobe_abi_version(void); /* that the library has: compare it with LOBE_ABI_VERSION */

typedef enum lobe_status {
  LOBE_OK = 0,
  LOBE_BAD_INPUT = 1,   /* lobe_last_error() says what, where, and what was expected; nothing was done */
  LOBE_BUSY = 2,        /* the queue is full: send it again */
  LOBE_NOT_YET = 3,     /* there is no such thing yet: ask again after the next frame */
  LOBE_WRONG_STATE = 4, /* lobe_advance() while it runs in its own thread, and the like */
  LOBE_FAILED = 5       /* no memory, no file: lobe_last_error() */
} lobe_status;

/* Of the last call of this thread that did not return LOBE_OK; valid until its next call. Never NULL. */
LOBE_API const char* lobe_last_error(void);

typedef struct lobe_session lobe_session;

typedef struct lobe_options {
  uint32_t size;    /* sizeof(lobe_options) */
  uint32_t threads; /* of the simulation; 0: one */
  double frame;     /* [s], at most 1; 0: 1/120 */
  double speed;     /* simulated seconds per second, where it is paced; 0: 1 */
  uint32_t unpaced; /* 1: as fast as it can */
  uint32_t paused;  /* 1: it begins so */
  /* Engine position = A x + t of lobe's, rows of (A | t): a turn or mirroring times a scale. All 0: the
   * same axes. Mirrored axes turn the triangles round. Unity, y up and left-handed, from lobe's z up:
   * {1,0,0,0, 0,0,1,0, 0,1,0,0}. */
  double axes[12];
} lobe_options;

/* options may be NULL. A file of docs/scene.md, or its text, with the folder that its paths are relative
 * to. */
LOBE_API lobe_status lobe_open(const char* scene_file, const lobe_options* options, lobe_session** session);
LOBE_API lobe_status lobe_open_text(const char* scene, const char* folder, const lobe_options* options,
                                    lobe_session** session);
/* Ends its thread. No other call may be under way; surfaces that were acquired must have been released. */
LOBE_API void lobe_close(lobe_session* session);

/* ---- Time */

LOBE_API lobe_status lobe_start(lobe_session* session); /* in a thread of its own, until lobe_stop() */
LOBE_API lobe_status lobe_stop(lobe_session* session);
LOBE_API lobe_status lobe_advance(lobe_session* session,
                                  uint32_t frames); /* by the calling thread; not while started */
LOBE_API lobe_status lobe_pause(lobe_session* session, int paused);
LOBE_API lobe_status lobe_set_speed(lobe_session* session, double speed); /* 0.001 … 100 */
LOBE_API lobe_status lobe_restart(lobe_session* session);
LOBE_API lobe_status lobe_back(lobe_session* session, double seconds);

typedef struct lobe_state {
  uint32_t size; /* sizeof(lobe_state) */
  uint32_t tetrahedra;
  uint64_t frame;          /* of the latest picture */
  double time;             /* simulated [s] */
  double real_time_factor; /* over the last half second; 0 while paused */
  uint32_t running;        /* 0: paused */
  uint32_t stands_still;   /* 1: no step is stable; go back, or restart */
} lobe_state;
LOBE_API lobe_status lobe_get_state(lobe_session* session, lobe_state* state);
/* What there is to say after message `after` (0: from the start), one line of text each with its number
 * before it; as many whole lines as fit, ended by 0. Returns the number of the last one, or `after`. */
LOBE_API uint64_t lobe_messages(lobe_session* session, uint64_t after, char* text, uint32_t capacity);

/* ---- Tools: numbers that the caller chooses, one tool each. Obeyed at the start of the next frame, in
 * order. */

LOBE_API lobe_status lobe_grasp(lobe_session* session, uint32_t tool, const double point[3], double radius);
/* Of what lies within the radius of where the ray enters the body. */
LOBE_API lobe_status lobe_grasp_ray(lobe_session* session, uint32_t tool, const double origin[3],
                                    const double direction[3], double radius);
LOBE_API lobe_status lobe_cautery(lobe_session* session, uint32_t tool, const double tip[3],
                                  double radius);                               /* off */
/* Its edge leads from tip to heel; lobe_move places the tip, and turns the edge by the quaternion. It does not cut
 * until it is switched on. */
LOBE_API lobe_status lobe_scalpel(lobe_session* session, uint32_t tool, const double tip[3],
                                  const double heel[3]);
LOBE_API lobe_status lobe_switch(lobe_session* session, uint32_t tool, int on); /* a cautery or a scalpel */
/* position and unit quaternion (x, y, z, w): of a grasp the point where it took hold, and the turn since. */
LOBE_API lobe_status lobe_move(lobe_session* session, uint32_t tool, const double pose[7]);
LOBE_API lobe_status lobe_release(lobe_session* session, uint32_t tool);

typedef struct lobe_tool {
  uint32_t size;     /* sizeof(lobe_tool) */
  uint32_t holds;    /* 1: a grasp has taken hold, a cautery or scalpel is on */
  uint32_t vertices; /* that a grasp holds */
  double pose[7];
  double force[3];  /* on the tool, by the body, mean over the last frame [N] */
  double torque[3]; /* [N m] */
} lobe_tool;
/* Wait-free but for the first call of a thread: a haptic loop may ask at 1 kHz. LOBE_NOT_YET: the hand
 * is empty. */
LOBE_API lobe_status lobe_get_tool(lobe_session* session, uint32_t tool, lobe_tool* state);

/* ---- Haptics: the servo loop of a device's library leads a tool, and asks for its force (docs/haptics.md) */

typedef struct lobe_haptic_device {
  uint32_t size;    /* sizeof(lobe_haptic_device) */
  uint32_t unused;  /* 0 */
  double force;     /* the most that it is asked for [N]; 0: 3, and so on for what is 0 */
  double torque;    /* [N m]; 0.1 */
  double slew;      /* fastest change of the force [N/s]; 200 */
  double stiffness; /* of the stiffest coupling [N/m]; 1000 */
  double damping;   /* that its mechanics have in any case [N s/m]; 0.5 */
} lobe_haptic_device;
/* From now on the tool goes where the device is, instead of by lobe_move(). device may be NULL. Of up to 8
 * tools. */
LOBE_API lobe_status lobe_haptic_attach(lobe_session* session, uint32_t tool,
                                        const lobe_haptic_device* device);
LOBE_API lobe_status lobe_haptic_detach(lobe_session* session, uint32_t tool); /* no force() is under way */
/* Position [m] and velocity [m/s] of the device; its force [N], which fades where the simulation is late.
 * About every millisecond, by one thread per tool: wait-free, and without an allocation where it is LOBE_OK.
 * x NULL: the device is not there. What is not finite is LOBE_BAD_INPUT, with a force that fades. */
LOBE_API lobe_status lobe_haptic_force(lobe_session* session, uint32_t tool, const double x[3],
                                       const double v[3], double f[3]);

/* ---- The surface, in buffers that an engine copies to the graphics card */

typedef struct lobe_surface {
  uint32_t size; /* sizeof(lobe_surface) */
  uint32_t vertices, triangles;
  uint64_t frame;
  uint64_t topology;     /* the same: only positions and normals have changed */
  double time;           /* [s] */
  const float* position; /* 3 per vertex [m] */
  const float* normal;   /* 3 per vertex, unit length, outwards */
  const uint32_t* index; /* 3 per triangle, counter-clockwise seen from outside in right-handed axes */
  const uint8_t* region; /* per triangle: 0 tensor-mass, 1 precomputed, 2 nonlinear */
  const uint8_t* cut;    /* per triangle: 1 where a cut has made it */
  void* owner;           /* of the buffers */
} lobe_surface;
/* The latest; its buffers stay as they are until lobe_surface_release(). */
LOBE_API lobe_status lobe_surface_acquire(lobe_session* session, lobe_surface* surface);
LOBE_API void lobe_surface_release(lobe_session* session, lobe_surface* surface);

/* ---- Kept: written whole or not at all */

LOBE_API lobe_status lobe_save_scene(lobe_session* session,
                                     const char* file); /* what the tools did, for `lobe run` */
LOBE_API lobe_status lobe_save_recording(lobe_session* session, const char* file); /* for `lobe replay` */

#ifdef __cplusplus
}
#endif
#endif
