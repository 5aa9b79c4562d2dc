// Evaluation in patches. A patch copies the displacements of its vertices, so that they stay in the first
// cache, and adds up the forces on them in separate memory. Then each vertex sums what its patches found, in
// the order of a list, so that the result does not depend on threads. A patch at rest can keep its sums.
#pragma once

#include <algorithm>
#include <cstring>
#include <span>

#include "lobe/parallel.h"
#include "lobe/region/element_block.h"
#include "lobe/region/patch_layout.h"
#include "lobe/region/patch_levels.h"

namespace lobe {

struct SmallestVolumeRatio {  // det F over a region
  double smallest_volume_ratio = 1;
  Index smallest_tet = -1;
};

struct PatchCount {  // patches over all evaluations
  long long evaluated = 0, skipped = 0;
};

template <class Real>
class PatchSums {
 public:
  using Vector = PaddedVector<Real>;
  using LocalVectors = std::array<Vector, std::size_t(patch_vertices)>;
  static constexpr Index patches_at_once = 8;  // patches per thread: fewer are done before another has woken

  void resize(Index patches) { resize_with_room(sums_, std::size_t(patches) * patch_vertices); }

  template <class Layout>
  static void gather(const Layout& layout, Index p, const Mat3X<Real>& u, LocalVectors& local) {
    const Index* vertices = layout.vertices(p);
    for (Index n = 0; n < layout.patch(p).vertices; ++n) {
      const Real* of_vertex = u.data() + 3 * std::size_t(vertices[n]);
      local[n].xyz0 = {of_vertex[0], of_vertex[1], of_vertex[2], 0};
    }
  }

  // Call it right after add_forces(): patches whose vertices are all `still` keep their sums until forget().
  template <class Layout>
  void keep(const Layout& layout, const std::vector<std::uint8_t>& still) {  // still: one flag per vertex
    keeps_ = true;
    awake_.clear();
    for (Index p = 0; p < layout.patch_count(); ++p) {
      const std::span<const Index> vertices = layout.vertices_of(p);
      if (!std::all_of(vertices.begin(), vertices.end(), [&](Index v) { return still[v] != 0; }))
        awake_.push_back(p);
    }
  }
  // Marks the vertices of the patches that do not keep their sums.
  template <class Layout>
  void mark_awake(const Layout& layout, std::vector<std::uint8_t>& vertices) const {
    for (Index p : awake_)
      for (Index v : layout.vertices_of(p)) vertices[v] = 1;
  }
  // While sums are kept, forces are added only at these vertices. They must include those of mark_awake().
  template <class Layout>
  void add_at(const Layout& layout, const std::vector<std::uint8_t>& vertices) {
    summed_.clear();
    for (Index v : layout.used_vertices())
      if (vertices[v]) summed_.push_back(v);
  }
  void forget() { keeps_ = false; }
  const PatchCount& count() const { return count_; }

  // From here on, until take_all(), only patches of some levels are evaluated.
  PatchLevels<Real>& levels() { return levels_; }

  // Calls evaluate(patch, its displacements [m], sums of forces [N]) for each patch that does not keep them.
  template <class Layout, class Evaluate>
  void add_forces(const Layout& layout, const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel,
                  Evaluate&& evaluate) {
    const bool by_levels = levels_.any_left_out();
    const std::span<const Index> some = by_levels ? levels_.patches() : std::span<const Index>(awake_);
    const bool takes_some = by_levels || keeps_;
    const Index evaluated = takes_some ? static_cast<Index>(some.size()) : layout.patch_count();
    count_.evaluated += evaluated;
    count_.skipped += layout.patch_count() - evaluated;
    parallel.for_ranges(evaluated, patches_at_once, [&](Index begin, Index end) {
      LocalVectors local;
      for (Index i = begin; i < end; ++i) {
        const Index p = takes_some ? some[std::size_t(i)] : i;
        Vector* sums = sums_.data() + std::size_t(p) * patch_vertices;
        std::fill_n(sums, layout.patch(p).vertices, Vector{});
        gather(layout, p, u, local);
        evaluate(p, local, sums);
      }
    });
    if (by_levels) return levels_.add_sums(layout.places(), sums_, f, parallel);
    const std::vector<Index>& used = keeps_ ? summed_ : layout.used_vertices();
    parallel.for_ranges(static_cast<Index>(used.size()), 4096, [&](Index begin, Index end) {
      sum_places(layout.places(), {used.data() + begin, used.data() + end}, f);
    });
  }

 private:
  // Sums lie as far apart as the patches: they are asked for ahead.
  void sum_places(const VertexLists<Index>& places, std::span<const Index> vertices, Mat3X<Real>& f) const {
    using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;
    const std::span<const Index> all = places.items();
    for (Index v : vertices) {
      Four sum{}, of_patch;
      for (const Index& place : places[v]) {
        const std::size_t ahead = std::size_t(&place - all.data()) + 32;
        if (ahead < all.size()) __builtin_prefetch(sums_.data() + all[ahead]);
        std::memcpy(&of_patch, &sums_[place], sizeof of_patch);
        sum += of_patch;
      }
      for (int d = 0; d < 3; ++d) f(d, v) += sum[d];
    }
  }

  std::vector<Vector> sums_;  // sum of each place [N]
  bool keeps_ = false;
  std::vector<Index> awake_;   // patches that do not keep their sums
  std::vector<Index> summed_;  // vertices at which forces are added meanwhile
  PatchLevels<Real> levels_;
  PatchCount count_;
};

}  // namespace lobe
