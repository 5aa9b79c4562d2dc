// lobe bench live: what a session costs beside the frames that it simulates, and a replay of minutes of
// random hands.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/held_liver.h"
#include "benchmarks/machine.h"
#include "benchmarks/random_session.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/live/session.h"
#include "lobe/mesh/refine.h"

namespace lobe::bench {
namespace {

using Kind = HandCommand::Kind;

struct LiveRow {
  std::string mesh;
  Index tets = 0;
  int frames = 0;
  double bare_us = 0, session_us = 0;  // per frame, of the same frames: advance() alone, and a session
  double ratio = 1;                    // of the two
  double publish_us = 0, seal_us = 0, keep_us = 0;  // a picture, a digest of the state, a state to go back to
  double answer_p50_ms = 0, answer_p95_ms = 0;      // from a command to the picture that knows of it
};

// Holds the tip of the left lobe and leads it round and round; a pose every other frame, as from a mouse.
void drag(Controller& hand, int frame) {
  if (frame == 0) hand.send({.kind = Kind::take_at_point, .hand = 1, .position = left_tip, .radius = 0.02});
  if (frame % 2 != 0) return;
  const double angle = 0.05 * frame;
  const Vec3d offset(0.01 * std::cos(angle) - 0.01, 0.01 * std::sin(angle), 0.01 * (1 - std::cos(angle)));
  hand.send({.kind = Kind::lead, .hand = 1, .position = left_tip + offset});
}

double timed_us(const std::function<void()>& work) {
  const Stopwatch watch(true);
  work();
  return 1e6 * watch.seconds();
}

// The same frames by a session and by a world alone, turn and turn about in blocks of as many frames as there
// are between two states to go back to; medians over the blocks.
void time_frames(const Setup& setup, LiveRow& row) {
  constexpr int block = 60;
  Session<float> session(setup);
  Controller hand = session.connect("mouse");
  World<float> world(setup);
  std::size_t next = 0;
  std::vector<double> in_session, alone, ratios;
  const auto play_session = [&, frame = 0]() mutable {
    for (int i = 0; i < block; ++i, ++frame) {
      drag(hand, frame);
      session.step_frame();
    }
  };
  const auto play_alone = [&] {
    const CommandLog& commands = session.recording().commands;
    for (CommandLog::Iterator entry(commands, next); next < commands.size(); ++next, ++entry)
      world.apply(std::get<Command>(entry->command));
  };
  for (int i = 0; i < row.frames; i += block) {
    in_session.push_back(timed_us(play_session) / block);
    alone.push_back(timed_us(play_alone) / block);
    ratios.push_back(in_session.back() / alone.back());
  }
  if (digest(world) != digest(session.world()))
    throw WrongResult("live: a session's frames are not the world's");
  for (auto* all : {&in_session, &alone, &ratios}) std::sort(all->begin(), all->end());
  row.bare_us = median(alone);
  row.session_us = median(in_session);
  row.ratio = median(ratios);
}

void time_parts(const Setup& setup, LiveRow& row) {
  World<float> world(setup);
  const Report report = world.advance(1.0 / 120);
  const auto samples = sample_in_turn(
      {{[&] { world.publish(report); }}, {[&] { digest(world); }}, {[&] { world.save(); }}}, {});
  row.publish_us = 1e6 * median(samples[0]);
  row.seal_us = 1e6 * median(samples[1]);
  row.keep_us = 1e6 * median(samples[2]);
}

// At real time, with frames of 1/120 s: what a hand waits for, without any network or page.
void time_answers(const Setup& setup, int count, LiveRow& row) {
  Session<float> session(setup);
  Controller hand = session.connect("mouse");
  session.start();
  std::vector<double> answers;
  for (int i = 1; i <= count; ++i) {
    const Stopwatch watch(false);
    hand.send({.kind = Kind::alive, .sequence = std::uint64_t(i)});
    while (session.status()->sequences[std::size_t(hand.number())] < std::uint64_t(i))
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    answers.push_back(1e3 * watch.seconds());
    std::this_thread::sleep_for(std::chrono::milliseconds(3));  // never at the same place of a frame
  }
  std::sort(answers.begin(), answers.end());
  row.answer_p50_ms = median(answers);
  row.answer_p95_ms = answers[answers.size() * 95 / 100];
}

struct RandomPlay {
  double minutes = 0;  // simulated, on the way to which much was undone
  long frames = 0, commands = 0, returns = 0;
  double playing_s = 0, replaying_s = 0;  // wall time of all threads and delays; processor time on one thread
  double recording_mb = 0;
};

void check_replay(const Setup& setup, const RandomSession& session, int threads) {
  World<float> world(setup, threads);
  const ReplayResult replayed = replay(session.recording, world);
  if (!replayed.same || digest(world) != session.last)
    throw WrongResult("live: command " + std::to_string(replayed.commands) + " of " +
                      std::to_string(session.recording.commands.size()) +
                      " gives other bits when it is replayed on " + std::to_string(threads) + " threads");
}

// Whatever can be done, for so many simulated minutes, by several threads with random delays; then all of it
// again, on one thread and on two.
RandomPlay play_random_hands(const Setup& setup, double minutes) {
  const Box box = bounding_box(setup.mesh);
  RandomSessionOptions options;
  options.hands = {.low = box.min, .high = box.max, .removable = {}};
  for (Index t = 0; t < setup.mesh.tet_count(); t += 97) options.hands.removable.push_back(t);
  options.threads = 2;
  options.seconds = 60 * minutes;
  RandomPlay played;
  const Stopwatch playing(false);
  const RandomSession session = play_at_random(setup, options);
  played.playing_s = playing.seconds();
  if (session.faults > 0) throw WrongResult("live: a picture was torn");
  played.frames = session.frames;
  played.minutes = double(session.frames) / 120 / 60;
  played.commands = long(session.recording.commands.size());
  played.recording_mb = 1e-6 * double(session.recording.commands.bytes());
  for (const RecordedCommand& one : session.recording.commands)
    played.returns += std::holds_alternative<GoBack>(one.command);
  const Stopwatch replaying(true);
  check_replay(setup, session, 1);
  played.replaying_s = replaying.seconds();
  check_replay(setup, session, 2);
  return played;
}

void print(const LiveRow& r) {
  std::printf("%-20s %8d %7d %9.1f %10.1f %9.2f %10.1f %7.1f %7.1f %8.1f %8.1f\n", r.mesh.c_str(), r.tets,
              r.frames, r.bare_us, r.session_us, 100 * (r.ratio - 1), r.publish_us, r.seal_us, r.keep_us,
              r.answer_p50_ms, r.answer_p95_ms);
  std::fflush(stdout);
}

std::string csv(const std::vector<LiveRow>& rows, const RandomPlay& played) {
  std::ostringstream out;
  out << "mesh,tets,frames,bare_us,session_us,overhead,publish_us,seal_us,keep_us,answer_p50_ms,answer_p95_"
         "ms,"
         "random_minutes,random_commands,random_returns,playing_s,replaying_s,recording_mb\n"
      << std::setprecision(4);
  for (const LiveRow& r : rows)
    out << r.mesh << ',' << r.tets << ',' << r.frames << ',' << r.bare_us << ',' << r.session_us << ','
        << r.ratio - 1 << ',' << r.publish_us << ',' << r.seal_us << ',' << r.keep_us << ','
        << r.answer_p50_ms << ',' << r.answer_p95_ms << ",0,0,0,0,0,0\n";
  out << "liver_2k,0,0,0,0,0,0,0,0,0,0," << played.minutes << ',' << played.commands << ',' << played.returns
      << ',' << played.playing_s << ',' << played.replaying_s << ',' << played.recording_mb << '\n';
  return out.str();
}

}  // namespace

void bench_live(const Options& options) {
  begin_results(options.output, "live");
  std::printf("\n%-20s %8s %7s %9s %10s %9s %10s %7s %7s %8s %8s\n", "mesh", "tets", "frames", "bare us",
              "session us", "adds %", "publish us", "seal us", "keep us", "p50 ms", "p95 ms");
  const std::filesystem::path meshes = std::filesystem::path(LOBE_DATA_DIR) / "meshes";
  std::vector<LiveRow> rows;
  const auto run = [&](const std::string& name, const TetMesh& mesh, int frames) {
    LiveRow& row = rows.emplace_back(LiveRow{.mesh = name, .tets = mesh.tet_count()});
    row.frames = options.quick ? std::max(60, frames / 10) : frames;
    const Setup setup = held_liver(mesh);
    time_frames(setup, row);
    time_parts(setup, row);
    if (row.bare_us < 1e6 / 120) time_answers(setup, options.quick ? 50 : 500, row);
    print(row);
  };
  run("liver_2k", read_mesh(meshes / "liver_2k.vtu").mesh, 2400);
  run("liver_10k", read_mesh(meshes / "liver_10k.vtu").mesh, 1200);
  if (!options.quick) run("liver_10k refined", refine(read_mesh(meshes / "liver_10k.vtu").mesh).mesh, 60);
  const double minutes = options.quick ? 0.1 : options.minutes;
  const RandomPlay played = play_random_hands(held_liver(read_mesh(meshes / "liver_2k.vtu").mesh), minutes);
  std::printf(
      "\nrandom hands, liver_2k: %.1f simulated minutes, %ld frames, %ld commands, back %ld times, record of "
      "%.1f MB\nplayed in %.1f s, replayed bit for bit on one thread in %.1f s, and on two\n",
      played.minutes, played.frames, played.commands, played.returns, played.recording_mb, played.playing_s,
      played.replaying_s);
  io::write_file(options.output / "live.csv", csv(rows, played));
}

}  // namespace lobe::bench
