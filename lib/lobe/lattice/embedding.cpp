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

void add_fluctuation(double stiffness, const CellGradients& at, LatticeCell& cell) {
  const CellGradients apart = at - cell.gradients;
  cell.fluctuation.noalias() += stiffness * apart * apart.transpose();
}

LatticeCell cell_of(const Elements& elements, const Lattice& lattice, Index part,
                    const std::vector<Index>& samples) {
  LatticeCell cell{.part = part, .tet = samples.front() / tet_samples};
  std::vector<CellGradients> gradients;
  const auto volume_of = [&](Index sample) { return elements.volume(sample / tet_samples) / tet_samples; };
  for (Index sample : samples) {
    const Vec3d X = elements.corner_points(sample / tet_samples) * sample_weights().col(sample % tet_samples);
    gradients.push_back(cell_gradients(lattice.in_cell(part, X), lattice.frame.edge));
    cell.volume += volume_of(sample);
    cell.gradients += volume_of(sample) * gradients.back();
  }
  cell.gradients /= cell.volume;
  const double alpha = fluctuation_stiffness(elements.elastic_of(cell.tet));
  for (std::size_t i = 0; i < samples.size(); ++i)
    add_fluctuation(alpha / 2 * volume_of(samples[i]), gradients[i], cell);
  const double inner = std::sqrt(1.0 / 12);
  for (int g = 0; g < 8; ++g) {
    Vec3d at = Vec3d::Constant(0.5 - inner);
    for (int d = 0; d < 3; ++d)
      if (g >> d & 1) at[d] = 0.5 + inner;
    add_fluctuation(alpha / 2 * cell.volume / 8, cell_gradients(at, lattice.frame.edge), cell);
  }
  return cell;
}

double corner_mass(const Elements& elements, Index tet) {
  return elements.elastic_of(tet).density * elements.corner_volumes[std::size_t(tet)];
}

}  // namespace

Embedding embed(const Elements& elements, const Lattice& lattice, std::vector<std::uint8_t> is_embedded) {
  Embedding e;
  e.is_embedded = std::move(is_embedded);
  std::vector<std::vector<Index>> samples_of(lattice.parts.size());
  std::vector<std::uint8_t> is_beside(e.is_embedded.size(), 0);
  for (Index t = 0; t < static_cast<Index>(lattice.part_of_sample.size()) / tet_samples; ++t) {
    const Index* parts = lattice.part_of_sample.data() + std::size_t(t) * tet_samples;
    if (parts[0] < 0) continue;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    if (std::all_of(corners.begin(), corners.end(), [&](Index v) { return e.embeds(v); })) {
      for (int s = 0; s < tet_samples; ++s) samples_of[std::size_t(parts[s])].push_back(tet_samples * t + s);
      continue;
    }
    e.full.push_back(t);
    for (Index v : corners) is_beside[std::size_t(v)] = e.is_embedded[std::size_t(v)];
  }
  for (Index v = 0; v < static_cast<Index>(e.is_embedded.size()); ++v) {
    if (e.is_embedded[std::size_t(v)]) e.vertices.push_back(v);
    if (is_beside[std::size_t(v)]) e.interface.push_back(v);
  }
  for (Index part = 0; part < static_cast<Index>(samples_of.size()); ++part)
    if (const std::vector<Index>& samples = samples_of[std::size_t(part)]; !samples.empty())
      e.cells.push_back(cell_of(elements, lattice, part, samples));
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
