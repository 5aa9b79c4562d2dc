// A body for hands to hold, and hands that are scripted.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "lobe/live/session.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

namespace lobe::test {

using Kind = HandCommand::Kind;

// A block of 5 cm that stands on z = 0, half of it linear, under gravity.
inline Setup block() {
  Setup setup = hybrid_setup(irregular_box(5));
  setup.damping = 15;
  setup.gravity = {0, 0, -9.81};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

inline const Vec3d top{0.025, 0.025, 0.05};  // of the block [m]

inline HandCommand take_at(const Vec3d& point, double radius = 0.012, HandNumber hand = 1) {
  return {.kind = Kind::take_at_point, .hand = hand, .position = point, .radius = radius};
}
inline HandCommand lead_to(const Vec3d& point, HandNumber hand = 1) {
  return {.kind = Kind::lead, .hand = hand, .position = point};
}
inline HandCommand ask(Kind kind, HandNumber hand = 1) { return {.kind = kind, .hand = hand}; }
inline HandCommand ask_for(Kind kind, double value) { return {.kind = kind, .value = value}; }
inline HandCommand turn_on(Kind kind, bool on, HandNumber hand = 1) {
  return {.kind = kind, .on = on, .hand = hand};
}

template <class Real>
std::vector<SessionMessage> messages(const Session<Real>& session) {
  return *session.status()->messages;
}

template <class Real>
int times_said(const Session<Real>& session, const std::string& name, const std::string& text = "") {
  int times = 0;
  for (const SessionMessage& message : messages(session))
    if (message.name == name && message.text.find(text) != std::string::npos) times += message.times;
  return times;
}

inline const Vec3d lift{0, 0, 0.01};  // of what is held [m]

inline void step(Session<float>& session, int frames) {
  for (int i = 0; i < frames; ++i) REQUIRE(session.step_frame());
}

inline bool replays(const Session<float>& session, const Setup& setup, int threads = 1) {
  World<float> world(setup, threads);
  const ReplayResult replayed = replay(session.recording(), world);
  return replayed.same && replayed.commands == session.recording().commands.size();
}

}  // namespace lobe::test
