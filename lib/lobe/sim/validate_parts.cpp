#include "lobe/sim/validate_parts.h"

#include <algorithm>
#include <cmath>

#include "lobe/assert.h"
#include "lobe/forces/validate_regions.h"

namespace lobe {
namespace {

bool are_near(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)); }

// ---- Mass

// All mass of the tetrahedra moves somewhere, and what was added to it. Of vertices that follow an interface
// that moves which the interface carries.
template <class Real>
void validate_total_mass(const Dynamics<Real>& body) {
  const Elements& elements = body.model.elements;
  double of_tets = 0, of_vertices = 0, moving = 0;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t)) of_tets += elements.elastic_of(t).density * elements.volume(t);
  for (Index v = 0; v < elements.topology.vertex_count(); ++v) {
    of_vertices += lumped_mass(elements, v);
    moving += body.inertia.mass()[std::size_t(v)];
  }
  lobe_assert(are_near(of_vertices, of_tets), "inertia: the mass of the tetrahedra");
  const RegionMass regions = mass_of_regions(body.regions, body.model);
  lobe_assert(are_near(moving + regions.in_nodes,
                       of_tets - regions.inside + regions.added + body.inertia.mass_of_floor()),
              "inertia: the mass of the body");
}

// ---- Tools, sleep, grains

void validate_tools(const Tools& tools, Index vertices) {
  for (const Grasp& grasp : tools.lists().grasps)
    for (const Index v : grasp.vertices)
      lobe_assert(v >= 0 && v < vertices, "tools: a grasp of a vertex that there is not");
}

template <class Real>
void validate_sleep(const Dynamics<Real>& body) {
  const std::vector<std::uint8_t>& asleep = body.sleep.state().asleep;
  const auto vertices = std::size_t(body.model.elements.topology.vertex_count());
  lobe_assert(asleep.size() == (body.sleep.is_on() ? vertices : 0), "sleep: one flag per vertex");
  lobe_assert(std::count_if(asleep.begin(), asleep.end(), [](std::uint8_t flag) { return flag != 0; }) ==
                  body.sleep.count(),
              "sleep: how many vertices are asleep");
}

// Neighbours know each other, and a tetrahedron has the share of volume that its grains fill.
void validate_grains(const Grains& grains, const Elements& elements) {
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    double share = 0;
    for (const Index g : grains.of(t)) {
      lobe_assert(grains[g].element == t, "grains: the tetrahedron of a grain");
      share += grains[g].share;
      for (int face = 0; face < 4; ++face) {
        const Index other = grains.other_side(4 * g + face);
        if (other < 0) continue;
        lobe_assert(
            grains.other_side(other) == 4 * g + face && elements.topology.alive(grains[other / 4].element),
            "grains: a neighbour across a face");
      }
    }
    lobe_assert(are_near(share, elements.share_of(t)), "grains: the share of a tetrahedron");
  }
}

}  // namespace

template <class Real>
void validate_parts(const World<Real>& world) {
  const Dynamics<Real>& body = world.body();
  validate_regions(body.regions, body.model, body.motion);
  validate_tools(world.tools(), world.elements().topology.vertex_count());
  validate_sleep(body);
  if (world.grains()) validate_grains(*world.grains(), world.elements());
  if (body.regions.are_up_to_date()) validate_total_mass(body);  // last: faults of parts change it, too
}

template void validate_parts(const World<float>&);
template void validate_parts(const World<double>&);

}  // namespace lobe
