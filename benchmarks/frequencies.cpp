#include "benchmarks/frequencies.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <sstream>

#include "lobe/error.h"
#include "lobe/fem/hooke.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/lattice/embedding.h"
#include "lobe/numerics/sparse_factor.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"

namespace lobe::bench {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int frequency_count = 14;

struct Summand {
  Index unknown = 0;
  double weight = 0;
};
using Sums = std::vector<std::vector<Summand>>;  // of which unknowns a vertex's displacement is the sum

// K x = ω² M x, of unknowns with three components each; masses are lumped.
class Linearised {
 public:
  Index add_unknown(double mass) {
    mass_.push_back(mass);
    return static_cast<Index>(mass_.size()) - 1;
  }
  void add(Index row, Index column, const Mat3<double>& block) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        if (3 * row + r >= 3 * column + c) entries_.emplace_back(3 * row + r, 3 * column + c, block(r, c));
  }
  void add_tets(const Elements& elements, const std::vector<Index>& tets, const Sums& terms);
  // [rad/s]. Throws InputError if the stiffness is singular to rounding, for this reason.
  Eigen::VectorXd lowest_frequencies(const std::string& reason) const;

 private:
  std::vector<double> mass_;  // [kg]
  std::vector<Eigen::Triplet<double>> entries_;
};

void Linearised::add_tets(const Elements& elements, const std::vector<Index>& tets, const Sums& terms) {
  for (Index t : tets) {
    const Shape s = elements.shape_of(t);
    const Elastic& e = elements.elastic_of(t);
    const Eigen::Vector4i corners = elements.topology.corners(t);
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) {
        const Mat3<double> block =
            s.volume * hooke_block<double>(s.gradients.col(j), s.gradients.col(k), e.lambda, e.mu);
        for (const Summand& a : terms[std::size_t(corners[j])])
          for (const Summand& b : terms[std::size_t(corners[k])])
            add(a.unknown, b.unknown, a.weight * b.weight * block);
      }
  }
}

// By iteration of a subspace with K⁻¹ M.
Eigen::VectorXd Linearised::lowest_frequencies(const std::string& reason) const {
  constexpr int iterations = 12;
  const auto n = Eigen::Index(3 * mass_.size()), block = Eigen::Index(frequency_count + 8);
  Sparse K(n, n);
  K.setFromTriplets(entries_.begin(), entries_.end());
  Eigen::VectorXd M(n);
  for (Eigen::Index i = 0; i < n; ++i) M[i] = mass_[std::size_t(i / 3)];
  const auto factor = make_ldlt();
  factor->analyse(K);
  if (!factor->factorise(K))
    throw InputError("frequencies", "the stiffness is singular to rounding: " + reason);
  Eigen::MatrixXd X(n, block);
  for (Eigen::Index j = 0; j < block; ++j)
    for (Eigen::Index i = 0; i < n; ++i) X(i, j) = std::sin(1.7 * double(i * (j + 1)) + double(j));
  Eigen::VectorXd squares;
  for (int i = 0; i < iterations; ++i) {
    const Eigen::MatrixXd Q =
        Eigen::HouseholderQR<Eigen::MatrixXd>(factor->solve_all(M.asDiagonal() * X)).householderQ() *
        Eigen::MatrixXd::Identity(n, block);
    const Eigen::MatrixXd KQ = K.selfadjointView<Eigen::Lower>() * Q;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> small(Q.transpose() * KQ,
                                                                          Q.transpose() * M.asDiagonal() * Q);
    squares = small.eigenvalues();
    X = Q * small.eigenvectors();
  }
  return squares.head(frequency_count).cwiseSqrt();
}

std::vector<std::uint8_t> held_flags(const Setup& setup) {
  std::vector<std::uint8_t> held(std::size_t(setup.mesh.vertex_count()), 0);
  for (const PrescribedVertex& prescribed : setup.prescribed) held[std::size_t(prescribed.vertex)] = 1;
  return held;
}

Eigen::VectorXd full_frequencies(const Setup& setup) {
  const Elements elements(setup);
  const std::vector<std::uint8_t> held = held_flags(setup);
  Linearised body;
  Sums terms(held.size());
  for (std::size_t v = 0; v < held.size(); ++v)
    if (!held[v]) terms[v] = {{body.add_unknown(lumped_mass(elements, static_cast<Index>(v))), 1}};
  std::vector<Index> all;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) all.push_back(t);
  body.add_tets(elements, all, terms);
  return body.lowest_frequencies("nothing holds the body, or a part of it hardly");
}

struct Reduced {
  Lattice lattice;
  WholeLattice whole;
  Embedding embedding;
};

// Held vertices and those next to them move by themselves, as in a World.
Reduced reduce(const Elements& elements, const std::vector<std::uint8_t>& held, double cell) {
  Reduced r;
  r.lattice = make_lattice(elements, choose_lattice(elements, cell));
  r.whole = sum_cells(elements, r.lattice);
  VertexRoles roles{std::vector<std::uint8_t>(held.size(), 1), held};
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Eigen::Vector4i corners = elements.topology.corners(t);
    if (std::any_of(corners.begin(), corners.end(), [&](Index v) { return held[std::size_t(v)] != 0; }))
      for (Index v : corners) roles.is_embedded[std::size_t(v)] = 0;
  }
  r.embedding = embed(elements, r.lattice, r.whole, std::move(roles));
  std::vector<double> mass;
  for (Index v = 0; v < elements.topology.vertex_count(); ++v) mass.push_back(lumped_mass(elements, v));
  give_mass(elements, r.lattice, mass, 0, {}, r.embedding);
  return r;
}

