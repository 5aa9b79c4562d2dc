// lobe bench haptic: forces between frames against the same body in frames of 1 ms, of a tool that holds and
// of one that only touches.
#include <cstdio>
#include <iomanip>
#include <sstream>

#include "benchmarks/haptic_body.h"
#include "benchmarks/haptic_rig.h"
#include "benchmarks/haptic_touch.h"
#include "benchmarks/secant.h"
#include "benchmarks/static_stiffness.h"
#include "lobe/file/atomic_file.h"

namespace lobe::bench {
namespace {

struct ErrorRow {
  std::string mesh, contact;
  double frame_hz = 0, force_hz = 0, speed = 0, peak = 0;
  std::string method;
  PredictionError error;
};

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

// What is compared: predictions between frames, on one path.
struct Comparison {
  const HapticBody& body;
  const char* contact;
  double frame, tick, delay;  // [s]
  double speed;               // [m/s]
  std::vector<FeltFrame> frames, reference;
  std::vector<ErrorRow>& rows;

  void add(const char* method, const Predict& predict) const {
    const PredictionError error = error_of(frames, reference, delay, tick, predict);
    rows.push_back({body.mesh, contact, 1 / frame, 1 / tick, speed, error.peak, method, error});
    std::printf("%-12s %-6s %6.0f %6.0f %7.2f %7.2f  %-20s %8.1f %8.1f %8.1f\n", body.mesh.c_str(), contact,
                1 / frame, 1 / tick, speed, error.peak, method, 100 * error.rms, 100 * error.highest,
                100 * error.jump);
    std::fflush(stdout);
  }
  void add_simple(const HandPath& path) const {
    add("constant", constant(frames));
    add("linear in time", linear_in_time(frames));
    add("linear in position", linear_in_position(frames, path));
  }
};

void compare_holding(Comparison of, const Mat3<double>& of_body) {
  const HandPath path = press_and_pull(inwards, along, 0.01, of.speed);
  const auto& frames = of.frames = feel(of.body.setup, of.body.contact, path, of.frame, true);
  of.reference = feel(of.body.setup, of.body.contact, path, 1e-3, false);
  const auto secants = by_secant_alone(frames);
  of.add_simple(path);
  of.add("K: secant (a)", by_stiffness(frames, path, [&](std::size_t k) { return secants[k]; }));
  of.add("K: blocked (b)", by_stiffness(frames, path, [&](std::size_t k) { return frames[k].blocked; }));
  of.add("K: patch (c)", by_stiffness(frames, path, [&](std::size_t k) { return frames[k].patch; }));
  of.add("K: whole body (d)", by_stiffness(frames, path, [&](std::size_t) { return of_body; }));
  of.add("K: c fitted", by_stiffness(frames, path, [&](std::size_t k) { return frames[k].K; }));
  of.add("the servo", by_servo(frames, path, of.tick));
}

void compare_touching(Comparison of) {
  constexpr double gap = 0.004, depth = 0.009;  // [m]
  const HandPath path = touch_and_slide(inwards, along, gap, depth, of.speed);
  const Sphere sphere = sphere_before(of.body.setup, tip, inwards, gap);
  of.frames = feel_touch(of.body.setup, sphere, path, of.frame);
  of.reference = feel_touch(of.body.setup, sphere, path, 1e-3);
  of.add_simple(path);
  of.add("K: c fitted", by_local_model(of.frames, path));
  of.add("the servo", by_servo(of.frames, path, of.tick));
}

std::string csv(const std::vector<ErrorRow>& rows) {
  std::ostringstream out;
  out << "mesh,contact,frame_hz,force_hz,speed,peak_N,method,rms,max,jump\n" << std::setprecision(4);
  for (const ErrorRow& r : rows)
    out << r.mesh << ',' << r.contact << ',' << r.frame_hz << ',' << r.force_hz << ',' << r.speed << ','
        << r.peak << ',' << r.method << ',' << r.error.rms << ',' << r.error.highest << ',' << r.error.jump
        << '\n';
  return out.str();
}

}  // namespace

void compare_predictions(const Options& options, const std::vector<HapticBody>& bodies) {
  std::printf("\n%-12s %-6s %6s %6s %7s %7s  %-20s %8s %8s %8s\n", "mesh", "", "frame", "force", "speed",
              "peak N", "between frames", "rms %", "max %", "jump %");
  std::vector<ErrorRow> rows;
  for (const HapticBody& body : bodies) {
    if (options.quick && body.mesh != "liver_2k") continue;
    World<double> at_rest(body.setup);
    const Mat3<double> of_body = clamped(static_stiffness(at_rest, body.contact), 1e9);
    for (double speed : {0.02, 0.05, 0.1, 0.2}) {
      if (options.quick && speed != 0.1) continue;
      const auto compared = [&](const char* contact, double frame, double tick, double delay) -> Comparison {
        return {body, contact, frame, tick, delay, speed, {}, {}, rows};
      };
      compare_holding(compared("hold", 1.0 / 120, 1e-3, 2e-3), of_body);
      compare_holding(compared("hold", 1.0 / 20, 2e-3, 0), of_body);
      compare_touching(compared("touch", 1.0 / 120, 1e-3, 2e-3));
      compare_touching(compared("touch", 1.0 / 20, 2e-3, 0));
    }
  }
  io::write_file(options.output / "haptic.csv", csv(rows));
}

}  // namespace lobe::bench
