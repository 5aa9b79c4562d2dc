// lobe bench haptic: forces between frames against the same body in frames of 1 ms, and how punctual a loop
// at 1 kHz is beside a simulation, and an empty one without it.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <sstream>
#include <thread>

#include "benchmarks/benchmarks.h"
#include "benchmarks/empty_loop.h"
#include "benchmarks/haptic_rig.h"
#include "benchmarks/machine.h"
#include "benchmarks/secant.h"
#include "benchmarks/timing.h"
#include "lobe/haptic/devices.h"
#include "lobe/haptic/haptic_hand.h"
#include "lobe/haptic/loop.h"
#include "lobe/haptic/trial.h"
#include "lobe/io/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/refine.h"
#include "lobe/solve/tangent.h"

namespace lobe::bench {
namespace {

const Vec3d tip{0.082, -0.045, 0.035};                    // of the left lobe [m]
const Vec3d inwards = Vec3d(-1, 0.5, -0.6).normalized();  // there
const Vec3d along = inwards.cross(Vec3d::UnitZ()).normalized();

struct Body {
  std::string mesh;
  Setup setup;
  std::vector<Index> contact;
};

Body liver(const std::string& name, const TetMesh& mesh) {
  Body body;
  body.mesh = name;
  Setup& setup = body.setup;
  setup.mesh = mesh;
  setup.materials = {{4e4, 1e4, 1000}};
  setup.material_of.assign(std::size_t(mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  setup.damping = 20;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.points(0, v) < -0.02 && mesh.points(1, v) > 0.015)
      setup.prescribed.push_back({v, Vec3d::Zero()});
    if ((mesh.points.col(v) - tip).norm() < 0.02) body.contact.push_back(v);
  }
  return body;
}

// ---- Predictions

struct ErrorRow {
  std::string mesh;
  double frame_hz = 0, force_hz = 0, speed = 0, peak = 0;
  std::string method;
  PredictionError error;
};

// Of the body at rest with everything yielding: way d.
Mat3<double> static_stiffness(const Body& body) {
  World<double> world(body.setup);
  HeldVertices held = world.held();
  for (Index v : body.contact) held.hold({v, 1, Vec3d::Zero(), Vec3d::Zero()});
  const Unknowns unknowns = free_components(world.elements(), held);
  Tangent tangent(world.elements(), unknowns);
  const Mat3X<double> u = world.displacements();
  tangent.update(u);
  const auto factor = tangent.make_factor(make_ldlt);
  bool damped = false;
  tangent.factorise(*factor, damped);
  Mat3<double> K = Mat3<double>::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    Mat3X<double> w = Mat3X<double>::Zero(3, u.cols());
    for (Index v : body.contact) w(axis, v) = 1;
    const Mat3X<double> moved =
        w + unknowns.scatter(tangent.solve(*factor, Eigen::VectorXd::Zero(unknowns.count), u, w));
    constexpr double h = 1e-6;
    const Mat3X<double> change = energy_and_forces(world.elements(), h * moved).forces -
                                 energy_and_forces(world.elements(), -h * moved).forces;
    for (Index v : body.contact) K.col(axis) -= change.col(v) / (2 * h);
  }
  return clamped(K, 1e9);
}

// Way a: from nothing, by what motions and forces say.
std::vector<Mat3<double>> by_secant_alone(const std::vector<FeltFrame>& frames) {
  std::vector<Mat3<double>> all;
  Mat3<double> K = Mat3<double>::Zero();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i > 0)
      K += secant_correction(K, frames[i].position - frames[i - 1].position,
                             frames[i].force - frames[i - 1].force, 5e-5);
    K = clamped(K, highest_eigenvalue(frames[i].blocked));
    all.push_back(K);
  }
  return all;
}

