#include "lobe/lattice/embedding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "lobe/assert.h"
#include "lobe/fem/hooke.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/region/smoothed_edges.h"

namespace lobe {
namespace {

struct TetSamples {
  TetSamples(const Elements& elements, Index tet)
      : points(elements.corner_points(tet) * sample_weights()), volume(elements.volume(tet) / tet_samples) {}
  Eigen::Matrix<double, 3, tet_samples> points;  // [m]
  double volume;                                 // of one [m³]
};

void add_sample(const Lattice& lattice, const TetSamples& of_tet, Index sample, double sign, CellSums& sums) {
  const Index part = lattice.part_of_sample[std::size_t(sample)];
  const Vec3d X = of_tet.points.col(sample % tet_samples);
  const double volume = sign * of_tet.volume;
  sums.volume += volume;
  sums.gradients += volume * cell_gradients(lattice.in_cell(part, X), lattice.frame.edge);
}

// The gradients at the Gauss points of a cell.
std::array<CellGradients, 8> gauss_points(double edge) {
  std::array<CellGradients, 8> points;
  const double inner = std::sqrt(1.0 / 12);
  for (int g = 0; g < 8; ++g) {
    Vec3d at = Vec3d::Constant(0.5 - inner);
    for (int d = 0; d < 3; ++d)
      if (g >> d & 1) at[d] = 0.5 + inner;
    points[std::size_t(g)] = cell_gradients(at, edge);
  }
  return points;
}

// S for α = 1: V/8 Σ_g (G_g − N)(G_g − N)ᵀ.
CellMatrix spread(const CellSums& sums, const std::array<CellGradients, 8>& gauss) {
  CellMatrix S = CellMatrix::Zero();
  for (const CellGradients& at : gauss) {
    const CellGradients apart = at - sums.gradients / sums.volume;
    S += sums.volume / 8 * apart * apart.transpose();
  }
  return S;
}

double corner_mass(const Elements& elements, Index tet) {
  return elements.elastic_of(tet).density * elements.corner_volumes[std::size_t(tet)];
}

// One of nine modes of a cell, about its middle.
constexpr int mode_count = 9;
Vec3d mode(int number, const Elastic& e, const Vec3d& x) {
  const int a = number / 3, b = (a + 1 + number % 3) % 3;
  Vec3d u = Vec3d::Zero();
  if (number % 3 == 2) {
    u[a] = x[(a + 1) % 3] * x[(a + 2) % 3];
    return u;
  }
  u[a] = x[a] * x[b];
  u[b] = -0.5 * (x[a] * x[a] + e.lambda / (e.lambda + 2 * e.mu) * x[b] * x[b]);
  return u;
}

double of_fine_mesh(const Elastic& e) {
  return e.mu / 3 * (1 + 4 * (e.lambda + e.mu) / (e.lambda + 2 * e.mu));
}

// Calls visit(share of the volume, ∇u) for the strains in which a tetrahedron has a part: its own, or those
// of its six smoothing domains. u(X) is a displacement of the whole space.
template <class Field, class Visit>
void for_gradients(const Elements& elements, const SmoothedEdges& domains, Index tet, const Shape& shape,
                   const Field& u, const Visit& visit) {
  if (!elements.elastic_of(tet).is_smoothed()) {
    Mat34<double> at;
    for (int c = 0; c < 4; ++c) at.col(c) = u(elements.points.col(elements.topology.tets()(c, tet)));
    return visit(1.0, Mat3<double>(at * shape.gradients.transpose()));
  }
  for (Index e : domains.of(tet)) {
    const SmoothedEdge& domain = domains[e];
    Mat3<double> H = Mat3<double>::Zero();
    for (std::size_t j = 0; j < domain.vertices.size(); ++j)
      H += u(elements.points.col(domain.vertices[j])) * domain.gradients[j].transpose();
    visit(1.0 / 6, H);
  }
}

Vec3d middle(const Lattice& lattice, Index part) {
  const Eigen::Array3d cell = lattice.parts[std::size_t(part)].cell.cast<double>().array();
  return lattice.frame.origin + lattice.frame.edge * (cell + 0.5).matrix();
}

}  // namespace

WholeLattice sum_cells(const Elements& elements, const Lattice& lattice) {
  WholeLattice whole{std::vector<CellSums>(lattice.parts.size()), {}};
  const auto& part_of = lattice.part_of_sample;
  for (Index first = 0; first < static_cast<Index>(part_of.size()); first += tet_samples) {
    if (part_of[std::size_t(first)] < 0) continue;  // then all of them are outside
    const TetSamples of_tet(elements, first / tet_samples);
    for (Index sample = first; sample < first + tet_samples; ++sample)
      add_sample(lattice, of_tet, sample, 1, whole.sums[std::size_t(part_of[std::size_t(sample)])]);
  }
  whole.stiffness = fluctuation_stiffness(elements, lattice, whole.sums);
  return whole;
}

std::vector<double> fluctuation_stiffness(const Elements& elements, const Lattice& lattice,
                                          const std::vector<CellSums>& sums) {
  using Modes = std::array<Mat3<double>, mode_count>;
  Modes zero;
  zero.fill(Mat3<double>::Zero());
  std::vector<Modes> strain(lattice.parts.size(), zero);  // ∫ ∇u
  std::vector<double> own(elements.materials.size(), 0), of_lattice = own, stiffness;
  const SmoothedEdges domains(elements, RegionModel::reduced);
  for (std::size_t first = 0; first < lattice.part_of_sample.size(); first += tet_samples) {
    const Index tet = static_cast<Index>(first) / tet_samples;
    const std::uint16_t material = elements.material_of[std::size_t(tet)];
    for (std::size_t i = first; i < first + tet_samples; ++i) {
      const auto begin = lattice.part_of_sample.begin() + Eigen::Index(first);
      const Index part = lattice.part_of_sample[i];
      if (part < 0 ||
          std::find(begin, begin + Eigen::Index(i - first), part) != begin + Eigen::Index(i - first))
        continue;
      const auto count = std::count(begin, begin + tet_samples, part);
      const Shape shape = elements.shape_of(tet);
      const double volume = shape.volume * double(count) / tet_samples;
      const Vec3d centre = middle(lattice, part);
      const Elastic& e = elements.materials[material];
      for (int number = 0; number < mode_count; ++number)
        for_gradients(
            elements, domains, tet, shape, [&](const Vec3d& X) { return mode(number, e, X - centre); },
            [&](double share, const Mat3<double>& H) {
              strain[std::size_t(part)][std::size_t(number)] += share * volume * H;
              own[material] += share * volume * hooke_energy_density<double>(H, e.lambda, e.mu);
            });
    }
  }
  const auto gauss = gauss_points(lattice.frame.edge);
  for (std::size_t p = 0; p < lattice.parts.size(); ++p) {
    const std::uint16_t material = lattice.parts[p].material;
    const Elastic& e = elements.materials[material];
    const CellMatrix S = spread(sums[p], gauss);
    for (int number = 0; number < mode_count; ++number) {
      const Mat3<double> mean = strain[p][std::size_t(number)] / sums[p].volume;
      own[material] -= sums[p].volume * hooke_energy_density<double>(mean, e.lambda, e.mu);
      Eigen::Matrix<double, 3, 8> q;
      for (int c = 0; c < 8; ++c)
        q.col(c) =
            mode(number, e, lattice.frame.edge * (Vec3d(c & 1, c >> 1 & 1, c >> 2).array() - 0.5).matrix());
      of_lattice[material] += 0.5 * (q * S).cwiseProduct(q).sum();
    }
  }
  for (std::size_t m = 0; m < own.size(); ++m) {
    const double least = of_fine_mesh(elements.materials[m]);
    stiffness.push_back(of_lattice[m] > 0 ? std::max(least, own[m] / of_lattice[m]) : least);
  }
  return stiffness;
}

void take_out(const Elements& elements, Index tet, Lattice& lattice, WholeLattice& whole) {
  const TetSamples of_tet(elements, tet);
  for (Index sample = tet_samples * tet; sample < tet_samples * (tet + 1); ++sample) {
    Index& part = lattice.part_of_sample[std::size_t(sample)];
    if (part < 0) continue;
    add_sample(lattice, of_tet, sample, -1, whole.sums[std::size_t(part)]);
    part = -1;
  }
}

namespace {

// Finds full tetrahedra, embedded vertices and those between both. Returns, per tetrahedron, whether it is
// full.
std::vector<std::uint8_t> sort_out(const Elements& elements, const Lattice& lattice, Embedding& e) {
  std::vector<std::uint8_t> is_beside(e.roles.is_embedded.size(), 0),
      is_full(lattice.part_of_sample.size() / tet_samples);
  for (Index t = 0; t < static_cast<Index>(is_full.size()); ++t) {
    if (lattice.part_of_sample[std::size_t(t) * tet_samples] < 0) continue;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    is_full[std::size_t(t)] =
        !std::all_of(corners.begin(), corners.end(), [&](Index v) { return e.embeds(v); });
    const bool stays = std::all_of(corners.begin(), corners.end(), [&](Index v) { return e.roles.stays(v); });
    if (!is_full[std::size_t(t)] || stays) continue;
    e.full.push_back(t);
    for (Index v : corners) is_beside[std::size_t(v)] = e.embeds(v);
  }
  for (Index v = 0; v < static_cast<Index>(is_beside.size()); ++v) {
    if (e.embeds(v)) e.vertices.push_back(v);
    if (is_beside[std::size_t(v)]) e.interface.push_back(v);
  }
  return is_full;
}

}  // namespace

// Of a part, the fewer of its samples are summed: those that it has, or those that it does not have.
Embedding embed(const Elements& elements, const Lattice& lattice, const WholeLattice& whole,
                VertexRoles roles) {
  struct Part {
    Index tet = -1, embedded = 0, full = 0;  // the first that is embedded; numbers of samples
  };
  Embedding e;
  e.roles = std::move(roles);
  std::vector<Part> parts(lattice.parts.size());
  const std::vector<std::uint8_t> is_full = sort_out(elements, lattice, e);
  const auto for_samples = [&](auto&& visit) {  // visit(part, sample), of reduced tetrahedra
    for (std::size_t i = 0; i < lattice.part_of_sample.size(); ++i)
      if (lattice.part_of_sample[i] >= 0)
        visit(std::size_t(lattice.part_of_sample[i]), static_cast<Index>(i));
  };
  for_samples([&](std::size_t part, Index sample) {
    Part& group = parts[part];
    if (is_full[std::size_t(sample / tet_samples)]) {
      ++group.full;
    } else if (group.embedded++ == 0) {
      group.tet = sample / tet_samples;
    }
  });
  std::vector<CellSums> sums = whole.sums;
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (parts[p].full >= parts[p].embedded) sums[p] = {};
  std::optional<TetSamples> of_tet;
  Index known = -1;  // the tetrahedron of these
  for_samples([&](std::size_t part, Index sample) {
    const Part& group = parts[part];
    const Index tet = sample / tet_samples;
    const bool is_left_out = is_full[std::size_t(tet)], subtracts = group.full < group.embedded;
    if (group.embedded == 0 || is_left_out != subtracts) return;
    if (std::exchange(known, tet) != tet) of_tet.emplace(elements, tet);
    add_sample(lattice, *of_tet, sample, subtracts ? -1 : 1, sums[part]);
  });
  const auto gauss = gauss_points(lattice.frame.edge);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].embedded == 0) continue;
    const double alpha = whole.stiffness[lattice.parts[p].material];
    e.cells.push_back({static_cast<Index>(p), parts[p].tet, sums[p].volume,
                       sums[p].gradients / sums[p].volume, alpha * spread(sums[p], gauss)});
  }
  std::stable_sort(e.cells.begin(), e.cells.end(), [&](const LatticeCell& a, const LatticeCell& b) {
    return lattice.parts[std::size_t(a.part)].material < lattice.parts[std::size_t(b.part)].material;
  });
  return e;
}

