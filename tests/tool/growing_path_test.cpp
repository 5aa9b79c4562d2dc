// The oracle is a plain list of rows.
#include "lobe/tool/growing_path.h"

#include <doctest/doctest.h>

#include <random>

#include "lobe/file/fields.h"

using namespace lobe;

namespace {

PathPoint row(double time) { return {time, Vec3d(time, 2 * time, -time), {0, 0, 0, 1}, 0.5 * time}; }

bool same(const PathPoint& a, const PathPoint& b) {
  return a.time == b.time && a.position == b.position && a.orientation == b.orientation &&
         a.opening == b.opening;
}

bool same(const std::vector<PathPoint>& a, const std::vector<PathPoint>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const PathPoint& x, const PathPoint& y) { return same(x, y); });
}

// As long as it has not lost more rows than it is said to keep at hand.
void check_is(const GrowingPath& path, const std::vector<PathPoint>& rows) {
  REQUIRE(same(path.all(), rows));
  REQUIRE(path.size() == rows.size());
  REQUIRE(path.empty() == rows.empty());
  if (rows.empty()) return;
  REQUIRE(same(path.front(), rows.front()));
  REQUIRE(same(path.back(), rows.back()));
  const auto& recent = path.recent();
  REQUIRE(same(recent, {rows.end() - std::ptrdiff_t(recent.size()), rows.end()}));
}

}  // namespace

TEST_CASE(
    "a path that grows, forgets, settles and is copied is the list of its rows, and so are its copies") {
  std::mt19937 random(3);
  const auto one_of = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  std::vector<PathPoint> rows;
  GrowingPath path;
  std::vector<std::pair<GrowingPath, std::vector<PathPoint>>> copies;
  for (int i = 1; i < 5000; ++i) {
    const int what = one_of(100);
    if (what < 90) {
      rows.push_back(row(i));
      path.push_back(row(i));
    } else if (what < 96 && !rows.empty()) {
      const double time = rows.back().time - 0.5 - one_of(what == 95 ? 300 : 3);
      while (!rows.empty() && rows.back().time > time) rows.pop_back();
      path.forget_after(time);
    } else if (what < 97) {
      path.settle();
    } else if (what < 98) {
      path = GrowingPath::from_saved(path.as_saved());
    } else if (what < 99 || copies.empty()) {
      copies.emplace_back(path, rows);
    } else {  // as a world is put back
      std::tie(path, rows) = copies[std::size_t(one_of(int(copies.size())))];
    }
    check_is(path, rows);
  }
  CHECK(copies.size() > 20);
  for (const auto& [copy, own] : copies) check_is(copy, own);
}

TEST_CASE("the last rows of a path are at hand, and all of one that has not grown") {
  std::vector<PathPoint> rows;
  GrowingPath path;
  for (int i = 0; i < 1000; ++i) {
    rows.push_back(row(i));
    path.push_back(row(i));
    CHECK(path.recent().size() >= std::min(rows.size(), GrowingPath::few));
    if (i < 3) continue;
    for (const double time : {i - 2.0, i - 1.25, i - 1.0, i - 0.5, double(i), i + 1.0})
      CHECK(path_at(path.recent(), time) == path_at(rows, time));
  }
  CHECK(GrowingPath(rows).recent().size() == rows.size());
}

TEST_CASE("a copy of a long path has few rows of its own, one that is settled or of a scene has none") {
  GrowingPath path;
  for (int i = 0; i < 72000; ++i) path.push_back(row(i));  // ten minutes of a hand
  const std::size_t whole = 72000 * sizeof(PathPoint);
  CHECK(io::memory_of(path) < whole / 200);
  const GrowingPath of_scene(path.all());
  CHECK(io::memory_of(of_scene) < 100);
  path.settle();
  CHECK(io::memory_of(path) < whole / 250);
  CHECK(path.recent().capacity() == 2);
  CHECK(path.size() == 72000);
}

TEST_CASE("in a file a path is the list of its rows, however it has become so") {
  GrowingPath grown;
  std::vector<PathPoint> rows;
  for (int i = 0; i < 300; ++i) {
    grown.push_back(row(i));
    rows.push_back(row(i));
  }
  CHECK(io::digest_of_fields(grown) == io::digest_of_fields(rows));
  io::ByteWriter out;
  io::put(out, grown);
  io::ByteReader in("path", out.bytes());
  GrowingPath read;
  io::get(in, read);
  check_is(read, rows);
}
