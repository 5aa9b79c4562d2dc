// A sphere that only touches, in a haptic hand (lobe/haptic/haptic_hand.h) on a given path: the same session
// and the same local model as with a device, in virtual time.
#pragma once

#include <stdexcept>

#include "benchmarks/haptic_rig.h"
#include "lobe/haptic/haptic_hand.h"
#include "lobe/live/pick.h"

namespace lobe::bench {

struct Sphere {
  Vec3d start;            // where its centre is brought [m]
  double radius = 0.008;  // [m]
  double friction = 0;
};

// Before the surface: from there it has to go `gap` along `in` until it meets the place that `in` points at,
// which is where a ray from `from` against `in` leaves the body.
inline Sphere sphere_before(const Setup& setup, const Vec3d& from, const Vec3d& in, double gap) {
  World<double> world(setup);
  const SurfaceMesh& surface = world.surface().mesh();
  Mat3X<double> x;
  update_positions(surface, world.elements().points.view(), world.displacements(), x);
  const auto hit = cast_ray(surface, x, from - 0.1 * in, in);
  if (!hit) throw std::logic_error("no surface lies on the way of the sphere");
  Sphere sphere{.start = hit->point};
  sphere.start -= (sphere.radius + gap) * in;
  return sphere;
}

// Comes through `gap` of free space, presses `depth` deep, rests, slides by `depth`, and leaves.
inline HandPath touch_and_slide(const Vec3d& in, const Vec3d& along, double gap, double depth, double speed) {
  const Vec3d deep = (gap + depth) * in;
  return {{{deep, speed},
           {Vec3d::Zero(), 0, 0.1},
           {deep + depth * along, speed},
           {Vec3d::Zero(), 0, 0.1},
           {depth * along, speed}}};
}

// The forces on a sphere that is led along a path, frame by frame.
inline std::vector<FeltFrame> feel_touch(const Setup& setup, const Sphere& sphere, const HandPath& path,
                                         double frame) {
  Session<float> session(setup, {.frame = frame});
  Controller controller = session.connect("hand");
  HapticLink link;
  HapticHand<float> hand(session, link,
                         {.controller = controller.number(), .stiffness = {.has_helper = false}});
  controller.send(bring_tool(
      1, sphere.start,
      BringProbe{"", RigidShape::sphere(sphere.radius), {.position = sphere.start}, sphere.friction}));
  session.step_frame();
  std::vector<FeltFrame> frames;
  const int count = static_cast<int>(std::ceil(path.duration() / frame));
  for (int i = 0; i < count; ++i) {
    HapticState& state = *link.state.writable();
    state.is_there = true;
    state.engagement = link.model.latest()->engagement;
    state.tool = sphere.start + path.at((i + 1) * frame);
    link.state.publish();
    session.step_frame();
    const auto model = link.model.latest();
    FeltFrame felt{.end = (i + 1) * frame, .position = model->position - sphere.start};
    felt.force = model->force;
    felt.rate = model->rate;
    felt.K = model->K;
    felt.is_bilateral = model->is_bilateral;
    felt.normal = model->normal;
    frames.push_back(felt);
  }
  return frames;
}

}  // namespace lobe::bench
