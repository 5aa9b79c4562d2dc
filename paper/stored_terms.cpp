#include "paper/stored_terms.h"

#include <algorithm>

#include "lobe/fem/law_of.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

template <class Terms>
using Carrier =
    std::array<std::uint8_t, std::size_t(Terms::vertices)>;  // ascending, as the patch numbers them

// The terms of each carrier, summed over the tetrahedra of a patch in the order in which they are added.
template <class Terms>
class TermSums {
 public:
  void add(const Carrier<Terms>& carrier, const Terms& terms) {
    carriers_.emplace_back(carrier, static_cast<Index>(terms_.size()));
    terms_.push_back(terms);
  }

  // Carriers that follow each other in ascending order are put in different blocks, so that those of one
  // block seldom share a vertex. A sum in memory that was just written is slow to read again.
  template <class Real>
  std::vector<TermBlock<Real, Terms>> blocks() {
    const std::vector<std::pair<Carrier<Terms>, Index>> sums = add_up();
    constexpr std::size_t width = TermBlock<Real, Terms>::width;
    std::vector<TermBlock<Real, Terms>> blocks((sums.size() + width - 1) / width);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const auto& [carrier, at] = sums[i];
      TermBlock<Real, Terms>& block = blocks[i % blocks.size()];
      const std::size_t lane = i / blocks.size();
      for (int k = 0; k < Terms::size; ++k) block.values[k][lane] = static_cast<Real>(terms_[at].values[k]);
      for (int c = 0; c < Terms::vertices; ++c) block.vertices[c][lane] = carrier[c];
    }
    return blocks;
  }

 private:
  // Each carrier once, with the place of its sum.
  std::vector<std::pair<Carrier<Terms>, Index>> add_up() {
    std::sort(carriers_.begin(), carriers_.end());
    std::vector<std::pair<Carrier<Terms>, Index>> sums;
    for (const auto& [carrier, at] : carriers_)
      if (sums.empty() || sums.back().first != carrier)
        sums.emplace_back(carrier, at);
      else
        for (int k = 0; k < Terms::size; ++k) terms_[sums.back().second].values[k] += terms_[at].values[k];
    return sums;
  }

  std::vector<std::pair<Carrier<Terms>, Index>> carriers_;  // and the place of their terms
  std::vector<Terms> terms_;
};

}  // namespace

template <class Real>
void StoredTerms<Real>::follow(const Elements& elements, const std::vector<Index>& leave,
                               const std::vector<Index>& enter, RegionModel model) {
  layout_.resize(elements.topology.vertex_count(), elements.topology.tet_count());
  std::vector<Index> changed;
  const std::vector<Layout::Item> items = items_of(model, elements, {}, enter);
  const auto entering = layout_.keep(items, [this](Index slot) { return corners_[slot]; });
  for (Index t : leave) {
    if (!layout_.must_leave(t)) continue;
    const Index slot = layout_.slot_of(t);
    changed.push_back(slot / Layout::capacity);
    corners_[slot] = corners_[layout_.leave(t, corners_[slot])];
  }
  layout_.enter(entering, elements.points.padded());
  corners_.resize(std::size_t(layout_.patch_count()) * Layout::capacity);
  for (const Layout::Item& item : items) {
    const Index slot = layout_.slot_of(item.id), p = slot / Layout::capacity;
    corners_[slot] = layout_.local_corners(p, item.corners);
    changed.push_back(p);
  }
  sort_unique(changed);
  patches_.resize(std::size_t(layout_.patch_count()));
  sums_.resize(layout_.patch_count());
  for (Index p : changed) gather(elements, p);
}

