// What hands have done in a session, as a plain scene: its tools follow the paths on which the hands moved
// them, and `lobe run` plays it to the same bits.
//
//   const Scene kept = session_scene(scene, resolved.setup, session);
//   write_file("session.json", to_json(kept));
#pragma once

#include "lobe/live/session.h"
#include "lobe/scene/scene.h"

namespace lobe {

// From the start to where the session is now, without what was undone by going back. The mesh has its
// absolute path; regions that lobe has chosen, or measured, are stated. Throws InputError for a session that
// a scene cannot tell: one in which the body was edited otherwise than by tools, a frame failed, nothing was
// done yet, or whose scene is not this one.
template <class Real>
Scene session_scene(const Scene& scene,  // of the session
                    const Setup& setup,  // that the session was built from
                    const Session<Real>& session);

// The same scene, whose regions are to be chosen for what its grasps do, each where it has moved furthest:
// the gestures that it declares. Where a grasp holds copies alone, or does not move, it declares none.
Scene with_gestures(Scene scene, double tolerance);  // relative L2 error of the displacement

}  // namespace lobe
