#include "lobe/lattice/embedding.h"

#include <algorithm>
#include <cmath>

#include "lobe/time/vertex_frequencies.h"

namespace lobe {
namespace {

// α: half of Young's modulus.
double fluctuation_stiffness(const Elastic& e) {
  return e.mu * (3 * e.lambda + 2 * e.mu) / (2 * (e.lambda + e.mu));
}

void add_sample(const Elements& elements, const Lattice& lattice, Index sample, double sign, CellSums& sums) {
  const Index tet = sample / tet_samples, part = lattice.part_of_sample[std::size_t(sample)];
  const Vec3d X = elements.corner_points(tet) * sample_weights().col(sample % tet_samples);
  const double volume = sign * elements.volume(tet) / tet_samples;
  const CellGradients at = cell_gradients(lattice.in_cell(part, X), lattice.frame.edge);
  sums.volume += volume;
  sums.gradients += volume * at;
  sums.squares.noalias() += volume * at.lazyProduct(at.transpose());
}

// Of the Gauss points of a cell, an eighth of whose volume each has, per volume.
CellSums gauss_points(double edge) {
  CellSums sums;
  const double inner = std::sqrt(1.0 / 12);
  for (int g = 0; g < 8; ++g) {
    Vec3d at = Vec3d::Constant(0.5 - inner);
    for (int d = 0; d < 3; ++d)
      if (g >> d & 1) at[d] = 0.5 + inner;
    const CellGradients own = cell_gradients(at, edge);
    sums.volume += 1.0 / 8;
    sums.gradients += own / 8;
    sums.squares += own * own.transpose() / 8;
  }
  return sums;
}

// Σ_x V_x (g_x − N)(g_x − N)ᵀ.
CellMatrix spread(const CellSums& sums, const CellGradients& N) {
  const CellMatrix cross = sums.gradients * N.transpose();
  return sums.squares - cross - cross.transpose() + sums.volume * N * N.transpose();
}

LatticeCell cell_of(const Elements& elements, Index part, Index tet, const CellSums& sums,
                    const CellSums& gauss) {
  LatticeCell cell{.part = part, .tet = tet};
  cell.volume = sums.volume;
  cell.gradients = sums.gradients / sums.volume;
  const double alpha = fluctuation_stiffness(elements.elastic_of(tet));
  cell.fluctuation = alpha / 2 * (spread(sums, cell.gradients) + sums.volume * spread(gauss, cell.gradients));
  return cell;
}

double corner_mass(const Elements& elements, Index tet) {
  return elements.elastic_of(tet).density * elements.corner_volumes[std::size_t(tet)];
}

}  // namespace

std::vector<CellSums> sum_cells(const Elements& elements, const Lattice& lattice) {
  std::vector<CellSums> sums(lattice.parts.size());
  for (std::size_t i = 0; i < lattice.part_of_sample.size(); ++i)
    if (const Index part = lattice.part_of_sample[i]; part >= 0)
      add_sample(elements, lattice, static_cast<Index>(i), 1, sums[std::size_t(part)]);
  return sums;
}

// Of a part, the fewer of its samples are summed: those that it has, or those that it does not have.
Embedding embed(const Elements& elements, const Lattice& lattice, const std::vector<CellSums>& whole,
                std::vector<std::uint8_t> is_embedded) {
  struct Part {
    Index tet = -1, embedded = 0, full = 0;  // the first that is embedded; numbers of samples
  };
  Embedding e;
  e.is_embedded = std::move(is_embedded);
  std::vector<Part> parts(lattice.parts.size());
  std::vector<std::uint8_t> is_beside(e.is_embedded.size(), 0),
      is_full(lattice.part_of_sample.size() / tet_samples);
  const auto for_samples = [&](auto&& visit) {  // visit(part, sample), of reduced tetrahedra
    for (std::size_t i = 0; i < lattice.part_of_sample.size(); ++i)
      if (lattice.part_of_sample[i] >= 0)
        visit(std::size_t(lattice.part_of_sample[i]), static_cast<Index>(i));
  };
  for (Index t = 0; t < static_cast<Index>(is_full.size()); ++t) {
    if (lattice.part_of_sample[std::size_t(t) * tet_samples] < 0) continue;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    is_full[std::size_t(t)] =
        !std::all_of(corners.begin(), corners.end(), [&](Index v) { return e.embeds(v); });
    if (!is_full[std::size_t(t)]) continue;
    e.full.push_back(t);
    for (Index v : corners) is_beside[std::size_t(v)] = e.is_embedded[std::size_t(v)];
  }
  for (Index v = 0; v < static_cast<Index>(e.is_embedded.size()); ++v) {
    if (e.is_embedded[std::size_t(v)]) e.vertices.push_back(v);
    if (is_beside[std::size_t(v)]) e.interface.push_back(v);
  }
  for_samples([&](std::size_t part, Index sample) {
    Part& group = parts[part];
    if (is_full[std::size_t(sample / tet_samples)]) {
      ++group.full;
    } else if (group.embedded++ == 0) {
      group.tet = sample / tet_samples;
    }
  });
  std::vector<CellSums> sums = whole;
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (parts[p].full >= parts[p].embedded) sums[p] = {};
  for_samples([&](std::size_t part, Index sample) {
    const Part& group = parts[part];
    const bool is_left_out = is_full[std::size_t(sample / tet_samples)],
               subtracts = group.full < group.embedded;
    if (group.embedded > 0 && is_left_out == subtracts)
      add_sample(elements, lattice, sample, subtracts ? -1 : 1, sums[part]);
  });
  const CellSums gauss = gauss_points(lattice.frame.edge);
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (parts[p].embedded > 0)
      e.cells.push_back(cell_of(elements, static_cast<Index>(p), parts[p].tet, sums[p], gauss));
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

// A vertex with full tetrahedra has as much stiffness of these as their mass at it allows below omega.
double give_mass(const Elements& elements, const Lattice& lattice, const std::vector<double>& mass,
                 double omega, Embedding& e) {
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
  for (Index t : e.full)
    for (Index v : elements.topology.corners(t))
      if (e.embeds(v))
        for_nodes(v, [&](std::size_t n, double w) { least[n] += std::abs(w) * corner_mass(elements, t); });
  e.mass.assign(least.size(), 0);
  for (Index v : e.vertices)
    for_nodes(v, [&](std::size_t n, double w) { e.mass[n] += w * mass[std::size_t(v)]; });
  double added = 0;
  for (std::size_t n = 0; n < least.size(); ++n) {
    const double raised = std::max(e.mass[n], least[n]);
    added += raised - e.mass[n];
    e.mass[n] = raised;
  }
  return added;
}

}  // namespace lobe
