#include "benchmarks/soak_sessions.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <sstream>

#include "benchmarks/machine.h"
#include "benchmarks/random_hands.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"
#include "lobe/live/session.h"
#include "lobe/mesh/generators.h"

namespace lobe::bench {
namespace sessions {
namespace {

using Kind = HandCommand::Kind;

constexpr double edge = 0.04;  // of the body [m]

Setup small_body() {
  Setup setup;
  setup.mesh = box_mesh(Vec3d::Constant(edge), 2, 2, 2);
  prepare(setup.mesh, "block");
  const auto tets = std::size_t(setup.mesh.tet_count());
  setup.materials = {Elastic{}};
  setup.material_of.assign(tets, 0);
  setup.region_of.assign(tets, RegionModel::nonlinear);
  setup.damping = 20;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 1e-4) setup.prescribed.push_back({v});
  return setup;
}

// Processor times of frames, in one place for all of them [µs].
class FrameTimes {
 public:
  explicit FrameTimes(std::size_t frames) { times_.reserve(frames); }
  void add(double seconds) { times_.push_back(float(1e6 * seconds)); }

  struct Of {
    double median = 0, most_but_a_thousandth = 0, largest = 0;
  };
  Of tenth(std::size_t number) const {  // from 0
    const std::size_t size = times_.size() / 10;
    std::vector<float> part(times_.begin() + std::ptrdiff_t(number * size),
                            times_.begin() + std::ptrdiff_t((number + 1) * size));
    std::sort(part.begin(), part.end());
    return {part[size / 2], part[size - 1 - size / 1000], part.back()};
  }
  double bytes() const { return double(times_.capacity() * sizeof(float)); }
  std::size_t above(double most) const {
    return std::size_t(std::count_if(times_.begin(), times_.end(), [&](float t) { return t > most; }));
  }

