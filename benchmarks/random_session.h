// A session in the hands of several threads that do whatever can be done, at random times, while others look
// on and its own thread is held up at random: for its benchmark and tests.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <optional>
#include <thread>
#include <vector>

#include "benchmarks/random_hands.h"
#include "lobe/error.h"
#include "lobe/live/session.h"

namespace lobe::bench {

struct RandomSessionOptions {
  RandomHandsOptions hands;
  int threads = 1;       // of the world
  double seconds = 600;  // simulated in all, also what is undone later
  unsigned seed = 1;
  int most_delay = 400;  // of each thread, between two things that it does [µs]
};

struct RandomSession {
  Recording recording;
  std::uint64_t last = 0;  // digest
  Index alive = 0;         // tetrahedra
  long frames = 0;
  long faults = 0;  // pictures that were none
};

namespace random_session {

inline void wait(RandomHands& dice, int most) {
  std::this_thread::sleep_for(std::chrono::microseconds(dice.dice(most)));
}

// Leaves in the middle of something every now and then.
inline void send(Session<float>& session, const RandomSessionOptions& options, unsigned seed,
                 const std::atomic<bool>& stops) {
  RandomHands hands(seed, options.hands);
  std::optional<Controller> controller;
  while (!stops) {
    if (hands.dice(200) == 0) controller.reset();
    try {
      if (!controller) controller.emplace(session.connect("somebody"));
    } catch (const InputError&) {  // those who left before have not all been seen off yet
      wait(hands, options.most_delay);
      continue;
    }
    controller->send(hands.next());
    if (hands.dice(20) == 0) controller->send({.kind = HandCommand::Kind::run, .on = true});
    wait(hands, options.most_delay);
  }
}

// Looks at pictures, holding some of them for long.
inline void look(const Session<float>& session, const RandomSessionOptions& options, unsigned seed,
                 const std::atomic<bool>& stops, std::atomic<long>& faults) {
  RandomHands hands(seed, {});
  std::array<TripleBuffer<Snapshot<float>>::View, 3> held;
  while (!stops) {
    auto& view = held[std::size_t(hands.dice(3))];
    const auto status = session.status();
    view = session.pictures().latest();
    faults += !view->u.allFinite() || view->frame < status->picture;
    faults += view->surface.x.cols() != view->surface.mesh->vertex_count();
    wait(hands, 12 * options.most_delay);
  }
}

}  // namespace random_session

inline RandomSession play_at_random(const Setup& setup, const RandomSessionOptions& options) {
  RandomHands delays(options.seed + 1000, {});
  SessionOptions of_session;
  of_session.threads = options.threads;
  of_session.paced = false;
  of_session.back_every = 0.1;
  of_session.published = [&] {
    if (delays.dice(8) == 0) random_session::wait(delays, options.most_delay);
  };
  Session<float> session(setup, of_session);
  std::atomic<bool> stops = false;
  std::atomic<long> faults = 0;
  std::vector<std::thread> others;
  for (unsigned i = 0; i < 2; ++i) {
    others.emplace_back([&, i] { random_session::send(session, options, 10 * options.seed + i, stops); });
    others.emplace_back([&, i] { random_session::look(session, options, i, stops, faults); });
  }
  session.start();
  const auto simulated = [&] { return double(session.status()->frames) * session.frame(); };
  while (simulated() < options.seconds) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  stops = true;
  for (std::thread& thread : others) thread.join();
  session.stop();
  return {session.recording(), digest(session.world()), session.world().elements().topology.alive_count(),
          long(session.status()->frames), faults};
}

}  // namespace lobe::bench
