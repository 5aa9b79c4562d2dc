// One thread that writes and four that read, all as fast as they can: meant for the thread sanitizer, too.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include "lobe/snapshot/snapshot.h"
#include "lobe/snapshot/triple_buffer.h"

using namespace lobe;

namespace {

// What the test itself shares must order nothing: that is for the buffer to do.
constexpr auto relaxed = std::memory_order_relaxed;

constexpr int readers = 4;
constexpr long least_frames = 20000, least_pictures = 1000;  // of each reader, at least

Index vertices_in(std::int64_t frame) { return 20 + Index(frame / 100 % 50); }  // some frames cut

void fill(Snapshot<float>& picture, std::int64_t frame, std::shared_ptr<const SurfaceMesh>& shared) {
  const Index n = vertices_in(frame);
  if (!shared || shared->vertex_count() != n) {
    SurfaceMesh mesh;
    mesh.revision = shared ? shared->revision + 1 : 1;
    mesh.mesh_vertex.assign(std::size_t(n), Index(mesh.revision));
    shared = std::make_shared<const SurfaceMesh>(std::move(mesh));
  }
  picture.frame = frame;
  picture.time = 0.5 * double(frame);
  picture.u.setConstant(3, n, float(frame));
  picture.v.setConstant(3, n, -float(frame));
  picture.surface.mesh = shared;
  picture.surface.x.setConstant(3, n, float(2 * frame));
  picture.tools.resize(1 + std::size_t(frame) % 3);
  for (ToolSnapshot& tool : picture.tools) tool.force.setConstant(double(frame));
  picture.figures.steps = int(frame);
}

bool is_whole(const Snapshot<float>& picture) {
  const auto frame = picture.frame;
  const Index n = vertices_in(frame);
  bool whole = picture.time == 0.5 * double(frame) && picture.figures.steps == frame;
  whole = whole && picture.u.cols() == n && (picture.u.array() == float(frame)).all();
  whole = whole && picture.v.cols() == n && (picture.v.array() == -float(frame)).all();
  whole = whole && picture.surface.x.cols() == n && (picture.surface.x.array() == float(2 * frame)).all();
  whole = whole && picture.surface.mesh->vertex_count() == n;
  for (const Index v : picture.surface.mesh->mesh_vertex)
    whole = whole && v == Index(picture.surface.mesh->revision);
  whole = whole && picture.tools.size() == 1 + std::size_t(frame) % 3;
  for (const ToolSnapshot& tool : picture.tools) whole = whole && tool.force.z() == double(frame);
  return whole;
}

struct Seen {
  std::atomic<long> pictures = 0;
  long faults = 0;
  std::int64_t last = -1;
};

// Until it has seen the last frame, whose number is −1 while there are more to come. Every hundredth picture
// or so is held for a while, and must be the same afterwards.
void read(const TripleBuffer<Snapshot<float>>& buffer, const std::atomic<std::int64_t>& last_frame,
          unsigned seed, Seen& seen) {
  std::mt19937 random(seed);
  while (last_frame.load(relaxed) < 0 || seen.last < last_frame.load(relaxed)) {
    const auto picture = buffer.latest();
    if (!picture) continue;
    const std::int64_t frame = picture->frame;
    seen.faults += !is_whole(*picture) || frame < seen.last;
    if (random() % 100 == 0) {
      std::this_thread::sleep_for(std::chrono::microseconds(random() % 1000));
      seen.faults += !is_whole(*picture) || picture->frame != frame;
    }
    seen.last = frame;
    seen.pictures.fetch_add(1, relaxed);
  }
}

}  // namespace

TEST_CASE(
    "four readers see whole pictures alone, in order, and the last one; the writer is never without a slot") {
  TripleBuffer<Snapshot<float>> buffer(readers);
  std::array<Seen, readers> seen;
  std::atomic<std::int64_t> last_frame = -1;
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < readers; ++i)
    threads.emplace_back([&, i] { read(buffer, last_frame, i, seen[i]); });
  std::shared_ptr<const SurfaceMesh> shared;
  long left_out = 0;
  std::int64_t frame = -1;
  const auto all_have_seen_enough = [&] {
    return std::all_of(seen.begin(), seen.end(),
                       [](const Seen& one) { return one.pictures.load(relaxed) >= least_pictures; });
  };
  while (frame < least_frames || !all_have_seen_enough()) {
    Snapshot<float>* const picture = buffer.writable();
    left_out += picture == nullptr;
    if (picture == nullptr) continue;
    fill(*picture, ++frame, shared);
    buffer.publish();
  }
  last_frame.store(frame, relaxed);
  for (std::thread& thread : threads) thread.join();
  CHECK(left_out == 0);
  for (const Seen& one : seen) {
    CHECK(one.faults == 0);
    CHECK(one.last == frame);
  }
}

TEST_CASE("readers that hoard views make the writer leave values out, never wait or overwrite") {
  TripleBuffer<Snapshot<float>> buffer(1);
  std::atomic<bool> done = false;
  std::atomic<long> faults = 0;
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < readers; ++i)
    threads.emplace_back([&, i] {
      std::mt19937 random(i);
      std::array<TripleBuffer<Snapshot<float>>::View, 3> held;
      while (!done.load(relaxed)) {
        auto& view = held[random() % held.size()];
        if (view) faults.fetch_add(!is_whole(*view), relaxed);
        view = buffer.latest();
      }
    });
  std::shared_ptr<const SurfaceMesh> shared;
  std::int64_t published = 0;
  long left_out = 0;
  while (published < least_frames || left_out == 0) {
    Snapshot<float>* const picture = buffer.writable();
    left_out += picture == nullptr;
    if (picture == nullptr) continue;
    fill(*picture, published++, shared);
    buffer.publish();
  }
  done.store(true, relaxed);
  for (std::thread& thread : threads) thread.join();
  CHECK(faults == 0);
  REQUIRE(buffer.writable() != nullptr);  // all were given back
}
