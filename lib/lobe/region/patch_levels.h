// Levels of the patches of a layout (time/own_steps.h): patches of level l kick their vertices in every
// 2^l-th step alone. In a step of which the levels up to s kick, only these are evaluated. A vertex has the
// lowest level of all patches around it, and steps as often as that. There, what it gets from a patch of a
// higher level counts as much more as that patch kicks more seldom.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "lobe/mesh/vertex_lists.h"
#include "lobe/parallel.h"
#include "lobe/region/element_block.h"
#include "lobe/region/patch_layout.h"

namespace lobe {

template <class Real>
class PatchLevels {
 public:
  static constexpr int most = 8;  // levels

  template <class Layout>
  void set(const Layout& layout, std::span<const std::uint8_t> of_patches,
           const std::vector<std::uint8_t>& of_vertices);  // of the mesh
  // Evaluations are of the patches of these levels, both included, until take_all(). They count as above, or
  // once each.
  void take(int lowest, int highest, bool weighed);
  void take_all() { any_left_out_ = false; }

  bool any_left_out() const { return any_left_out_; }
  std::span<const Index> patches() const {
    return {order_.data() + ends_[std::size_t(lowest_)], order_.data() + ends_[std::size_t(highest_) + 1]};
  }
  // f += what the patches have found.
  void add_sums(const VertexLists<Index>& places, const std::vector<PaddedVector<Real>>& sums, Mat3X<Real>& f,
                Parallel& parallel) const;

 private:
  struct Summed {
    Index vertex = 0;
    Real inverse = 1;  // 2^−level
  };

  std::vector<std::uint8_t> of_patches_;
  std::vector<Index> order_;                  // patches by level
  std::array<std::size_t, most + 1> ends_{};  // where each level begins there
  std::vector<Summed> vertices_;              // by the lowest level of their patches in this layout
  std::array<std::size_t, most + 1> vertex_ends_{};
  bool any_left_out_ = false, weighed_ = false;
  int lowest_ = 0, highest_ = 0;
  std::array<Real, most> scales_{};  // per level: of what is evaluated now
};

template <class Real>
template <class Layout>
void PatchLevels<Real>::set(const Layout& layout, std::span<const std::uint8_t> of_patches,
                            const std::vector<std::uint8_t>& of_vertices) {
  of_patches_.assign(of_patches.begin(), of_patches.end());
  order_.clear();
  vertices_.clear();
  std::vector<std::uint8_t> lowest(of_vertices.size(), most);  // of the patches of this layout
  for (Index v : layout.used_vertices())
    for (Index place : layout.places()[v])
      lowest[std::size_t(v)] =
          std::min(lowest[std::size_t(v)], of_patches[std::size_t(place / patch_vertices)]);
  for (int level = 0; level < most; ++level) {
    for (Index p = 0; p < layout.patch_count(); ++p)
      if (of_patches[std::size_t(p)] == level && layout.patch(p).items > 0) order_.push_back(p);
    ends_[std::size_t(level) + 1] = order_.size();
    for (Index v : layout.used_vertices())
      if (lowest[std::size_t(v)] == level)
        vertices_.push_back({v, Real(1) / Real(1 << of_vertices[std::size_t(v)])});
    vertex_ends_[std::size_t(level) + 1] = vertices_.size();
  }
}

template <class Real>
void PatchLevels<Real>::take(int lowest, int highest, bool weighed) {
  any_left_out_ = true;
  weighed_ = weighed;
  lowest_ = lowest;
  highest_ = highest;
  for (int level = 0; level < most; ++level)
    scales_[std::size_t(level)] =
        level < lowest || level > highest ? Real(0) : Real(weighed ? 1 << level : 1);
}

// In the order of the list of a vertex. Factors are powers of two: where all patches are of one level, the
// bits are those of a plain sum.
template <class Real>
void PatchLevels<Real>::add_sums(const VertexLists<Index>& places,
                                 const std::vector<PaddedVector<Real>>& sums, Mat3X<Real>& f,
                                 Parallel& parallel) const {
  using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;
  const Index count = static_cast<Index>(vertex_ends_[std::size_t(highest_) + 1]);
  parallel.for_ranges(count, 4096, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Summed& summed = vertices_[std::size_t(i)];
      Four sum{}, of_patch;
      for (const Index place : places[summed.vertex]) {
        const Real scale = scales_[of_patches_[std::size_t(place / patch_vertices)]];
        if (scale == 0) continue;  // its sums are old
        std::memcpy(&of_patch, &sums[std::size_t(place)], sizeof of_patch);
        sum += scale * of_patch;
      }
      if (weighed_) sum *= summed.inverse;
      for (int d = 0; d < 3; ++d) f(d, summed.vertex) += sum[d];
    }
  });
}

}  // namespace lobe
