// A whole session in its thread, with those who send to it and those who look at it in theirs: meant for the
// thread sanitizer, too.
#include <array>
#include <atomic>
#include <numeric>
#include <random>
#include <thread>
#include <vector>

#include "live/hands_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr auto relaxed = std::memory_order_relaxed;  // what the test itself shares orders nothing
constexpr std::int64_t least_frames = 300;
constexpr int looks = 300;  // of each reader, at least
constexpr Index cut_tets = 12;

struct Seen {
  std::atomic<int> pictures = 0;
  int faults = 0;
};

// Parts of one picture fit together.
bool is_whole(const Snapshot<float>& picture, const TetMesh& mesh) {
  const SurfaceMesh& surface = *picture.surface.mesh;
  bool whole = picture.u.cols() >= mesh.vertex_count() && picture.v.cols() == picture.u.cols() &&
               picture.surface.x.cols() == surface.vertex_count() &&
               picture.surface.normals.cols() == surface.vertex_count() && picture.u.allFinite();
  for (Index i = 0; whole && i < surface.vertex_count(); ++i) {
    const Index v = surface.mesh_vertex[std::size_t(i)];
    if (v >= mesh.vertex_count()) continue;  // made by a cut
    const Vec3<float> x = (mesh.points.col(v) + picture.u.col(v).cast<double>()).cast<float>();
    whole = (picture.surface.x.col(i) - x).norm() <= 1e-6F * x.norm() + 1e-9F;
  }
  return whole;
}

void look(const Session<float>& session, const TetMesh& mesh, const std::atomic<bool>& done, Seen& seen) {
  std::int64_t frame = -1, frames = -1;
  while (!done.load(relaxed)) {
    if (const auto picture = session.pictures().latest()) {
      seen.faults += !is_whole(*picture, mesh) || picture->frame < frame;
      frame = picture->frame;
      seen.pictures.fetch_add(1, relaxed);
    }
    if (const auto status = session.status()) {
      seen.faults += status->frames < frames;
      frames = status->frames;
    }
  }
}

void pull(Session<float>& session, const std::atomic<bool>& done) {
  Controller hands = session.connect("hands");
  std::mt19937 random(7);
  std::uniform_real_distribution<double> offset(-0.004, 0.004);
  while (!done.load(relaxed)) {
    hands.send(take_at(top));
    for (int i = 0; i < 30 && !done.load(relaxed); ++i) {
      hands.send(lead_to(top + Vec3d(offset(random), offset(random), offset(random))));
      std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
    hands.send(ask(Kind::let_go));
  }
}

void cut(Session<float>& session) {
  for (Index tet = 0; tet < cut_tets; tet += 2) {
    Controller surgeon = session.connect("surgeon");
    surgeon.send({.kind = Kind::edit, .body_edit = std::make_shared<const Edit>(RemoveTets{{tet, tet + 1}})});
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace

TEST_CASE("those who look at a session see whole pictures, in order, while others pull and cut; it replays") {
  const Setup setup = block();
  SessionOptions options;
  options.paced = false;
  Session<float> session(setup, options);
  std::array<Seen, 2> seen;
  std::atomic<bool> done = false;
  session.start();
  std::vector<std::thread> threads;
  for (Seen& one : seen) threads.emplace_back([&] { look(session, setup.mesh, done, one); });
  threads.emplace_back([&] { pull(session, done); });
  threads.emplace_back([&] { cut(session); });
  std::int64_t frames = 0;
  const auto all_have_seen_enough = [&] {
    return std::all_of(seen.begin(), seen.end(),
                       [](const Seen& one) { return one.pictures.load(relaxed) >= looks; });
  };
  while (frames < least_frames || !all_have_seen_enough()) {
    session.between_frames([&] {
      REQUIRE(session.world().displacements().allFinite());
      frames = session.status()->frames;
    });
  }
  done.store(true, relaxed);
  for (std::thread& thread : threads) thread.join();
  session.stop();
  for (const Seen& one : seen) CHECK(one.faults == 0);
  World<float> cut_at_rest(setup);
  std::vector<Index> tets(cut_tets);
  std::iota(tets.begin(), tets.end(), 0);
  cut_at_rest.remove_tets(tets);
  CHECK(session.world().elements().topology.alive_count() == cut_at_rest.elements().topology.alive_count());
  CHECK(times_said(session, "stands_still") == 0);
  CHECK(replays(session, setup));
}
