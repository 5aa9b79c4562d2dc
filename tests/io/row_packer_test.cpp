#include "lobe/file/row_packer.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

using namespace lobe::io;

namespace {

std::string packed(const std::vector<PoseNumbers>& rows) {
  RowPacker packer;
  std::string bytes;
  for (const PoseNumbers& row : rows) packer.put(row, bytes);
  return bytes;
}

void check_comes_back(const std::vector<PoseNumbers>& rows) {
  const std::string bytes = packed(rows);
  RowPacker packer;
  ByteReader in("rows", bytes);
  for (const PoseNumbers& row : rows) {
    const PoseNumbers read = packer.get(in);
    REQUIRE(std::memcmp(read.data(), row.data(), sizeof row) == 0);
  }
  in.expect_end();
}

// Of a tool that is led in circles, and turned if it `turns`.
std::vector<PoseNumbers> gesture(bool turns) {
  std::vector<PoseNumbers> rows;
  for (int i = 0; i < 2000; ++i) {
    const double s = 0.03 * i;
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    if (turns) q = Eigen::AngleAxisd(std::sin(s), Eigen::Vector3d(1, 2, std::cos(0.1 * s)).normalized());
    rows.push_back({0.04 * std::sin(s), 0.03 * std::cos(s), 0.01 * std::sin(0.3 * s), q.x(), q.y(), q.z(),
                    i * std::ldexp(1, -7), q.w(), 0.005});
  }
  return rows;
}

}  // namespace

TEST_CASE("rows come back to the last bit, whatever numbers they hold") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> odd = {0,      -0.0,     1,         -1,           1e308, -1e308,
                                   5e-324, infinity, -infinity, std::nan(""), 1e-9};
  std::mt19937_64 random(1);
  std::vector<PoseNumbers> rows = gesture(true);
  for (int i = 0; i < 3000; ++i) {
    PoseNumbers row = i > 0 && i % 3 == 0 ? rows.back() : PoseNumbers{};
    for (double& number : row) {
      const std::uint64_t toss = random() % 4;
      if (toss == 0) number = odd[random() % odd.size()];
      if (toss == 1) number = std::uniform_real_distribution<double>(-1, 1)(random);
    }
    rows.push_back(row);
  }
  check_comes_back(rows);
  check_comes_back(gesture(false));
}

TEST_CASE("a row of a tool that moves takes 20 bytes, one of a tool that turns as well 40, one at rest 1") {
  CHECK(double(packed(gesture(false)).size()) / 2000 < 20);
  CHECK(double(packed(gesture(true)).size()) / 2000 < 40);
  CHECK(packed(std::vector<PoseNumbers>(1000, gesture(true)[7])).size() < 1100);
}

TEST_CASE("rows that are cut off are refused") {
  const std::string bytes = packed(gesture(true)).substr(0, 100);
  RowPacker packer;
  ByteReader in("rows", bytes);
  CHECK_THROWS_AS(
      [&] {
        while (true) packer.get(in);
      }(),
      lobe::InputError);
}
