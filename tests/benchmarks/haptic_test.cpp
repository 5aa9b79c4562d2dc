// `lobe bench haptic`.
#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "benchmarks/bench_results.h"
#include "benchmarks/secant.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;
using bench::secant_correction;

TEST_CASE("the secant takes up what the last motion says, and nothing across it") {
  Mat3<double> K = Vec3d(300, 300, 100).asDiagonal();
  const Vec3d way(0.002, 0, 0), force(-1, 0.1, 0);  // 500 N/m along x, and −50 N/m of it along y
  const Mat3<double> better = K + secant_correction(K, way, force, 1e-9);
  CHECK((better * way + force).norm() < 1e-9);
  CHECK(better.isApprox(better.transpose()));
  CHECK(better(2, 2) == near(100, 1e-9));
  CHECK(better(1, 1) == near(300, 1e-9));
  CHECK(secant_correction(K, Vec3d::Zero(), force, 5e-5).norm() == 0);
  CHECK(secant_correction(K, 1e-6 * Vec3d::UnitX(), force, 5e-5).norm() <
        1e-2 * secant_correction(K, 1e-6 * Vec3d::UnitX(), force, 0).norm());
}

TEST_CASE("lobe bench haptic writes an error per prediction") {
  const BenchResults results("haptic", "--quick --predictions");
  std::map<std::string, double> at_20_hz, jump_of_touch;
  for (const Record& row : results.rows("haptic")) {
    CHECK((std::isfinite(number(row, "rms")) && number(row, "rms") > 0));
    CHECK(number(row, "rms") <= number(row, "max"));
    const bool holds = row.at("contact") == "hold";
    CHECK((holds || row.at("contact") == "touch"));
    if (holds && number(row, "frame_hz") == 20) at_20_hz[row.at("method")] = number(row, "rms");
    if (!holds && number(row, "frame_hz") == 120) jump_of_touch[row.at("method")] = number(row, "jump");
  }
  REQUIRE(at_20_hz.size() == 9);
  // What the paper's group found in 1999.
  CHECK(at_20_hz["constant"] > at_20_hz["linear in time"]);
  CHECK(at_20_hz["linear in time"] > at_20_hz["linear in position"]);
  REQUIRE(jump_of_touch.size() == 5);
  CHECK(jump_of_touch["the servo"] < 0.5 * jump_of_touch["constant"]);
  CHECK(jump_of_touch["the servo"] < 0.5 * jump_of_touch["linear in time"]);
}

TEST_CASE("lobe bench haptic writes the times of each loop with their histograms") {
  const BenchResults results("haptic", "--quick --loop");
  const auto loops = results.rows("haptic_loop");
  REQUIRE(loops.size() >= 3);
  int empty = 0;
  for (const Record& row : loops) {
    CHECK(number(row, "compute_p50_us") > 0);
    CHECK(number(row, "late_p50_us") <= number(row, "late_max_us"));
    if (row.at("mode") == "empty")
      ++empty;
    else
      CHECK(number(row, "real_time_factor") > 0);
  }
  CHECK(empty == 1);
  CHECK(results.rows("haptic_histogram").size() > 20);
}