 private:
  std::vector<float> times_;
};

struct Row {
  const char* hands = "";
  std::size_t frames = 0;
  double minutes = 0;          // of the session
  double bytes_per_frame = 0;  // in the second half
  double allocated_mb = 0;     // by the session, in the end
  double recording_mb = 0;
  FrameTimes::Of first, last;  // tenth
  std::size_t late = 0;        // frames that took longer than they last
};

// before_frame(frame) sends what hands do.
Row play(const char* hands, std::size_t frames, Session<float>& session, double allocated_before,
         const std::function<void(std::size_t)>& before_frame) {
  FrameTimes times(frames);
  double halfway = 0;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    if (frame == frames / 2) halfway = allocated_bytes();
    before_frame(frame);
    const Stopwatch watch(true);
    session.step_frame();
    times.add(watch.seconds());
  }
  const double end = allocated_bytes();
  return {hands,
          frames,
          double(frames) * session.frame() / 60,
          2 * (end - halfway) / double(frames),
          1e-6 * (end - times.bytes() - allocated_before),
          1e-6 * double(session.recording().commands.bytes()),
          times.tenth(0),
          times.tenth(9),
          times.above(1e6 * session.frame())};
}

void check_replay(const char* hands, Session<float>& session, const Setup& setup) {
  World<float> world(setup);
  const ReplayResult replayed = replay(session.recording(), world);
  if (!replayed.same || digest(world) != digest(session.world()))
    throw WrongResult(std::string("soak: a replay of the session with hands \"") + hands +
                      "\" gives other bits");
}

Row idle(const Setup& setup, std::size_t frames) {
  const double before = allocated_bytes();
  Session<float> session(setup);
  const Row row = play("none", frames, session, before, [](std::size_t) {});
  check_replay(row.hands, session, setup);
  return row;
}

// A pose every other frame, as from a mouse.
Row led(const Setup& setup, std::size_t frames) {
  const double before = allocated_bytes();
  Session<float> session(setup);
  Controller mouse = session.connect("mouse");
  const Vec3d corner = Vec3d::Constant(edge);
  mouse.send({.kind = Kind::take_at_point, .hand = 1, .position = corner, .radius = 0.005});
  const Row row = play("one leads", frames, session, before, [&](std::size_t frame) {
    if (frame % 2 != 0) return;
    const double s = 0.02 * double(frame);
    const Vec3d way = 0.005 * Vec3d(std::sin(s), std::cos(1.3 * s), std::sin(0.7 * s));
    mouse.send({.kind = Kind::lead, .hand = 1, .position = corner + way});
  });
  check_replay(row.hands, session, setup);
  return row;
}

// A grasp after the other, six a second.
Row many(const Setup& setup, std::size_t frames) {
  const double before = allocated_bytes();
  Session<float> session(setup);
  Controller mouse = session.connect("mouse");
  const Vec3d corner = Vec3d::Constant(edge);
  const Row row = play("many tools", frames, session, before, [&](std::size_t frame) {
    const double s = 0.02 * double(frame);
    const Vec3d way = 0.003 * Vec3d(std::sin(s), std::cos(1.3 * s), std::sin(0.7 * s));
    if (frame % 20 == 0)
      mouse.send({.kind = Kind::take_at_point, .hand = 1, .position = corner, .radius = 0.005});
    else if (frame % 20 == 19)
      mouse.send({.kind = Kind::let_go, .hand = 1});
    else if (frame % 2 == 0)
      mouse.send({.kind = Kind::lead, .hand = 1, .position = corner + way});
  });
  check_replay(row.hands, session, setup);
  return row;
}

Row random(const Setup& setup, std::size_t frames) {
  const double before = allocated_bytes();
  Session<float> session(setup);
  Controller somebody = session.connect("somebody");
  RandomHands hands(1, {.low = Vec3d::Zero(), .high = Vec3d::Constant(edge), .removable = {}});
  const Row row = play("random", frames, session, before, [&](std::size_t frame) {
    somebody.send(hands.next());
    if (frame % 4 == 0) somebody.send({.kind = Kind::run, .on = true});
  });
  check_replay(row.hands, session, setup);
  return row;
}

void print(const std::vector<Row>& rows) {
  std::printf("%-10s %9s %8s %8s %8s %9s   %28s   %28s %5s\n", "hands", "frames", "minutes", "B/frame", "MB",
              "record MB", "first tenth: 50, 99.9, 100 %", "last tenth [us]: 50, 99.9, 100 %", "late");
  for (const Row& r : rows)
    std::printf("%-10s %9zu %8.0f %8.1f %8.1f %9.1f   %8.1f %9.1f %9.1f   %10.1f %10.1f %10.1f %5zu\n",
                r.hands, r.frames, r.minutes, r.bytes_per_frame, r.allocated_mb, r.recording_mb,
                r.first.median, r.first.most_but_a_thousandth, r.first.largest, r.last.median,
                r.last.most_but_a_thousandth, r.last.largest, r.late);
}

std::string table(const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "hands,frames,minutes,bytes_per_frame,allocated_mb,recording_mb,first_p50_us,first_p999_us,"
         "first_max_us,last_p50_us,last_p999_us,last_max_us,late\n";
  for (const Row& r : rows) {
    out << r.hands << ',' << r.frames << ',' << r.minutes << ',' << r.bytes_per_frame << ',' << r.allocated_mb
        << ',' << r.recording_mb;
    for (const FrameTimes::Of& of : {r.first, r.last})
      out << ',' << of.median << ',' << of.most_but_a_thousandth << ',' << of.largest;
    out << ',' << r.late << '\n';
  }
  return out.str();
}

}  // namespace
}  // namespace sessions

void soak_sessions(const Options& options) {
  const std::size_t frames = options.quick ? 20'000 : std::size_t(options.frames);
  const Setup setup = sessions::small_body();
  std::vector<sessions::Row> rows;
  for (const auto& play : {sessions::idle, sessions::led, sessions::many, sessions::random})
    rows.push_back(play(setup, frames));
  sessions::print(rows);
  io::write_file(options.output / "soak_sessions.csv", sessions::table(rows));
}

}  // namespace lobe::bench
