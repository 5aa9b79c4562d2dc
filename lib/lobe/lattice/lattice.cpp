#include "lobe/lattice/lattice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>

#include "lobe/error.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr double chosen_cells = 20;   // along the diagonal of the regions
constexpr double chosen_tets = 1.5;   // mean edges of tetrahedra, at least
constexpr double fewest_tets = 1.1;   // a finer lattice is refused
constexpr double least_filled = 0.2;  // share of a cell; a smaller part joins a neighbour
constexpr double fewest_cells = 2;    // along the longest side of the regions: a coarser one is refused

std::vector<Index> reduced_tets(const Elements& elements) {
  std::vector<Index> tets;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.is_in(RegionModel::reduced, t)) tets.push_back(t);
  return tets;
}

// Sets of numbers that are the same, each known by its smallest.
class Unions {
 public:
  explicit Unions(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  Index find(Index i) {
    while (parent_[std::size_t(i)] != i)
      i = parent_[std::size_t(i)] = parent_[std::size_t(parent_[std::size_t(i)])];
    return i;
  }
  void join(Index a, Index b) {
    const auto [low, high] = std::minmax({find(a), find(b)});
    parent_[std::size_t(high)] = low;
  }

 private:
  std::vector<Index> parent_;
};

struct Place {  // of the samples of a tetrahedron that are in one cell
  std::array<int, 3> cell;
  std::uint16_t material;
  std::uint8_t samples;  // one bit each
  Index tet;
  bool is_beside(const Place& other) const { return cell == other.cell && material == other.material; }
  bool operator<(const Place& other) const {
    return std::tie(cell, material, tet) < std::tie(other.cell, other.material, other.tet);
  }
};

// Per vertex, the parts of the tetrahedra around it, sorted.
class PartsAround {
 public:
  PartsAround(const Topology& topology, const std::vector<Index>& part_of_sample);
  std::span<const Index> operator[](Index vertex) const {
    return {parts_.data() + begin_[std::size_t(vertex)], parts_.data() + end_[std::size_t(vertex)]};
  }

 private:
  std::vector<Index> begin_, end_, parts_;
};

PartsAround::PartsAround(const Topology& topology, const std::vector<Index>& part_of_sample)
    : begin_(std::size_t(topology.vertex_count()) + 1, 0) {
  const auto for_entries = [&](auto&& visit) {  // visit(vertex, part)
    for (Index t = 0; t < topology.tet_count(); ++t) {
      const Index* of_tet = part_of_sample.data() + tet_samples * t;
      for (int s = 0; s < tet_samples; ++s)
        if (of_tet[s] >= 0 && std::find(of_tet, of_tet + s, of_tet[s]) == of_tet + s)
          for (Index v : topology.corners(t)) visit(std::size_t(v), of_tet[s]);
    }
  };
  for_entries([&](std::size_t v, Index) { ++begin_[v + 1]; });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  parts_.resize(std::size_t(begin_.back()));
  end_.assign(begin_.begin(), begin_.end() - 1);
  for_entries([&](std::size_t v, Index part) {
    const auto first = parts_.begin() + begin_[v], last = parts_.begin() + end_[v];
    if (std::find(first, last, part) == last) parts_[std::size_t(end_[v]++)] = part;
  });
  for (std::size_t v = 0; v < end_.size(); ++v)
    std::sort(parts_.begin() + begin_[v], parts_.begin() + end_[v]);
}

Eigen::Vector3i corner(const Lattice::Part& part, int c) {
  return part.cell + Eigen::Vector3i(c & 1, c >> 1 & 1, c >> 2);
}

class Maker {
 public:
  Maker(const Elements& elements, const LatticeFrame& frame) : elements_(elements) {
    lattice_.frame = frame;
    lattice_.part_of_sample.assign(std::size_t(elements.topology.tet_count()) * tet_samples, -1);
    lattice_.part_of_vertex.assign(std::size_t(elements.topology.vertex_count()), -1);
  }

  Lattice make() {
    make_parts();
    join_small_parts();
    const PartsAround around(elements_.topology, lattice_.part_of_sample);
    make_nodes(around);
    place_vertices(around);
    find_cut_ends();
    return std::move(lattice_);
  }

 private:
  void make_parts();
  void add_parts(const Place* begin, const Place* end);
  void join_small_parts();
  Index nearest_part(Index sample, const PartsAround& around, const std::vector<double>& filled) const;
  double distance(Index part, const Vec3d& X) const;
  void make_nodes(const PartsAround& around);
  void place_vertices(const PartsAround& around);
  void find_cut_ends();