void compare(const Body& body, const Mat3<double>& of_body, double frame, double tick, double delay,
             double speed, std::vector<ErrorRow>& rows) {
  const HandPath path = press_and_pull(inwards, along, 0.01, speed);
  const auto frames = feel(body.setup, body.contact, path, frame, true);
  const auto reference = feel(body.setup, body.contact, path, 1e-3, false);
  const auto secants = by_secant_alone(frames);
  const auto add = [&](const char* method, const Predict& predict) {
    const PredictionError error = error_of(frames, reference, delay, tick, predict);
    rows.push_back({body.mesh, 1 / frame, 1 / tick, speed, error.peak, method, error});
    std::printf("%-12s %6.0f %6.0f %7.2f %7.2f  %-20s %8.1f %8.1f %8.1f\n", body.mesh.c_str(), 1 / frame,
                1 / tick, speed, error.peak, method, 100 * error.rms, 100 * error.highest, 100 * error.jump);
  };
  add("constant", constant(frames));
  add("linear in time", linear_in_time(frames));
  add("linear in position", linear_in_position(frames, path));
  add("K: secant (a)", by_stiffness(frames, path, [&](std::size_t k) { return secants[k]; }));
  add("K: blocked (b)", by_stiffness(frames, path, [&](std::size_t k) { return frames[k].blocked; }));
  add("K: patch (c)", by_stiffness(frames, path, [&](std::size_t k) { return frames[k].patch; }));
  add("K: whole body (d)", by_stiffness(frames, path, [&](std::size_t) { return of_body; }));
  add("K: c fitted", by_stiffness(frames, path, [&](std::size_t k) { return frames[k].K; }));
  add("the servo", by_servo(frames, path, tick));
  std::fflush(stdout);
}

std::string csv(const std::vector<ErrorRow>& rows) {
  std::ostringstream out;
  out << "mesh,frame_hz,force_hz,speed,peak_N,method,rms,max,jump\n" << std::setprecision(4);
  for (const ErrorRow& r : rows)
    out << r.mesh << ',' << r.frame_hz << ',' << r.force_hz << ',' << r.speed << ',' << r.peak << ','
        << r.method << ',' << r.error.rms << ',' << r.error.highest << ',' << r.error.jump << '\n';
  return out.str();
}

// ---- The clock

struct LoopRow {
  std::string mesh, mode, thread;
  double seconds = 0, frame = 0, factor = 0;
  double late[4] = {}, compute[3] = {};  // p50, p99, p99.9, longest; p50, p99, longest [µs]
  double missed = 0;                     // share of the ticks
};

// Keeps a core busy.
class Load {
 public:
  explicit Load(bool runs) {
    if (runs)
      thread_ = std::thread([this] {
        volatile double x = 1;
        while (!stops_.load(std::memory_order_relaxed)) x = x * 1.0000001 + 1e-9;
      });
  }
  ~Load() {
    stops_ = true;
    if (thread_.joinable()) thread_.join();
  }

