#include "lobe/lattice/lattice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

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

struct Place {  // of a sample
  std::array<int, 3> cell;
  std::uint16_t material;
  Index sample;
  Index tet() const { return sample / tet_samples; }
  bool is_beside(const Place& other) const { return cell == other.cell && material == other.material; }
  bool operator<(const Place& other) const {
    return std::tie(cell, material, sample) < std::tie(other.cell, other.material, other.sample);
  }
};

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
    make_nodes();
    place_vertices();
    return std::move(lattice_);
  }

 private:
  void make_parts();
  void add_parts(const Place* begin, const Place* end);
  void join_small_parts();
  Index nearest_part(Index sample, const std::vector<double>& filled) const;
  double distance(Index part, const Vec3d& X) const;
  void make_nodes();
  void place_vertices();
  std::vector<Index> parts_around(Index vertex) const;

  const Elements& elements_;
  Lattice lattice_;
};

void Maker::make_parts() {
  std::vector<Place> places;
  for (Index t : reduced_tets(elements_)) {
    const Eigen::Matrix<double, 3, tet_samples> points = elements_.corner_points(t) * sample_weights();
    for (int s = 0; s < tet_samples; ++s) {
      const Vec3d at = (points.col(s) - lattice_.frame.origin) / lattice_.frame.edge;
      places.push_back({{int(std::floor(at.x())), int(std::floor(at.y())), int(std::floor(at.z()))},
                        elements_.material_of[std::size_t(t)],
                        tet_samples * t + s});
    }
  }
  std::sort(places.begin(), places.end());
  for (std::size_t i = 0, end; i < places.size(); i = end) {
    for (end = i + 1; end < places.size() && places[end].is_beside(places[i]);) ++end;
    add_parts(places.data() + i, places.data() + end);
  }
}

// Makes the parts of the samples of one cell and material.
void Maker::add_parts(const Place* begin, const Place* end) {
  Unions same(std::size_t(end - begin));
  std::map<Index, Index> first_with;  // vertex
  for (const Place* place = begin; place < end; ++place)
    for (Index v : elements_.topology.corners(place->tet())) {
      const auto own = static_cast<Index>(place - begin);
      same.join(first_with.try_emplace(v, own).first->second, own);
    }
  std::map<Index, Index> part_of;
  for (const Place* place = begin; place < end; ++place) {
    const auto [found, is_new] = part_of.try_emplace(same.find(static_cast<Index>(place - begin)),
                                                     static_cast<Index>(lattice_.parts.size()));
    if (is_new)
      lattice_.parts.push_back({{begin->cell[0], begin->cell[1], begin->cell[2]}, begin->material, {}});
    lattice_.part_of_sample[std::size_t(place->sample)] = found->second;
  }
}

// Nodes of a sliver would hardly be held by anything. Its samples join the nearest part around their
// tetrahedra that is none; the cell of that reaches a little beyond itself.
void Maker::join_small_parts() {
  std::vector<Index>& part_of = lattice_.part_of_sample;
  std::vector<double> filled(lattice_.parts.size(), 0);  // shares of a cell
  for (std::size_t i = 0; i < part_of.size(); ++i)
    if (part_of[i] >= 0)
      filled[std::size_t(part_of[i])] += elements_.volume(static_cast<Index>(i) / tet_samples) / tet_samples /
                                         std::pow(lattice_.frame.edge, 3);
  std::vector<Index> joined = part_of;
  for (std::size_t i = 0; i < part_of.size(); ++i)
    if (part_of[i] >= 0 && filled[std::size_t(part_of[i])] < least_filled)
      joined[i] = nearest_part(static_cast<Index>(i), filled);
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
Index Maker::nearest_part(Index sample, const std::vector<double>& filled) const {
  const Index tet = sample / tet_samples, own = lattice_.part_of_sample[std::size_t(sample)];
  const Vec3d X = elements_.corner_points(tet) * sample_weights().col(sample % tet_samples);
  Index nearest = own;
  double least = std::numeric_limits<double>::infinity();
  for (Index v : elements_.topology.corners(tet))
    for (Index part : parts_around(v)) {
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

std::vector<Index> Maker::parts_around(Index vertex) const {
  std::vector<Index> parts;
  for (Index t : elements_.topology.around(vertex))
    for (Index sample = tet_samples * t; sample < tet_samples * (t + 1); ++sample) {
      const Index part = lattice_.part_of_sample[std::size_t(sample)];
      if (part >= 0 && std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
    }
  std::sort(parts.begin(), parts.end());
  return parts;
}

void Maker::make_nodes() {
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
    const std::vector<Index> around = parts_around(v);
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
void Maker::place_vertices() {
  for (Index v = 0; v < elements_.topology.vertex_count(); ++v) {
    double nearest = 0;
    for (Index part : parts_around(v)) {
      const double away = distance(part, elements_.points.col(v));
      Index& own = lattice_.part_of_vertex[std::size_t(v)];
      if (own >= 0 && away >= nearest) continue;
      own = part;
      nearest = away;
    }
  }
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