  const Elements& elements_;
  Lattice lattice_;
  std::vector<Index> first_with_;  // per vertex; −1 between groups of places
};

void Maker::make_parts() {
  std::vector<Place> places;
  for (Index t : reduced_tets(elements_)) {
    const Eigen::Matrix<double, 3, tet_samples> points = elements_.corner_points(t) * sample_weights();
    const std::size_t first = places.size();
    for (int s = 0; s < tet_samples; ++s) {
      const Vec3d at = (points.col(s) - lattice_.frame.origin) / lattice_.frame.edge;
      const std::array<int, 3> cell = {int(std::floor(at.x())), int(std::floor(at.y())),
                                       int(std::floor(at.z()))};
      const auto own = std::find_if(places.begin() + std::ptrdiff_t(first), places.end(),
                                    [&](const Place& place) { return place.cell == cell; });
      const auto bit = std::uint8_t(1 << s);
      if (own == places.end())
        places.push_back({cell, elements_.material_of[std::size_t(t)], bit, t});
      else
        own->samples |= bit;
    }
  }
  std::sort(places.begin(), places.end());
  first_with_.assign(std::size_t(elements_.topology.vertex_count()), -1);
  for (std::size_t i = 0, end; i < places.size(); i = end) {
    for (end = i + 1; end < places.size() && places[end].is_beside(places[i]);) ++end;
    add_parts(places.data() + i, places.data() + end);
  }
}

// Makes the parts of the samples of one cell and material.
void Maker::add_parts(const Place* begin, const Place* end) {
  Unions same(std::size_t(end - begin));
  for (const Place* place = begin; place < end; ++place)
    for (Index v : elements_.topology.corners(place->tet)) {
      const auto own = static_cast<Index>(place - begin);
      Index& first = first_with_[std::size_t(v)];
      if (first < 0) first = own;
      same.join(first, own);
    }
  std::vector<Index> part_of(std::size_t(end - begin));  // that of the first of a set is known first
  for (const Place* place = begin; place < end; ++place) {
    const auto own = static_cast<Index>(place - begin), root = same.find(own);
    if (root == own) {
      part_of[std::size_t(own)] = static_cast<Index>(lattice_.parts.size());
      lattice_.parts.push_back({{begin->cell[0], begin->cell[1], begin->cell[2]}, begin->material, {}});
    }
    for (int s = 0; s < tet_samples; ++s)
      if (place->samples >> s & 1)
        lattice_.part_of_sample[std::size_t(tet_samples * place->tet + s)] = part_of[std::size_t(root)];
    for (Index v : elements_.topology.corners(place->tet)) first_with_[std::size_t(v)] = -1;
  }
}

// Nodes of a sliver would hardly be held by anything. Its samples join the nearest part around their
// tetrahedra that is none; the cell of that reaches a little beyond itself.
void Maker::join_small_parts() {
  std::vector<Index>& part_of = lattice_.part_of_sample;
  std::vector<double> filled(lattice_.parts.size(), 0);  // shares of a cell
  const double of_cell = std::pow(lattice_.frame.edge, 3);
  for (std::size_t first = 0; first < part_of.size(); first += tet_samples) {
    if (part_of[first] < 0) continue;
    const double share = elements_.volume(static_cast<Index>(first / tet_samples)) / tet_samples / of_cell;
    for (std::size_t i = first; i < first + tet_samples; ++i) filled[std::size_t(part_of[i])] += share;
  }
  const PartsAround around(elements_.topology, part_of);
  std::vector<Index> joined = part_of;
  for (std::size_t i = 0; i < part_of.size(); ++i)
    if (part_of[i] >= 0 && filled[std::size_t(part_of[i])] < least_filled)
      joined[i] = nearest_part(static_cast<Index>(i), around, filled);
  std::vector<Index> number(lattice_.parts.size(), -1);
  std::vector<Lattice::Part> left;
  for (Index part : joined)
    if (part >= 0) number[std::size_t(part)] = 0;
  for (std::size_t p = 0; p < number.size(); ++p) {
    if (number[p] < 0) continue;
    number[p] = static_cast<Index>(left.size());
    left.push_back(lattice_.parts[p]);
  }
  for (Index& part : joined)
    if (part >= 0) part = number[std::size_t(part)];
  part_of = std::move(joined);
  lattice_.parts = std::move(left);
}

// Its own if there is no other of its material.
Index Maker::nearest_part(Index sample, const PartsAround& around, const std::vector<double>& filled) const {
  const Index tet = sample / tet_samples, own = lattice_.part_of_sample[std::size_t(sample)];
  const Vec3d X = elements_.corner_points(tet) * sample_weights().col(sample % tet_samples);
  Index nearest = own;
  double least = std::numeric_limits<double>::infinity();
  for (Index v : elements_.topology.corners(tet))
    for (Index part : around[v]) {
      const bool suits =
          filled[std::size_t(part)] >= least_filled &&
          lattice_.parts[std::size_t(part)].material == lattice_.parts[std::size_t(own)].material;
      if (!suits || distance(part, X) >= least) continue;
      nearest = part;
      least = distance(part, X);
    }
  return nearest;
}

// Of a point from the cell of a part, in cells.
double Maker::distance(Index part, const Vec3d& X) const {
  return std::max(0.0, (lattice_.in_cell(part, X).array() - 0.5).abs().maxCoeff() - 0.5);
}

void Maker::make_nodes(const PartsAround& parts_around) {
  std::vector<Lattice::Part>& parts = lattice_.parts;
  Unions same(8 * parts.size());
  const auto join = [&](Index a, Index b) {
    const Eigen::Vector3i apart = parts[std::size_t(b)].cell - parts[std::size_t(a)].cell;
    if (apart.cwiseAbs().maxCoeff() > 1) return;
    for (int c = 0; c < 8; ++c)
      for (int d = 0; d < 8; ++d)
        if (corner(parts[std::size_t(a)], c) == corner(parts[std::size_t(b)], d))
          same.join(8 * a + c, 8 * b + d);
  };
  std::vector<std::pair<Index, Index>> joined;
  for (Index v = 0; v < elements_.topology.vertex_count(); ++v) {
    const std::span<const Index> around = parts_around[v];
    for (std::size_t i = 0; i < around.size(); ++i)
      for (std::size_t j = i + 1; j < around.size(); ++j) joined.emplace_back(around[i], around[j]);
  }
  std::sort(joined.begin(), joined.end());
  joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
  for (const auto& [a, b] : joined) join(a, b);

  std::vector<Index> number(8 * parts.size(), -1);
  for (std::size_t i = 0; i < number.size(); ++i) {
    const Index root = same.find(static_cast<Index>(i));
    if (root == static_cast<Index>(i)) {
      number[i] = static_cast<Index>(lattice_.corner_of_node.size());
      lattice_.corner_of_node.push_back(corner(parts[i / 8], int(i % 8)));
    }
    parts[i / 8].nodes[i % 8] = number[std::size_t(root)];
  }
  lattice_.nodes.resize(3, Eigen::Index(lattice_.corner_of_node.size()));
  for (Index n = 0; n < lattice_.node_count(); ++n)
    lattice_.nodes.col(n) =
        lattice_.frame.origin + lattice_.frame.edge * lattice_.corner_of_node[std::size_t(n)].cast<double>();
}

// Gives each vertex to the part around it whose cell has it, or is nearest.
void Maker::place_vertices(const PartsAround& around) {
  for (Index v = 0; v < elements_.topology.vertex_count(); ++v) {
    double nearest = 0;
    for (Index part : around[v]) {
      const double away = distance(part, elements_.points.col(v));
      Index& own = lattice_.part_of_vertex[std::size_t(v)];
      if (own >= 0 && away >= nearest) continue;
      own = part;
      nearest = away;
    }
  }
}

// A node is common to both sides of a cut, or of a slit that the mesh had at the start, if two vertices that
// are at the same place at rest follow it.
void Maker::find_cut_ends() {
  const auto& X = elements_.points;
  std::vector<Index> sorted;
  for (Index v = 0; v < elements_.topology.vertex_count(); ++v)
    if (lattice_.part_of_vertex[std::size_t(v)] >= 0) sorted.push_back(v);
  const auto place_of = [&](Index v) { return std::tuple(X(0, v), X(1, v), X(2, v), v); };
  std::sort(sorted.begin(), sorted.end(), [&](Index a, Index b) { return place_of(a) < place_of(b); });

  std::vector<std::uint8_t> is_common(std::size_t(lattice_.node_count()), 0);
  std::vector<Index> nodes;
  for (auto first = sorted.begin(); first != sorted.end();) {
    const auto last = std::find_if(first, sorted.end(), [&](Index v) { return X.col(v) != X.col(*first); });
    nodes.clear();
    if (last == first + 1) ++first;  // alone
    for (; first != last; ++first) {
      const Lattice::Part& part = lattice_.parts[std::size_t(lattice_.part_of_vertex[std::size_t(*first)])];
      nodes.insert(nodes.end(), part.nodes.begin(), part.nodes.end());
    }
    std::sort(nodes.begin(), nodes.end());
    for (auto n = std::adjacent_find(nodes.begin(), nodes.end()); n != nodes.end();
         n = std::adjacent_find(n + 1, nodes.end()))
      is_common[std::size_t(*n)] = 1;
  }
  for (Lattice::Part& part : lattice_.parts)
    part.has_cut_end = std::any_of(part.nodes.begin(), part.nodes.end(),
                                   [&](Index n) { return is_common[std::size_t(n)] != 0; });
}

}  // namespace