void add_bounds(const LatticeCell& cell, const Lattice::Part& part, const CellWeights& tangents,
                std::vector<double>& bounds) {
  const CellWeights roots = tangents.cwiseMax(0).cwiseSqrt();
  const double sum = roots.sum();
  for (int n = 0; n < 8; ++n)
    bounds[std::size_t(part.nodes[std::size_t(n)])] +=
        roots[n] * sum + cell.fluctuation.col(n).cwiseAbs().sum();
}

// A vertex has as much of its stiffness of full tetrahedra as it has of its mass. Its nodes get that mass at
// least.
double give_mass(const Elements& elements, const Lattice& lattice, const std::vector<double>& mass,
                 double omega, const std::vector<double>& stiffness, Embedding& e) {
  std::vector<double> least(std::size_t(lattice.node_count()), 0);
  for (const LatticeCell& cell : e.cells) {
    const Law<double> law = nonlinear_law(elements, cell.tet);
    CellWeights tangents;
    for (int n = 0; n < 8; ++n)
      tangents[n] = cell.volume * largest_eigenvalue(law_diagonal_block<double>(
                                      law, Mat3<double>::Zero(), cell.gradients.row(n).transpose()));
    add_bounds(cell, lattice.parts[std::size_t(cell.part)], tangents, least);
  }
  for (double& bound : least) bound = omega > 0 ? bound / (omega * omega) : 0;
  const auto for_nodes = [&](Index v, auto&& visit) {
    const CellWeights w = lattice.weights(v, elements.points.col(v));
    const Lattice::Part& part = lattice.parts[std::size_t(lattice.part_of_vertex[std::size_t(v)])];
    for (int n = 0; n < 8; ++n) visit(std::size_t(part.nodes[std::size_t(n)]), w[n]);
  };
  std::vector<double> of_full(mass.size(), 0);  // mass of full tetrahedra
  for (Index t : e.full)
    for (Index v : elements.topology.corners(t)) of_full[std::size_t(v)] += corner_mass(elements, t);
  for (Index v : e.interface) {
    const auto i = std::size_t(v);
    const bool is_known = !stiffness.empty() && omega > 0;
    const double known = is_known ? of_full[i] / mass[i] * stiffness[i] / (omega * omega) : 0,
                 sum = is_known ? lattice.weights(v, elements.points.col(v)).cwiseAbs().sum() : 1,
                 suffices = std::max(of_full[i], sum * known);
    for_nodes(v, [&](std::size_t n, double w) { least[n] += std::abs(w) * suffices; });
  }
  e.mass.assign(least.size(), 0);
  for (Index v : e.vertices)
    for_nodes(v, [&](std::size_t n, double w) { e.mass[n] += w * mass[std::size_t(v)]; });
  double added = 0;
  for (std::size_t n = 0; n < least.size(); ++n) {
    const double raised = std::max(e.mass[n], least[n]);
    lobe_assert(raised >= 0, "lattice: the mass of a node is below 0, or not a number");
    added += raised - e.mass[n];
    e.mass[n] = raised;
  }
  return added;
}

}  // namespace lobe
