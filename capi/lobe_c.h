/* lobe for engines: a session (docs/live.md) behind C functions, in one shared library. docs/c.md
 *
 * - Units are SI. If lobe_options gives axes, positions, directions and forces are in these axes, and all
 *   lengths and velocities are in their unit of length. Forces are always in newtons.
 * - Any thread may call every function; lobe_close() and lobe_haptic_force() say what must not run meanwhile.
 *   No function throws. lobe frees what it allocates.
 * - Structs begin with their size, so that a newer library works with an older caller.
 * - A NULL handle gives LOBE_BAD_INPUT.
 */
#ifndef LOBE_C_H
#define LOBE_C_H

#include <stdint.h>

#if defined(_WIN32) && defined(lobe_c_EXPORTS)
#define LOBE_API __declspec(dllexport)
#elif defined(_WIN32)
#define LOBE_API __declspec(dllimport)
#elif defined(__GNUC__)
#define LOBE_API __attribute__((visibility("default")))
#else
#define LOBE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define LOBE_ABI_VERSION 1u
LOBE_API uint32_t lobe_abi_version(void); /* of the library; compare it with LOBE_ABI_VERSION */

typedef enum lobe_status {
  LOBE_OK = 0,
  /* An argument or a file is not what it must be, or a file or folder is missing or cannot be written.
   * lobe_last_error() says what, where, and what was expected. Nothing was done. */
  LOBE_BAD_INPUT = 1,
  LOBE_BUSY = 2,        /* the queue is full: send it again */
  LOBE_NOT_YET = 3,     /* it does not exist yet: call again after the next frame */
  LOBE_WRONG_STATE = 4, /* such as lobe_advance() while the session runs in its own thread */
  LOBE_FAILED = 5       /* no memory, no thread: lobe_last_error() */
} lobe_status;

/* The text of the calling thread's last failure; valid until that thread calls lobe again. lobe_get_tool()
 * leaves it as it is when it returns LOBE_NOT_YET. Never NULL. */
LOBE_API const char* lobe_last_error(void);

typedef struct lobe_session lobe_session;

typedef struct lobe_options {
  uint32_t size;    /* sizeof(lobe_options) */
  uint32_t threads; /* threads of the simulation, 1 … 256; 0 means 1 */
  double frame;     /* length of a frame [s], above 0 and at most 1; 0 means 1/120 */
  double speed; /* simulated seconds per second of the clock, after lobe_start(), 0.001 … 100; 0 means 1 */
  uint32_t unpaced; /* 1: after lobe_start(), frames do not wait for the clock */
  uint32_t paused;  /* 1: the session begins paused */
  /* A position x of lobe is A x + t in the engine. These are the rows of (A | t). A is a rotation or a
   * mirroring, times a scale. All 0: the same axes. Mirrored axes turn the triangles round. For Unity, which
   * is left-handed with y up, and a scene with z up:
   * {1,0,0,0, 0,0,1,0, 0,1,0,0}. */
  double axes[12];
} lobe_options;

/* Opens a scene (docs/scene.md) from a file, or from its text with the folder that its paths are relative
 * to. options may be NULL. After a failure *session is NULL. */
LOBE_API lobe_status lobe_open(const char* scene_file, const lobe_options* options, lobe_session** session);
LOBE_API lobe_status lobe_open_text(const char* scene, const char* folder, const lobe_options* options,
                                    lobe_session** session);
/* Ends the session and its thread. No other call may be under way. Release all surfaces before. */
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
  uint64_t frame;          /* number of the frame of the latest snapshot */
  double time;             /* simulated [s] */
  double real_time_factor; /* over the last half second; 0 while paused */
  uint32_t running;        /* 0: paused */
  uint32_t stands_still;   /* 1: no step is stable; go back, or restart */
} lobe_state;
LOBE_API lobe_status lobe_get_state(lobe_session* session, lobe_state* state);
/* Writes the messages after number `after` (0: from the start). Each is one line that begins with its number.
 * As many whole lines are written as fit, ended by 0. Returns the number of the last message, or `after`. */
LOBE_API uint64_t lobe_messages(lobe_session* session, uint64_t after, char* text, uint32_t capacity);

/* ---- Tools. The caller chooses a number for each tool. Commands act at the start of the next frame, in
 * order. */

LOBE_API lobe_status lobe_grasp(lobe_session* session, uint32_t tool, const double point[3], double radius);
/* Grasps what lies within the radius of the point at which the ray enters the body. */
LOBE_API lobe_status lobe_grasp_ray(lobe_session* session, uint32_t tool, const double origin[3],
                                    const double direction[3], double radius);
