// What all watches have in common: what they report of a frame, and what they know of a world's edits.
#pragma once

#include "lobe/sim/world.h"

namespace lobe {

struct WatchReport {
  double time = 0;   // [s]
  double error = 0;  // estimated L2 error of the displacement, as a share of its largest L2 norm so far
  Vec3d place = Vec3d::Zero();  // a point where it is made, at rest [m]
  bool exceeded = false;        // whether the error exceeds the tolerance
};

// Reads a world's journal from where it was read last.
class EditReader {
 public:
  EditReader() = default;  // has read nothing
  template <class Real>
  explicit EditReader(const World<Real>& world) {
    read(world);
  }

  struct News {
    std::size_t first = 0;      // first new entry of the journal
    bool has_edits = false;     // the journal has other entries
    bool was_restored = false;  // whether the world went back to a state before some edits
    bool any() const { return has_edits || was_restored; }
  };
  template <class Real>
  News read(const World<Real>& world) {
    const std::size_t entries = world.journal().edits.size(), first = std::exchange(known_, entries);
    const std::uint64_t restored = world.body().model.revisions.restored;
    return {first, first != entries, std::exchange(restored_, restored) != restored};
  }

 private:
  std::size_t known_ = ~std::size_t(0);
  std::uint64_t restored_ = 0;
};

}  // namespace lobe
