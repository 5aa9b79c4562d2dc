#include "lobe/forces/needle_passage.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "near.h"

using namespace lobe;
using namespace lobe::test;
using Kind = NeedleHold::Kind;
using Tip = NeedlePassage::Tip;

namespace {

const NeedleShape half_circle{0.01, std::numbers::pi, 5e-4};

EmbeddedPoint point_of(Index tet) { return {tet, Eigen::Vector4d::Constant(0.25)}; }

NeedleHold hold(Kind kind, double s, Index tet = 0) { return {point_of(tet), kind, s}; }

NeedlePassage passage(std::vector<NeedleHold> holds, Tip tip) {
  NeedlePassage made;
  made.holds = std::move(holds);
  made.tip = tip;
  made.at = point_of(9);
  REQUIRE(made.is_valid());
  return made;
}

std::vector<double> lengths_of(const NeedlePassage& passage) {
  std::vector<double> lengths;
  passage.share_length(half_circle, lengths);
  return lengths;
}

}  // namespace

TEST_CASE("places on a needle are on its circle, and its direction is the way in which it is turned") {
  const NeedleShape needle{0.012, 2, 4e-4};
  CHECK(needle.length() == near(0.024, 1e-15));
  CHECK((needle.place(0) - Vec3d(0.012, 0, 0)).norm() == 0);
  CHECK((needle.forward(0) - Vec3d(0, 1, 0)).norm() == 0);
  for (const double s : {0.0, 0.003, 0.024}) {
    CHECK(needle.place(s).norm() == near(0.012, 1e-15));
    const double h = 1e-6;  // turned by h about z, it goes forward
    const Vec3d moved = Eigen::AngleAxisd(h, Vec3d::UnitZ()) * needle.place(s);
    CHECK(((moved - needle.place(s)) / (0.012 * h) - needle.forward(s)).norm() < 1e-6);
    CHECK((needle.place(s - 0.012 * h) - moved).norm() < 1e-12);
  }
  const NeedlePose pose{{1, 2, 3},
                        Eigen::AngleAxisd(std::numbers::pi / 2, Vec3d::UnitX()).toRotationMatrix()};
  CHECK((pose.place(needle, 0) - Vec3d(1.012, 2, 3)).norm() < 1e-15);
  CHECK((pose.forward(needle, 0) - Vec3d(0, 0, 1)).norm() < 1e-15);
}

TEST_CASE("a needle that cannot be is named") {
  CHECK(half_circle.fault().empty());
  CHECK(NeedleShape{}.fault().find("radius") != std::string::npos);
  CHECK(NeedleShape{0.01, 0, 5e-4}.fault().find("angle") != std::string::npos);
  CHECK(NeedleShape{0.01, 7, 5e-4}.fault().find("angle") != std::string::npos);
  CHECK(NeedleShape{0.01, 1, 0.02}.fault().find("thickness") != std::string::npos);
  CHECK(NeedleShape{std::nan(""), 1, 5e-4}.fault().find("radius") != std::string::npos);
}

TEST_CASE("each hold has the length half way to the next ones, and together they have all that is inside") {
  const NeedlePassage one = passage({hold(Kind::entry, 0.008), hold(Kind::inside, 0.005)}, Tip::inside);
  CHECK(one.length_inside(half_circle) == near(0.008, 1e-12));
  CHECK(lengths_of(one)[0] == near(0.0015, 1e-12));
  CHECK(lengths_of(one)[1] == near(0.0065, 1e-12));

  // Both lips of a cut, the tip out again.
  const NeedlePassage two = passage(
      {hold(Kind::entry, 0.02), hold(Kind::exit, 0.014), hold(Kind::entry, 0.011), hold(Kind::exit, 0.004)},
      Tip::free);
  CHECK(two.length_inside(half_circle) == near(0.006 + 0.007, 1e-12));
  CHECK(lengths_of(two)[1] == near(0.003, 1e-12));

  // Its end is in the tissue.
  const NeedlePassage end = passage({hold(Kind::inside, 0.03), hold(Kind::exit, 0.02)}, Tip::free);
  CHECK(end.length_inside(half_circle) == near(half_circle.length() - 0.02, 1e-12));
  CHECK(lengths_of(passage({}, Tip::free)).empty());
}