LOBE_API lobe_status lobe_cautery(lobe_session* session, uint32_t tool, const double tip[3],
                                  double radius); /* begins switched off */
/* Its edge leads from tip to heel. lobe_move places the tip and turns the edge by the quaternion. It does not
 * cut until it is switched on. */
LOBE_API lobe_status lobe_scalpel(lobe_session* session, uint32_t tool, const double tip[3],
                                  const double heel[3]);
/* Brings any tool but a grasp, as a scene describes it (docs/scene.md), with "at", a row of its path without
 * the time, in place of "path":
 *   {"type": "probe", "shape": {"sphere": {"radius": 0.01}}, "at": [0.1, 0, 0.05]}
 * Lengths are metres and directions those of the scene, whatever lobe_options.axes says; files of shapes are
 * relative to the working folder. lobe_last_error() names each fault by its JSON pointer. */
LOBE_API lobe_status lobe_bring(lobe_session* session, uint32_t tool, const char* json);
/* A cautery burns while it is on, a scalpel cuts, jaws close. A clip applier closes a clip when it is
 * switched on. */
LOBE_API lobe_status lobe_switch(lobe_session* session, uint32_t tool, int on);
/* Moves a tool to a pose: position and unit quaternion (x, y, z, w). A grasp begins at the point given to
 * lobe_grasp(), or hit by the ray, with quaternion (0, 0, 0, 1). Its pose says where that point is to be, and
 * how far the grasp has turned since. */
LOBE_API lobe_status lobe_move(lobe_session* session, uint32_t tool, const double pose[7]);
LOBE_API lobe_status lobe_release(lobe_session* session, uint32_t tool);

typedef struct lobe_tool {
  uint32_t size;     /* sizeof(lobe_tool) */
  uint32_t holds;    /* 1: a grasp has taken hold, a cautery or scalpel is on */
  uint32_t vertices; /* that a grasp holds */
  double pose[7];
  double force[3];  /* on the tool, by the body, mean over the last frame [N] */
  double torque[3]; /* about the grasp's centre, in the sense of the engine's rotations [N m] */
} lobe_tool;
/* The state of a tool. Wait-free, except the first call of a thread, so that a haptic loop may call it at
 * 1 kHz. LOBE_NOT_YET: there is no such tool, or it holds nothing. */
LOBE_API lobe_status lobe_get_tool(lobe_session* session, uint32_t tool, lobe_tool* state);

/* ---- Thread (docs/guide/sew.md). The caller chooses a number for each thread; those of a scene are 0, 1, …
 * What is done acts at the start of the next frame, in order. Where a thread passes is looked for at once,
 * which waits for the end of a frame. A message `refused` names what then cannot be done, such as to tie a
 * thread that is cut. */

typedef struct lobe_thread_material {
  uint32_t size;    /* sizeof(lobe_thread_material) */
  uint32_t unused;  /* 0 */
  double stiffness; /* tension per strain [N]; 0 means 98, a braided 3-0 thread */
  double friction;  /* where it passes through tissue; 0 means 0.2, below 0: none */
  double strength;  /* tension above which it breaks [N]; 0 means any */
  double holds;     /* force that tissue bears at a bite before the thread cuts into it [N]; 0 means any */
} lobe_thread_material;
LOBE_API lobe_status lobe_thread(lobe_session* session, uint32_t thread,
                                 const lobe_thread_material* material); /* may be NULL */
/* Draws it through the tissue, after its earlier bites: at a point, or `depth` below where a ray enters the
 * body. LOBE_BAD_INPUT for a place that is outside of the tissue, with how far. */
LOBE_API lobe_status lobe_bite(lobe_session* session, uint32_t thread, const double point[3]);
LOBE_API lobe_status lobe_bite_ray(lobe_session* session, uint32_t thread, const double origin[3],
                                   const double direction[3], double depth);
/* Takes its free ends in a hand at a point, or leads them there, as a hand moves tools. NULL: lets go. */
LOBE_API lobe_status lobe_pull(lobe_session* session, uint32_t thread, const double point[3]);
/* Goes on pulling a thread that lobe_pull() holds, no faster than `speed` per second, until its ends pull
 * with `force` [N]. */
LOBE_API lobe_status lobe_pull_on(lobe_session* session, uint32_t thread, const double direction[3],
                                  double force, double speed);
/* Ties a knot between two bites, counted from 0 in the order of sewing; -1 is the last one, -2 that before. A
 * knot that is there already is drawn together by `tighten` more, in the time `over` [s]. */
LOBE_API lobe_status lobe_tie(lobe_session* session, uint32_t thread, int32_t from, int32_t to,
                              double tighten, double over);
