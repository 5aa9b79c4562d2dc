// Makes a plain scene of what hands have done in a session. Its tools follow the paths on which the hands
// moved them, and `lobe run` plays it to the same bits.
//
//   const Setup setup = session_setup(scene, resolved.setup);
//   Session<float> session(setup);
//   …
//   const Scene kept = session_scene(scene, setup, session);
//   write_file("session.json", to_json(kept));
#pragma once

#include "lobe/live/session.h"
#include "lobe/scene/scene.h"

namespace lobe {

// By how much sleep may change displacements in a session whose scene does not say: a share of the diagonal
// of the body's bounding box.
inline constexpr double session_sleep = 1e-4;

// The setup of a session of the scene: parts at rest sleep, unless the scene says by how much or not at all,
// or has something that sleep does not go with (setup/exclusions.h).
Setup session_setup(const Scene& scene,
                    Setup setup);  // setup that the scene resolves to

// The scene goes from the start to where the session is now, without what was undone by going back. Its
// paths are absolute. The scene states the regions that lobe has chosen or measured, and by how much sleep
// may change displacements. Throws InputError for a session that no scene can describe: the body was edited
// otherwise than by tools, a frame failed, nothing was done yet, or the session is of another scene.
template <class Real>
Scene session_scene(const Scene& scene,  // scene of the session
                    const Setup& setup,  // setup of session_setup(), that the session was built from
                    const Session<Real>& session);

// Returns the scene with automatic regions. It declares a gesture for each grasp: its motion to where it was
// furthest. A grasp that holds only copies, or does not move, gives none.
Scene with_gestures(Scene scene, double tolerance);  // tolerance: relative L2 error of the displacement

}  // namespace lobe
