// The skin of a scene (lobe/skin/skin.h) for pages: the triangles that cuts have left, and their positions.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>

#include "lobe/sim/world.h"
#include "lobe/skin/skin.h"
#include "protocol.h"

namespace lobe::view {

// What does not change from one picture to the next.
struct ShownSkin {
  std::uint64_t revision = 0;  // grows with each change of its triangles
  std::vector<Eigen::Vector3i> triangles;
  Mat3X<float> rest;  // 3 × #vertices [m]
};

template <class Real>
class SkinFeed {
 public:
  // `world` is at its start, and its scene has the skin `file`. It must outlive the last update(). Throws
  // InputError.
  SkinFeed(const std::filesystem::path& file, const TetMesh& mesh, World<Real>& world);

  // Call it between frames, on the thread that advances the world. It does nothing while no page wants the
  // skin. O(#vertices), 30 µs for a skin of 3,000.
  void update(World<Real>& world);

  // ---- Any thread

  void set_wanted(bool on) { is_wanted_ = on; }
  // Writes the blocks of the latest positions, and of the triangles if `told` is another revision.
  // `first_stamp` distinguishes them from those of other simulations.
  void write(std::uint64_t first_stamp, std::uint64_t& told, BlockWriter& out) const;

 private:
  struct Picture {
    std::shared_ptr<const ShownSkin> shown;
    Mat3X<float> x;  // 3 × #vertices [m]
  };
  static constexpr std::uint64_t never = ~std::uint64_t(0);
  bool follow_restored(const World<Real>& world);
  void show();

  Skin skin_;
  const Skin whole_;                 // skin at the start: a world that is put back may have what was cut
  std::uint64_t skin_revision_ = 0;  // revision that was shown last
  Mat3X<float> rest_, normals_;
  std::shared_ptr<const ShownSkin> shown_;
  std::uint64_t restored_;  // how often the world had been put back when the skin last followed it
  std::atomic<bool> is_wanted_ = false;
  TripleBuffer<Picture> pictures_;
};

}  // namespace lobe::view