 private:
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

std::string histogram_rows(const LoopRow& row, const LoopTimes& times) {
  std::ostringstream out;
  for (int bucket = 0; bucket < Histogram::buckets; ++bucket)
    if (times.lateness[bucket] + times.compute[bucket] > 0)
      out << row.mesh << ',' << row.mode << ',' << row.thread << ',' << bucket << ','
          << times.lateness[bucket] << ',' << times.compute[bucket] << '\n';
  return out.str();
}

void take_times(const LoopTimes& times, LoopRow& row) {
  const double late[] = {0.5, 0.99, 0.999}, compute[] = {0.5, 0.99};
  for (int i = 0; i < 3; ++i) row.late[i] = times.lateness.quantile(late[i]);
  row.late[3] = times.lateness.longest();
  for (int i = 0; i < 2; ++i) row.compute[i] = times.compute.quantile(compute[i]);
  row.compute[2] = times.compute.longest();
  row.missed = double(times.missed) / (double(times.missed) + double(times.compute.total()));
}

void print(const LoopRow& row) {
  std::printf("%-12s %-13s %-9s %6.0f %8.1f %8.2f  %5.0f %6.0f %7.0f %7.0f  %5.0f %5.0f %6.0f  %.1e\n",
              row.mesh.c_str(), row.mode.c_str(), row.thread.c_str(), row.seconds, 1e3 * row.frame,
              row.factor, row.late[0], row.late[1], row.late[2], row.late[3], row.compute[0], row.compute[1],
              row.compute[2], row.missed);
  std::fflush(stdout);
}

LoopRow time_loop(const Body& body, double frame, int priority, double seconds, std::string& histograms) {
  Session<float> session(body.setup, {.frame = frame});
  Controller controller = session.connect("hand");
  const HandPath path = press_and_pull(inwards, along, 0.01, 0.05);
  const double whole = path.duration();
  SimulatedHand device({}, [=](double time) { return path.at(std::fmod(time, whole)); });
  HapticLink link;
  HapticHand<float> hand(session, link, {.controller = controller.number()});
  controller.send({.kind = HandCommand::Kind::take_at_point, .hand = 1, .position = tip, .radius = 0.02});
  HapticLoop loop(device, link, {.priority = priority});
  session.start();
  const Load load(true);
  loop.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  loop.forget_times();
  const double before = session.status()->time;
  const Stopwatch watch(false);
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  LoopRow row;
  row.mesh = body.mesh;
  row.mode = frame <= direct_frame ? "direct" : "extrapolated";
  row.seconds = watch.seconds();
  row.frame = frame;
  row.factor = (session.status()->time - before) / row.seconds;
  row.thread = loop.is_real_time() ? "fifo" : "ordinary";
  take_times(loop.times(), row);
  loop.stop();
  session.stop();
  histograms += histogram_rows(row, loop.times());
  print(row);
  return row;
}

// With the same load, and no session.
LoopRow time_empty(int priority, double seconds) {
  const Load load(true);
  LoopTimes times;
  LoopRow row;
  row.mesh = "none";
  row.mode = "empty";
  row.thread = time_empty_loop(priority, seconds, times) ? "fifo" : "ordinary";
  row.seconds = seconds;
  take_times(times, row);
  print(row);
  return row;
}

std::string csv(const std::vector<LoopRow>& rows) {
  std::ostringstream out;
  out << "mesh,mode,thread,seconds,frame_ms,real_time_factor,late_p50_us,late_p99_us,late_p999_us,late_max_"
         "us,"
         "compute_p50_us,compute_p99_us,compute_max_us,missed\n"
      << std::setprecision(4);
  for (const LoopRow& r : rows) {
    out << r.mesh << ',' << r.mode << ',' << r.thread << ',' << r.seconds << ',' << 1e3 * r.frame << ','
        << r.factor;
    for (double value : r.late) out << ',' << value;
    for (double value : r.compute) out << ',' << value;
    out << ',' << r.missed << '\n';
  }
  return out.str();
}

// Lateness and compute time of all ticks, per mode and kind of thread, on the last mesh of the table.
const char* const haptic_plot = R"gp(set terminal pngcairo size 1000,420 font ',11'
set output 'haptic.png'
set datafile separator ','
set multiplot layout 1,2
set logscale xy
set xrange [1:5000]
set yrange [0.8:*]
set xlabel 'µs'
set ylabel 'ticks'
is(mesh, mode, thread) = strcol(1) eq mesh && strcol(2) eq mode && strcol(3) eq thread
mesh = system("tail -n 1 haptic_histogram.csv | cut -d , -f 1")
set title 'lateness of a tick, '.mesh
plot for [mode in 'direct extrapolated'] for [thread in 'fifo ordinary'] 'haptic_histogram.csv' \
  using (is(mesh, mode, thread) && $5 > 0 ? $4 + 1 : NaN):5 with points pt 7 ps 0.6 title mode.', '.thread
set title 'time that a tick takes, '.mesh
plot for [mode in 'direct extrapolated'] for [thread in 'fifo ordinary'] 'haptic_histogram.csv' \
  using (is(mesh, mode, thread) && $6 > 0 ? $4 + 1 : NaN):6 with points pt 7 ps 0.6 title mode.', '.thread
unset multiplot
)gp";

