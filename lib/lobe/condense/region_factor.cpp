#include "lobe/condense/region_factor.h"

#include <algorithm>

#include "lobe/error.h"
#include "lobe/solve/tangent.h"

namespace lobe {
namespace {

// A body of the region's tetrahedra only.
struct Part {
  Body body;
  std::vector<Index> source;  // per vertex: its number in the whole
};

Part region_part(const Elements& elements, RegionModel model) {
  Part part;
  std::vector<Index> target(std::size_t(elements.topology.vertex_count()), -1), tets;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.is_in(RegionModel::precomputed, t)) continue;
    tets.push_back(t);
    for (Index v : elements.topology.corners(t)) {
      if (target[v] >= 0) continue;
      target[v] = static_cast<Index>(part.source.size());
      part.source.push_back(v);
    }
  }
  Body& body = part.body;
  body.mesh.points = elements.points.view()(Eigen::all, part.source);
  body.mesh.tets.resize(4, Eigen::Index(tets.size()));
  for (std::size_t i = 0; i < tets.size(); ++i) {
    for (int c = 0; c < 4; ++c)
      body.mesh.tets(c, Eigen::Index(i)) = target[elements.topology.tets()(c, tets[i])];
    body.material_of.push_back(elements.material_of[tets[i]]);
    if (!elements.shares.empty()) body.shares.push_back(elements.shares[tets[i]]);
  }
  if (elements.fibres.cols() > 0) body.mesh.fibres = elements.fibres(Eigen::all, tets);
  body.mesh.labels.assign(tets.size(), 0);
  body.region_of.assign(tets.size(), model);
  body.materials = elements.materials;
  body.volume_penalty = elements.volume_penalty;
  body.guard_below = elements.guard_below;
  return part;
}

}  // namespace

RegionFactor::RegionFactor(const Elements& elements, const Roles& roles, const Linearisation& linearisation) {
  const Part part = region_part(elements, linearisation.model());
  const Elements of_region(part.body);
  const auto vertices = static_cast<Index>(part.source.size());
  const Unknowns unknowns(vertices,
                          [&](Index v, int axis) { return roles(axis, part.source[v]) != Role::none; });
  size = unknowns.count;
  number.setConstant(3, elements.topology.vertex_count(), -1);
  number(Eigen::all, part.source) = unknowns.number;
  springs.assign(std::size_t(size), 0);
  Tangent tangent(of_region, unknowns);
  Mat3X<double> about = Mat3X<double>::Zero(3, vertices);
  if (!linearisation.is_at_rest()) about = linearisation.about(Eigen::all, part.source);
  tangent.update(about);
  const Eigen::VectorXd diagonal = tangent.matrix().diagonal();
  mean_stiffness = size > 0 ? diagonal.mean() : 1;
  std::vector<double> own_springs(std::size_t(vertices), 0);
  for (Index v = 0; v < vertices; ++v) {
    if ((roles.col(part.source[v]).array() == Role::interior).any()) continue;
    for (Index row : unknowns.number.col(v))
      if (row >= 0) own_springs[v] = std::max(own_springs[v], diagonal[row]);
    for (Index row : unknowns.number.col(v))
      if (row >= 0) springs[std::size_t(row)] = own_springs[v];
  }
  tangent.scale_and_add_mass(1, 1, own_springs);
  K = tangent.matrix();
}

std::unique_ptr<SparseFactor> RegionFactor::factorise(const SparseFactorMaker& make_factor,
                                                      CondensingLog& log) const {
  auto factor = log.time(CondensingPhase::ordering, [&] {
    std::unique_ptr<SparseFactor> ordered = make_factor();
    ordered->analyse(K);
    return ordered;
  });
  if (size > 0 && !log.time(CondensingPhase::factor, [&] { return factor->factorise(K); }))
    throw InputError(
        "precomputed region",
        "its stiffness is singular: a part of it can move although nothing moves it; fix more of its "
        "vertices, or make that part tensor-mass or nonlinear");
  return factor;
}

Eigen::VectorXd interior_masses(const Elements& elements, const Roles& roles) {
  Eigen::VectorXd masses = Eigen::VectorXd::Zero(roles.size());
  for (Eigen::Index i = 0; i < roles.size(); ++i)
    if (roles.data()[i] == Role::interior) masses[i] = lumped_mass(elements, static_cast<Index>(i / 3));
  return masses;
}

std::vector<Index> shared_components(const Elements& elements, const Roles& roles) {
  const auto is_other = [&](Index t) { return elements.region_of[t] != RegionModel::precomputed; };
  std::vector<Index> components;
  for (Index v = 0; v < static_cast<Index>(roles.cols()); ++v) {
    const auto around = elements.topology.around(v);
    if (std::none_of(around.begin(), around.end(), is_other)) continue;
    for (int axis = 0; axis < 3; ++axis)
      if (roles(axis, v) == Role::interface) components.push_back(3 * v + axis);
  }
  return components;
}

}  // namespace lobe