LOBE_API lobe_status lobe_cut_thread(lobe_session* session, uint32_t thread, int32_t after); /* a bite */
LOBE_API lobe_status lobe_remove_thread(lobe_session* session, uint32_t thread); /* cut after each bite */
/* Writes the segments of all threads in the latest snapshot: of each both ends, six floats, and its tension
 * [N]. As many are written as fit; either may be NULL. Returns how many there are. */
LOBE_API uint32_t lobe_thread_lines(lobe_session* session, uint32_t capacity, float* ends, float* tensions);

/* ---- Haptics: the servo loop of a device leads a tool, and asks for its force (docs/haptics.md) */

typedef struct lobe_haptic_device {
  uint32_t size;    /* sizeof(lobe_haptic_device) */
  uint32_t unused;  /* 0 */
  double force;     /* largest force [N]; 0 means 3 */
  double torque;    /* largest torque [N m]; 0 means 0.1 */
  double slew;      /* fastest change of the force [N/s]; 0 means 200 */
  double stiffness; /* of the stiffest coupling [N/m]; 0 means 1000 */
  double damping;   /* of its mechanics [N s/m]; 0 means 0.5 */
} lobe_haptic_device;
/* From now on the tool follows the device, in place of lobe_move(). Up to 8 tools. device may be NULL. */
LOBE_API lobe_status lobe_haptic_attach(lobe_session* session, uint32_t tool,
                                        const lobe_haptic_device* device);
/* Waits for a lobe_haptic_force() of this tool that is under way. Those of other tools go on meanwhile. */
LOBE_API lobe_status lobe_haptic_detach(lobe_session* session, uint32_t tool);
/* Takes the position and velocity of the device and gives its force [N]. The force fades if the
 * simulation is late. One thread per tool calls it about every millisecond. It is wait-free, and allocates
 * nothing if it returns LOBE_OK. x NULL: the device is not there. Values that are not finite give
 * LOBE_BAD_INPUT, and the force fades. */
LOBE_API lobe_status lobe_haptic_force(lobe_session* session, uint32_t tool, const double x[3],
                                       const double v[3], double f[3]);

/* ---- The surface, in buffers that an engine copies to the graphics card */

typedef struct lobe_surface {
  uint32_t size; /* sizeof(lobe_surface) */
  uint32_t vertices, triangles;
  uint64_t frame;
  uint64_t topology;     /* while it is the same, only positions and normals change */
  double time;           /* [s] */
  const float* position; /* 3 per vertex */
  const float* normal;   /* 3 per vertex, unit length, outwards */
  const uint32_t* index; /* 3 per triangle, counter-clockwise seen from outside in right-handed axes */
  const uint8_t* region; /* per triangle: the number of its model (docs/guide/regions.md) */
  const uint8_t* cut;    /* per triangle: 1 where a blade has opened it, 2 where a cautery has, 0: skin */
  void* owner;           /* of the buffers */
} lobe_surface;
/* The latest surface. Its buffers do not change until lobe_surface_release(). */
LOBE_API lobe_status lobe_surface_acquire(lobe_session* session, lobe_surface* surface);
LOBE_API void lobe_surface_release(lobe_session* session, lobe_surface* surface);
/* Per triangle of a surface that was acquired: the number of its body. NULL for a surface that was not, or
 * was released. */
LOBE_API const uint8_t* lobe_surface_bodies(const lobe_surface* surface);

/* ---- Several bodies in one scene */

LOBE_API uint32_t lobe_body_count(lobe_session* session); /* 1 where the scene has one mesh; 0 for NULL */
/* The name that the scene gives to a body, from 0; "" where it gives none, and for a body that there is not.
 * It stays until lobe_close(). */
LOBE_API const char* lobe_body_name(lobe_session* session, uint32_t body);

/* ---- Files, written whole or not at all */

LOBE_API lobe_status lobe_save_scene(lobe_session* session,
                                     const char* file); /* what the tools did, for `lobe run` */
LOBE_API lobe_status lobe_save_recording(lobe_session* session, const char* file); /* for `lobe replay` */
/* The present state and what led to it, for lobe_restore(): some 1.5 MB per minute of a hand that moves. */
LOBE_API lobe_status lobe_save(lobe_session* session, const char* file);
/* Goes on from a state that a session of the same scene, mesh and precision has saved, bit for bit. Tools let
 * go, as by lobe_back(). LOBE_BAD_INPUT for any other file, and for one that is damaged: nothing has changed
 * then. */
LOBE_API lobe_status lobe_restore(lobe_session* session, const char* file);

#ifdef __cplusplus
}
#endif
#endif