void time_loops(const Options& options, const std::vector<Body>& bodies) {
  std::printf("\n%-12s %-13s %-9s %6s %8s %8s  %5s %6s %7s %7s  %5s %5s %6s  %s\n", "mesh", "mode", "thread",
              "s", "frame ms", "x real", "p50", "p99", "p99.9", "max us", "p50", "p99", "max us", "missed");
  std::vector<LoopRow> rows;
  std::string histograms = "mesh,mode,thread,us,late,compute\n";
  for (const Body& body : bodies) {
    const HapticTrial trial = try_direct<float>(body.setup);
    std::printf("%s: a frame of 1 ms takes %.2f ms, p99 %.2f: %s\n", body.mesh.c_str(), 1e3 * trial.p50,
                1e3 * trial.p99, trial.is_direct ? "direct" : "extrapolated");
    const double frame = trial.is_direct ? direct_frame : 1.0 / 120;
    const double seconds = options.quick ? 2 : 20;
    rows.push_back(time_empty(50, seconds));
    rows.push_back(time_loop(body, frame, 50, seconds, histograms));
    rows.push_back(time_loop(body, frame, 0, seconds, histograms));
    if (trial.is_direct) rows.push_back(time_loop(body, 1.0 / 120, 50, seconds, histograms));
  }
  io::write_file(options.output / "haptic_loop.csv", csv(rows));
  io::write_file(options.output / "haptic_histogram.csv", histograms);
  io::write_file(options.output / "haptic.gp", haptic_plot);
}

void compare_predictions(const Options& options, const std::vector<Body>& bodies) {
  std::printf("\n%-12s %6s %6s %7s %7s  %-20s %8s %8s %8s\n", "mesh", "frame", "force", "speed", "peak N",
              "between frames", "rms %", "max %", "jump %");
  std::vector<ErrorRow> rows;
  for (const Body& body : bodies) {
    if (options.quick && body.mesh != "liver_2k") continue;
    const Mat3<double> of_body = static_stiffness(body);
    for (double speed : {0.02, 0.05, 0.1, 0.2}) {
      if (options.quick && speed != 0.1) continue;
      compare(body, of_body, 1.0 / 120, 1e-3, 2e-3, speed, rows);
      compare(body, of_body, 1.0 / 20, 2e-3, 0, speed, rows);
    }
  }
  io::write_file(options.output / "haptic.csv", csv(rows));
}

}  // namespace

void bench_haptic(const Options& options) {
  begin_results(options.output, "haptic");
  const std::filesystem::path meshes = std::filesystem::path(LOBE_DATA_DIR) / "meshes";
  std::vector<Body> bodies{liver("liver_2k", read_mesh(meshes / "liver_2k.vtu").mesh),
                           liver("liver_10k", read_mesh(meshes / "liver_10k.vtu").mesh)};
  if (!options.loop) compare_predictions(options, bodies);
  if (options.quick) bodies.resize(1);
  if (!options.quick)
    bodies.push_back(liver("liver_82k", refine(read_mesh(meshes / "liver_10k.vtu").mesh).mesh));
  for (const std::filesystem::path& mesh : options.meshes) {
    Body body = liver(mesh.stem().string(), read_mesh(mesh).mesh);
    bodies.push_back(body);
    body.mesh += "_reduced";
    std::fill(body.setup.region_of.begin(), body.setup.region_of.end(), RegionModel::reduced);
    bodies.push_back(std::move(body));
  }
  time_loops(options, bodies);
}

}  // namespace lobe::bench