const Eigen::Matrix<double, 4, tet_samples>& sample_weights() {
  static const Eigen::Matrix<double, 4, tet_samples> weights = [] {
    const auto middle = [](int a, int b) -> Eigen::Vector4d {
      return (Eigen::Vector4d::Unit(a) + Eigen::Vector4d::Unit(b)) / 2;
    };
    const Eigen::Vector4d ring[4] = {middle(0, 1), middle(1, 2), middle(2, 3), middle(3, 0)};
    Eigen::Matrix<double, 4, tet_samples> w;
    for (int c = 0; c < 4; ++c) w.col(c) = (Eigen::Vector4d::Ones() + 4 * Eigen::Vector4d::Unit(c)) / 8;
    for (int i = 0; i < 4; ++i)  // around the edge from the middle of 02 to that of 13
      w.col(4 + i) = (middle(0, 2) + middle(1, 3) + ring[i] + ring[(i + 1) % 4]) / 4;
    return w;
  }();
  return weights;
}

CellWeights cell_weights(const Vec3d& at) {
  CellWeights w;
  for (int c = 0; c < 8; ++c)
    w[c] =
        (c & 1 ? at.x() : 1 - at.x()) * (c >> 1 & 1 ? at.y() : 1 - at.y()) * (c >> 2 ? at.z() : 1 - at.z());
  return w;
}

