#include "lobe/sim/validate_parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lobe/assert.h"

namespace lobe {
namespace {

bool are_near(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)); }

// ---- Lattice

// Samples of reduced tetrahedra, and of no others, belong to a part of the lattice. Its lists end where
// tetrahedra and vertices that blades have made elsewhere begin.
void validate_lattice_parts(const Lattice& lattice, const Elements& elements) {
  const Topology& topology = elements.topology;
  const auto parts = static_cast<Index>(lattice.parts.size());
  lobe_assert(lattice.part_of_sample.size() <= tet_samples * std::size_t(topology.tet_count()) &&
                  lattice.part_of_vertex.size() <= std::size_t(topology.vertex_count()),
              "lattice: a part of a sample or a vertex that there is not");
  for (Index t = 0; t < topology.tet_count(); ++t)
    for (int k = 0; k < tet_samples; ++k) {
      const auto sample = std::size_t(tet_samples * t + k);
      const Index part = sample < lattice.part_of_sample.size() ? lattice.part_of_sample[sample] : -1;
      lobe_assert(elements.is_in(RegionModel::reduced, t) ? part >= 0 && part < parts : part == -1,
                  "lattice: the part of a sample");
    }
  for (const Lattice::Part& part : lattice.parts)
    for (const Index node : part.nodes)
      lobe_assert(node >= 0 && node < lattice.node_count(), "lattice: a node of a part");
}

// An embedded vertex has a part that moves it, and the nodes have its mass and move.
template <class Real>
void validate_embedding(const LatticeRegion<Real>& region, const Dynamics<Real>& body) {
  const Embedding& embedding = region.embedding();
  const Lattice& lattice = region.lattice();
  double embedded = 0;  // [kg]
  for (const Index v : embedding.vertices) {
    lobe_assert(embedding.embeds(v), "lattice: a vertex in the list of embedded ones that is none");
    const Index part =
        v < static_cast<Index>(lattice.part_of_vertex.size()) ? lattice.part_of_vertex[std::size_t(v)] : -1;
    lobe_assert(part >= 0 && part < static_cast<Index>(lattice.parts.size()),
                "lattice: the part of a vertex");
    embedded += lumped_mass(body.model.elements, v);
  }
  for (const Index t : embedding.full)
    lobe_assert(body.model.elements.is_in(RegionModel::reduced, t),
                "lattice: a full tetrahedron that is not reduced");
  const double nodes = std::accumulate(embedding.mass.begin(), embedding.mass.end(), 0.0);
  lobe_assert(embedding.mass.size() == std::size_t(lattice.node_count()) && nodes >= embedded * (1 - 1e-9),
              "lattice: masses of nodes");
  lobe_assert(body.motion.nodes.u.cols() == lattice.node_count() &&
                  body.motion.nodes.v.cols() == lattice.node_count() && body.motion.nodes.u.allFinite() &&
                  body.motion.nodes.v.allFinite(),
              "lattice: one finite displacement and velocity per node");
}

template <class Real>
void validate_lattice(const Dynamics<Real>& body) {
  const LatticeRegion<Real>& region = body.regions.reduced();
  if (region.any()) validate_lattice_parts(region.lattice(), body.model.elements);
  if (region.any_embedded()) validate_embedding(region, body);
}

// ---- Mass

// The interface of a condensed region carries the mass of its interior, all of it where nothing holds the
// region, and less where a part of the interior moves with what is held.
template <class Real>
void validate_carried_mass(const Dynamics<Real>& body, double inside) {
  const Elements& elements = body.model.elements;
  double carried = 0;
  for (const Index v : body.regions.shared()) carried += body.regions.carried(v);
  lobe_assert(carried >= 0 && carried <= inside * (1 + 1e-6), "regions: the mass of a condensed interior");
  const auto holds_region = [&](const HeldVertices::Held& item) {
    const auto around = elements.topology.around(item.vertex);
    return std::any_of(around.begin(), around.end(), [&](Index t) { return body.regions.is_condensed(t); });
  };
  const std::vector<HeldVertices::Held>& held = body.model.held.all();
  if (std::none_of(held.begin(), held.end(), holds_region))
    lobe_assert(carried >= inside * (1 - 1e-6), "regions: the mass of a condensed interior that is free");
}

// All mass of the tetrahedra moves somewhere, and what was added to it. Of a condensed interior that moves
// which its interface carries.
template <class Real>
void validate_total_mass(const Dynamics<Real>& body) {
  const Elements& elements = body.model.elements;
  const LatticeRegion<Real>& region = body.regions.reduced();
  const bool is_condensed = body.regions.any_condensed() && !body.regions.is_expanded();
  double of_tets = 0, of_vertices = 0, inside = 0, added = body.inertia.mass_of_floor(), moving = 0;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t)) of_tets += elements.elastic_of(t).density * elements.volume(t);
  for (Index v = 0; v < elements.topology.vertex_count(); ++v) {
    const double lumped = lumped_mass(elements, v);
    of_vertices += lumped;
    added += body.regions.carried(v);
    if (is_condensed && body.regions.is_interior(v)) inside += lumped;
    moving += body.inertia.mass()[std::size_t(v)];
  }
  lobe_assert(are_near(of_vertices, of_tets), "inertia: the mass of the tetrahedra");
  if (is_condensed) validate_carried_mass(body, inside);
  if (region.any_embedded()) {
    added += region.mass_added();
    moving = std::accumulate(region.embedding().mass.begin(), region.embedding().mass.end(), moving);
  }
  lobe_assert(are_near(moving, of_tets - inside + added), "inertia: the mass of the body");
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
  const bool are_up_to_date = world.body().regions.are_up_to_date();
  if (are_up_to_date) validate_lattice(world.body());
  validate_tools(world.tools(), world.elements().topology.vertex_count());
  validate_sleep(world.body());
  if (world.grains()) validate_grains(*world.grains(), world.elements());
  if (are_up_to_date) validate_total_mass(world.body());  // last, as faults of parts change it, too
}

template void validate_parts(const World<float>&);
template void validate_parts(const World<double>&);

}  // namespace lobe
