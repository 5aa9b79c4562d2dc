// lobe bench haptic: what is felt between frames (haptic_predictions.cpp), and how punctual a loop at 1 kHz
// is beside a simulation, and an empty one without it.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <sstream>
#include <thread>

#include "benchmarks/benchmarks.h"
#include "benchmarks/empty_loop.h"
#include "benchmarks/haptic_body.h"
#include "benchmarks/haptic_rig.h"
#include "benchmarks/machine.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"
#include "lobe/haptic/devices.h"
#include "lobe/haptic/haptic_hand.h"
#include "lobe/haptic/loop.h"
#include "lobe/haptic/trial.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/refine.h"

namespace lobe::bench {
namespace {

HapticBody liver(const std::string& name, const TetMesh& mesh) {
  HapticBody body{.mesh = name, .setup = held_liver(mesh), .contact = {}};
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if ((mesh.points.col(v) - left_tip).norm() < 0.02) body.contact.push_back(v);
  return body;
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

LoopRow time_loop(const HapticBody& body, double frame, int priority, double seconds,
                  std::string& histograms) {
  Session<float> session(body.setup, {.frame = frame});
  Controller controller = session.connect("hand");
  const HandPath path = press_and_pull(inwards, along, 0.01, 0.05);
  const double whole = path.duration();
  SimulatedHand device({}, [=](double time) { return path.at(std::fmod(time, whole)); });
  HapticLink link;
  HapticHand<float> hand(session, link, {.controller = controller.number()});
  controller.send(
      {.kind = HandCommand::Kind::take_at_point, .hand = 1, .position = left_tip, .radius = 0.02});
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

void time_loops(const Options& options, const std::vector<HapticBody>& bodies) {
  std::printf("\n%-12s %-13s %-9s %6s %8s %8s  %5s %6s %7s %7s  %5s %5s %6s  %s\n", "mesh", "mode", "thread",
              "s", "frame ms", "x real", "p50", "p99", "p99.9", "max us", "p50", "p99", "max us", "missed");
  std::vector<LoopRow> rows;
  std::string histograms = "mesh,mode,thread,us,late,compute\n";
  for (const HapticBody& body : bodies) {
    const HapticTrial trial = try_direct<float>(body.setup);
    std::printf("%s: a frame of 1 ms takes %.2f ms, p99 %.2f: %s\n", body.mesh.c_str(), 1e3 * trial.p50,
                1e3 * trial.p99, trial.is_direct ? "direct" : "extrapolated");
    const double frame = trial.is_direct ? direct_frame : 1.0 / 120;
    const double seconds = options.quick ? 2 : 60;
    rows.push_back(time_empty(50, seconds));
    rows.push_back(time_loop(body, frame, 50, seconds, histograms));
    rows.push_back(time_loop(body, frame, 0, seconds, histograms));
    if (trial.is_direct) rows.push_back(time_loop(body, 1.0 / 120, 50, seconds, histograms));
  }
  io::write_file(options.output / "haptic_loop.csv", csv(rows));
  io::write_file(options.output / "haptic_histogram.csv", histograms);
  io::write_file(options.output / "haptic.gp", haptic_plot);
}

}  // namespace

void bench_haptic(const Options& options) {
  begin_results(options.output, "haptic");
  const std::filesystem::path meshes = std::filesystem::path(LOBE_DATA_DIR) / "meshes";
  std::vector<HapticBody> bodies{liver("liver_2k", read_mesh(meshes / "liver_2k.vtu").mesh),
                                 liver("liver_10k", read_mesh(meshes / "liver_10k.vtu").mesh)};
  std::vector<HapticBody> further;
  for (const std::filesystem::path& mesh : options.meshes)
    further.push_back(liver(mesh.stem().string(), read_mesh(mesh).mesh));
  std::vector<HapticBody> compared = bodies;
  compared.insert(compared.end(), further.begin(), further.end());
  if (!options.loop) compare_predictions(options, compared);
  if (options.predictions) return;
  if (options.quick) bodies.resize(1);
  if (!options.quick)
    bodies.push_back(liver("liver_82k", refine(read_mesh(meshes / "liver_10k.vtu").mesh).mesh));
  for (HapticBody& body : further) {
    bodies.push_back(body);
    body.mesh += "_reduced";
    std::fill(body.setup.region_of.begin(), body.setup.region_of.end(), RegionModel::reduced);
    bodies.push_back(std::move(body));
  }
  time_loops(options, bodies);
}

}  // namespace lobe::bench