CellGradients cell_gradients(const Vec3d& at, double edge) {
  CellGradients g;
  for (int c = 0; c < 8; ++c) {
    double w[3];
    for (int d = 0; d < 3; ++d) w[d] = c >> d & 1 ? at[d] : 1 - at[d];
    for (int d = 0; d < 3; ++d) g(c, d) = (c >> d & 1 ? 1 : -1) / edge * w[(d + 1) % 3] * w[(d + 2) % 3];
  }
  return g;
}

LatticeFrame choose_lattice(const Elements& elements, double edge) {
  Eigen::AlignedBox3d box;
  double sum = 0;
  const std::vector<Index> tets = reduced_tets(elements);
  for (Index t : tets) {
    const Mat34<double> X = elements.corner_points(t);
    for (int c = 0; c < 4; ++c) box.extend(Vec3d(X.col(c)));
    for (const auto& ends : edge_corners) sum += (X.col(ends[0]) - X.col(ends[1])).norm() / 6;
  }
  if (tets.empty()) return {};
  const double mean_edge = sum / double(tets.size()), longest = box.sizes().maxCoeff();
  if (edge == 0)
    edge = std::min(std::max(box.diagonal().norm() / chosen_cells, chosen_tets * mean_edge),
                    longest / fewest_cells);
  if (edge < fewest_tets * mean_edge)
    throw InputError("cell",
                     rounded(edge) + " m is hardly larger than the tetrahedra, whose mean edge is " +
                         rounded(mean_edge) +
                         " m: use larger cells, or a \"nonlinear\" region where the mesh is so coarse");
  if (edge > longest / fewest_cells)
    throw InputError("cell", rounded(edge) + " m is more than half of the reduced regions, which are " +
                                 rounded(longest) + " m long: use smaller cells");
  const Vec3d cells = (box.sizes() / edge).array().ceil();
  return {edge, box.center() - edge / 2 * cells};
}

Lattice make_lattice(const Elements& elements, const LatticeFrame& frame) {
  return Maker(elements, frame).make();
}

}  // namespace lobe