Eigen::VectorXd reduced_frequencies(const Elements& elements, const std::vector<std::uint8_t>& held,
                                    const Reduced& r) {
  Linearised body;
  Sums terms(held.size());
  std::vector<Index> unknown;  // per node
  for (double mass : r.embedding.mass) unknown.push_back(mass > 0 ? body.add_unknown(mass) : -1);
  for (Index v = 0; v < static_cast<Index>(held.size()); ++v) {
    std::vector<Summand>& own = terms[std::size_t(v)];
    if (held[std::size_t(v)]) continue;
    if (!r.embedding.embeds(v)) {
      own = {{body.add_unknown(lumped_mass(elements, v)), 1}};
      continue;
    }
    const CellWeights w = r.lattice.weights(v, elements.points.col(v));
    const auto& nodes = r.lattice.parts[std::size_t(r.lattice.part_of_vertex[std::size_t(v)])].nodes;
    for (int n = 0; n < 8; ++n)
      if (const Index at = unknown[std::size_t(nodes[std::size_t(n)])]; at >= 0) own.push_back({at, w[n]});
  }
  body.add_tets(elements, r.embedding.full, terms);
  for (const LatticeCell& cell : r.embedding.cells) {
    const Elastic& e = elements.elastic_of(cell.tet);
    const auto& nodes = r.lattice.parts[std::size_t(cell.part)].nodes;
    for (int n = 0; n < 8; ++n)
      for (int m = 0; m < 8; ++m) {
        const Index row = unknown[std::size_t(nodes[std::size_t(n)])],
                    column = unknown[std::size_t(nodes[std::size_t(m)])];
        if (row < 0 || column < 0) continue;
        body.add(row, column,
                 cell.volume * hooke_block<double>(cell.gradients.row(n).transpose(),
                                                   cell.gradients.row(m).transpose(), e.lambda, e.mu) +
                     cell.fluctuation(n, m) * Mat3<double>::Identity());
      }
  }
  // They have no cell, and vertices of full tetrahedra follow several of them at once.
  return body.lowest_frequencies("some nodes of the lattice can move without any vertex");
}

struct FrequencyRow {
  std::string scene;
  Index tets = 0, cells = 0, full = 0;
  double ratio = 0, edge = 0, stiffness = 0;  // λ/μ, cell [m], α/μ
  double mean = 0, worst = 0;                 // of |Δω|/ω
};

FrequencyRow compare_frequencies(const Setup& setup, double cell, const Eigen::VectorXd& exact) {
  const Elements elements(setup);
  const std::vector<std::uint8_t> held = held_flags(setup);
  const Reduced r = reduce(elements, held, cell);
  const Eigen::VectorXd error =
      (reduced_frequencies(elements, held, r).cwiseQuotient(exact).array() - 1).abs();
  const Elastic& e = elements.materials.front();
  return {.scene = {},
          .tets = setup.mesh.tet_count(),
          .cells = static_cast<Index>(r.embedding.cells.size()),
          .full = static_cast<Index>(r.embedding.full.size()),
          .ratio = e.lambda / e.mu,
          .edge = r.lattice.frame.edge,
          .stiffness = r.whole.stiffness.front() / e.mu,
          .mean = error.mean(),
          .worst = error.maxCoeff()};
}

std::string csv(const std::vector<FrequencyRow>& rows) {
  std::ostringstream out;
  out << "scene,tets,lambda_over_mu,cell,cells,full_tets,alpha_over_mu,mean_error,largest_error\n"
      << std::setprecision(4);
  for (const FrequencyRow& r : rows)
    out << r.scene << ',' << r.tets << ',' << r.ratio << ',' << r.edge << ',' << r.cells << ',' << r.full
        << ',' << r.stiffness << ',' << r.mean << ',' << r.worst << '\n';
  return out.str();
}

}  // namespace

void bench_frequencies(const Options& options) {
  std::vector<std::filesystem::path> scenes = options.scenes;
  if (scenes.empty())
    scenes.push_back(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / "liver_undeclared.json");
  std::printf("\n%-16s %7s %6s %7s %6s %6s %7s %9s %9s\n", "scene", "tets", "la/mu", "cell", "cells", "full",
              "al/mu", "mean", "largest");
  std::vector<FrequencyRow> rows;
  for (const std::filesystem::path& path : scenes) {
    const Scene scene = read_scene(path);
    std::vector<std::filesystem::path> meshes = options.meshes;
    meshes.insert(meshes.begin(), mesh_path(scene));
    for (const std::filesystem::path& mesh : meshes)
      for (const double ratio : {0.0, 1.0, 9.0, 50.0}) {  // 0: the scene's
        if (ratio > 0 && mesh != meshes.front()) continue;
        Setup setup = resolve(scene, read_mesh(mesh).mesh, {false}).setup;
        std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::reduced);
        for (Elastic& e : setup.materials)
          if (ratio > 0) e.lambda = ratio * e.mu;
        try {
          const Eigen::VectorXd exact = full_frequencies(setup);
          for (const double cell : {0.0, 0.012, 0.015}) {
            if (cell > 0 && (ratio > 0 || mesh != meshes.front())) continue;
            FrequencyRow row = compare_frequencies(setup, cell, exact);
            row.scene = path.stem().string();
            std::printf("%-16s %7d %6.3g %7.4f %6d %6d %7.3f %9.4f %9.4f\n", row.scene.c_str(), row.tets,
                        row.ratio, row.edge, row.cells, row.full, row.stiffness, row.mean, row.worst);
            rows.push_back(row);
          }
        } catch (const InputError& error) {  // the others are worth having
          std::printf("%-16s %7d %s\n", path.stem().string().c_str(), setup.mesh.tet_count(), error.what());
        }
      }
  }
  io::write_file(options.output / "frequencies.csv", csv(rows));
}

}  // namespace lobe::bench