TEST_CASE("bites are what the needle's end has passed, in their order") {
  NeedlePassage through = passage({hold(Kind::entry, 0.033, 1), hold(Kind::inside, 0.032, 2),
                                   hold(Kind::exit, 0.0315, 3), hold(Kind::entry, 0.02, 4)},
                                  Tip::inside);
  through.pass_end(half_circle);
  REQUIRE(through.passed.size() == 2);
  CHECK(through.passed[0] == point_of(1));
  CHECK(through.passed[1] == point_of(3));
  REQUIRE(through.holds.size() == 1);
  CHECK(through.holds[0].point == point_of(4));
  through.pass_end(half_circle);
  CHECK(through.passed.size() == 2);
}

TEST_CASE("a tip is on the surface until it punctures it, on its way in and on its way out") {
  NeedlePassage needle;
  needle.touch(point_of(1), Eigen::Vector4d::UnitX());
  CHECK(needle.tip == Tip::pushing);
  needle.come_off();
  CHECK(needle.tip == Tip::free);
  needle.puncture();
  CHECK(needle.holds.empty());

  needle.touch(point_of(1), Eigen::Vector4d::UnitX());
  needle.puncture();
  CHECK(needle.tip == Tip::inside);
  REQUIRE(needle.holds.size() == 1);
  CHECK(needle.holds[0].kind == Kind::entry);
  needle.holds[0].s = 0.002;
  needle.go_to(point_of(2), 0.003, 14);
  CHECK(needle.holds.size() == 1);
  needle.holds[0].s = 0.003;
  needle.go_to(point_of(3), 0.003, 14);
  REQUIRE(needle.holds.size() == 2);
  CHECK(needle.holds[1].point == point_of(3));

  needle.touch(point_of(4), Eigen::Vector4d::UnitX());
  CHECK(needle.tip == Tip::leaving);
  needle.come_off();
  CHECK(needle.tip == Tip::inside);
  needle.touch(point_of(4), Eigen::Vector4d::UnitX());
  needle.puncture();
  CHECK(needle.tip == Tip::free);
  CHECK(needle.holds.back().kind == Kind::exit);
  CHECK(needle.is_valid());
}

TEST_CASE("a needle that is drawn back out leaves the tissue as it came, and no bite") {
  NeedlePassage needle = passage(
      {hold(Kind::entry, 0.006, 1), hold(Kind::inside, 0.003, 2), hold(Kind::exit, -0.001, 3)}, Tip::free);
  needle.draw_back();
  CHECK(needle.tip == Tip::inside);
  CHECK(needle.at == point_of(3));
  needle.holds[1].s = -0.001;
  needle.draw_back();
  CHECK(needle.tip == Tip::inside);
  CHECK(needle.holds.size() == 1);
  needle.holds[0].s = -0.001;
  needle.draw_back();
  CHECK(needle.tip == Tip::free);
  CHECK(!needle.is_in_tissue());
  CHECK(needle.passed.empty());

  NeedlePassage at_once = passage({hold(Kind::entry, -1e-4), hold(Kind::inside, -2e-4)}, Tip::inside);
  at_once.draw_back();
  CHECK(!at_once.is_in_tissue());
}

