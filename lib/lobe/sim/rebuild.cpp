#include "lobe/sim/rebuild.h"

#include <algorithm>
#include <array>
#include <limits>

namespace lobe {
namespace {

double relative(double difference, double scale) {
  if (difference == 0) return 0;
  return scale > 0 ? difference / scale : std::numeric_limits<double>::infinity();
}

// Boundary triangles with their vertices renamed and rotated to start with the smallest, sorted.
std::vector<std::array<Index, 3>> boundary(const Topology& topology, const std::vector<Index>* rename) {
  std::vector<std::array<Index, 3>> faces;
  for (Index code : topology.boundary_faces()) {
    const Eigen::Vector3i v = topology.face(code);
    std::array<Index, 3> face{v[0], v[1], v[2]};
    if (rename)
      for (Index& i : face) i = (*rename)[i];
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

}  // namespace

double RebuildDifference::largest() const {
  if (!same_boundary || !same_regions) return std::numeric_limits<double>::infinity();
  return std::max({mass, force, interior, frequency});
}

template <class Real>
RebuildDifference compare_with_rebuilt(World<Real>& world) {
  RebuildDifference d;
  if (world.elements().topology.alive_count() == 0) {
    d.mass = *std::max_element(world.body().inertia.mass().begin(), world.body().inertia.mass().end());
    d.same_boundary = world.elements().topology.boundary_faces().empty();
    return d;
  }
  CompactMesh c;
  const Setup setup = world.current_setup(c);
  World<Real> fresh(setup);
  fresh.organ_.take_mode(world.organ_, c.vertex_source);
  State<Real> state;
  state.u = world.state().u(Eigen::all, c.vertex_source);
  state.v = world.state().v(Eigen::all, c.vertex_source);
  state.time = world.time();
  fresh.set_state(state);
  // A fresh world has no history: both are compared at rest in their strain.
  const std::vector<Real> dashpots = world.body().regions.dashpots();
  world.body().regions.relax_all(world.elements(), world.body().motion.u.padded());
  const Mat3X<Real>& mine = world.forces();
  const Mat3X<Real>& fresh_forces = fresh.forces();
  const Mat3X<Real>&u = world.state().u, &fresh_u = fresh.state().u;
  double mass_scale = 0, force_scale = 0, scale = 0;
  for (Index v = 0; v < fresh.elements().topology.vertex_count(); ++v) {
    const Index source = c.vertex_source[v];
    mass_scale = std::max(mass_scale, fresh.body().inertia.mass()[v]);
    d.mass = std::max(d.mass, std::abs(world.body().inertia.mass()[source] - fresh.body().inertia.mass()[v]));
    force_scale = std::max(force_scale, double(fresh_forces.col(v).norm()));
    d.force = std::max(d.force, double((mine.col(source) - fresh_forces.col(v)).norm()));
    scale = std::max(scale, double(fresh_u.col(v).norm()));
    d.interior = std::max(d.interior, double((u.col(source) - fresh_u.col(v)).norm()));
  }
  d.mass = relative(d.mass, mass_scale);
  d.force = relative(d.force, force_scale);
  d.interior = relative(d.interior, scale);
  const double omega = fresh.step_limit().highest_vertex(fresh.body()).omega;
  d.frequency = relative(std::abs(world.step_limit().highest_vertex(world.body()).omega - omega), omega);
  world.body().regions.set_dashpots(dashpots);
  d.same_boundary = world.grains() || boundary(world.elements().topology, &c.vertex_target) ==
                                          boundary(fresh.elements().topology, nullptr);
  for (Index t = 0; t < fresh.elements().topology.tet_count(); ++t)
    d.same_regions =
        d.same_regions && fresh.elements().region_of[t] == world.elements().region_of[c.tet_source[t]];
  return d;
}

template RebuildDifference compare_with_rebuilt(World<float>&);
template RebuildDifference compare_with_rebuilt(World<double>&);

}  // namespace lobe