template <class Real>
void StoredTerms<Real>::gather(const Elements& elements, Index p) {
  TermSums<VertexTerms> vertices;
  TermSums<EdgeTerms> edges;
  TermSums<TriangleTerms> triangles;
  TermSums<TetTerms> tets;
  for (Index i = 0; i < layout_.patch(p).items; ++i) {
    const Index t = layout_.id_of(p * Layout::capacity + i);
    const Shape s = elements.shape_of(t);
    const Law<double> law = linear_law(elements, t);
    const std::array<std::uint8_t, 4>& v = corners_[p * Layout::capacity + i];
    std::array<int, 4> o{0, 1, 2, 3};  // corners by ascending numbers
    std::sort(o.begin(), o.end(), [&](int a, int b) { return v[a] < v[b]; });
    for (int a = 0; a < 4; ++a) {
      vertices.add({v[o[a]]}, vertex_terms(s, law, o[a]));
      for (int b = a + 1; b < 4; ++b) {
        edges.add({v[o[a]], v[o[b]]}, edge_terms(s, law, o[a], o[b]));
        for (int c = b + 1; c < 4; ++c)
          triangles.add({v[o[a]], v[o[b]], v[o[c]]}, triangle_terms(s, law, o[a], o[b], o[c]));
      }
    }
    tets.add({v[o[0]], v[o[1]], v[o[2]], v[o[3]]}, tet_terms(s, law, o[0], o[1], o[2], o[3]));
  }
  patches_[p] = {vertices.template blocks<Real>(), edges.template blocks<Real>(),
                 triangles.template blocks<Real>(), tets.template blocks<Real>(), parts_of(p)};
}

template <class Real>
std::vector<typename StoredTerms<Real>::Part> StoredTerms<Real>::parts_of(Index p) const {
  std::array<int, patch_vertices> joined;  // to a vertex of the same part, ahead of it or itself
  joined.fill(-1);
  const auto first_of = [&](int v) {
    while (joined[v] != v) v = joined[v];
    return v;
  };
  for (Index i = 0; i < layout_.patch(p).items; ++i) {
    const std::array<std::uint8_t, 4>& corners = corners_[p * Layout::capacity + i];
    for (int v : corners)
      if (joined[v] < 0) joined[v] = v;
    for (int v : corners) {
      const int a = first_of(corners[0]), b = first_of(v);
      joined[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<Part> parts;
  std::array<int, patch_vertices> part_at;  // of each first vertex
  for (int v = 0; v < patch_vertices; ++v) {
    if (joined[v] < 0) continue;
    if (joined[v] == v) {
      part_at[v] = static_cast<int>(parts.size());
      parts.emplace_back();
    }
    parts[part_at[first_of(v)]].push_back(static_cast<std::uint8_t>(v));
  }
  return parts;
}

// A translation changes no energy, so the forces of a part add up to zero. What rounding leaves of the sum is
// subtracted.
template <class Real>
void balance(const std::vector<std::uint8_t>& part, PaddedVector<Real>* forces) {
  for (int d = 0; d < 3; ++d) {
    double sum = 0;
    for (int v : part) sum += double(forces[v].xyz0[d]);
    const auto share = static_cast<Real>(sum / double(part.size()));
    for (int v : part) forces[v].xyz0[d] -= share;
  }
}

template <class Real>
void StoredTerms<Real>::add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  sums_.add_forces(layout_, u, f, parallel, [&](Index p, auto& local, PaddedVector<Real>* sums) {
    const Patch& patch = patches_[p];
    for (const Part& part : patch.parts) {
      const std::array<Real, 4> origin = local[part[0]].xyz0;
      for (int v : part)
        for (int d = 0; d < 3; ++d) local[v].xyz0[d] -= origin[d];
    }
    kernels_.add_term_forces({{patch.vertices.data(), Index(patch.vertices.size())},
                              {patch.edges.data(), Index(patch.edges.size())},
                              {patch.triangles.data(), Index(patch.triangles.size())},
                              {patch.tets.data(), Index(patch.tets.size())},
                              local.data()},
                             sums);
    for (const Part& part : patch.parts) balance(part, sums);
  });
}

template <class Real>
std::size_t StoredTerms<Real>::bytes() const {
  std::size_t sum = 0;
  const auto of = [](const auto& blocks) { return blocks.size() * sizeof(blocks[0]); };
  for (const Patch& p : patches_) sum += of(p.vertices) + of(p.edges) + of(p.triangles) + of(p.tets);
  return sum;
}

template class StoredTerms<float>;
template class StoredTerms<double>;

}  // namespace lobe