TEST_CASE("what is left of tissue that is cut away begins and ends at the holds that are left") {
  const auto gone = [](Index a, Index b) {
    return [a, b](const EmbeddedPoint& point) { return point.tet == a || point.tet == b; };
  };
  const auto whole = [] {
    return passage({hold(Kind::entry, 0.012, 1), hold(Kind::inside, 0.009, 2), hold(Kind::inside, 0.006, 3),
                    hold(Kind::exit, 0.003, 4)},
                   Tip::free);
  };
  NeedlePassage needle = whole();
  CHECK(needle.forget(gone(1, -1)) == 1);
  CHECK(needle.holds.front().kind == Kind::entry);
  CHECK(needle.holds.front().point == point_of(2));
  CHECK(needle.is_valid());

  needle = whole();
  CHECK(needle.forget(gone(4, -1)) == 1);
  CHECK(needle.holds.back().kind == Kind::exit);
  CHECK(needle.holds.back().point == point_of(3));

  needle = whole();
  CHECK(needle.forget(gone(2, 3)) == 2);
  CHECK(needle.holds.size() == 2);
  CHECK(needle.is_valid());

  // All but one point of a lip: it holds nothing. The other lip stays.
  needle = passage({hold(Kind::entry, 0.02, 1), hold(Kind::exit, 0.015, 2), hold(Kind::entry, 0.012, 3),
                    hold(Kind::exit, 0.004, 4)},
                   Tip::free);
  CHECK(needle.forget(gone(1, -1)) == 1);
  REQUIRE(needle.holds.size() == 2);
  CHECK(needle.holds.front().point == point_of(3));

  // The tissue at the tip has gone: it is outside.
  needle = passage({hold(Kind::entry, 0.012, 1), hold(Kind::inside, 0.009, 2)}, Tip::inside);
  CHECK(needle.forget(gone(9, -1)) == 0);
  CHECK(needle.tip == Tip::free);
  CHECK(needle.holds.back().kind == Kind::exit);
  CHECK(needle.is_valid());

  // All but the tissue at the tip has gone.
  needle = passage({hold(Kind::entry, 0.012, 1), hold(Kind::inside, 0.009, 1)}, Tip::inside);
  CHECK(needle.forget(gone(1, -1)) == 2);
  CHECK(needle.tip == Tip::inside);
  REQUIRE(needle.holds.size() == 1);
  CHECK(needle.holds[0].point == point_of(9));
  CHECK(needle.is_valid());
}

TEST_CASE("a tip meets a triangle from the side asked for, where the two are at the same time") {
  Mat3<double> triangle;
  triangle << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  const Mat3<double> raised = triangle.colwise() + Vec3d(0, 0, 0.5);
  const Vec3d above(0.25, 0.5, 1), below(0.25, 0.5, -1);
  const auto met = meeting(above, below, triangle, triangle, true, 0);
  REQUIRE(met);
  CHECK(met->share == near(0.5, 1e-14));
  CHECK((met->weights - Vec3d(0.25, 0.25, 0.5)).norm() < 1e-14);
  CHECK(!meeting(above, below, triangle, triangle, false, 0));
  CHECK(!meeting(below, above, triangle, triangle, true, 0));
  CHECK(meeting(below, above, triangle, triangle, false, 0));
  // The triangle comes to meet it: 1 − 2 τ = τ/2.
  CHECK(meeting(above, below, triangle, raised, true, 0)->share == near(0.4, 1e-14));
  CHECK(!meeting(above + Vec3d(1, 0, 0), below + Vec3d(1, 0, 0), triangle, triangle, true, 0));
  // Just beyond it, and on the way in.
  const Vec3d beyond(0.25, 0.5, -1e-4);
  CHECK(!meeting(beyond, below, triangle, triangle, true, 0));
  CHECK(meeting(beyond, below, triangle, triangle, true, 1e-3)->share == 0);
  CHECK(!meeting(below, 2 * below, triangle, triangle, true, 1e-3));
  Mat3<double> flat = triangle;
  flat.col(2) = flat.col(1);
  CHECK(!meeting(above, below, flat, flat, true, 0));
}

TEST_CASE("a tip that goes through the edge of two triangles meets one of them at least") {
  Mat3<double> left, right;
  left << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  right << 1, 1, 0, 0, 1, 1, 0, 0, 0;
  for (int i = 1; i < 100; ++i) {
    const double a = i / 100.0;
    const Vec3d from(a, 1 - a, 0.3), to(a, 1 - a, -0.7);
    CHECK((meeting(from, to, left, left, true, 0) || meeting(from, to, right, right, true, 0)));
  }
}
