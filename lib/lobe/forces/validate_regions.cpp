#include "lobe/forces/validate_regions.h"

#include <algorithm>
#include <numeric>

#include "lobe/assert.h"

namespace lobe {
namespace {

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
void validate_embedding(const LatticeRegion<Real>& region, const Elements& elements,
                        const Nodes<Real>& nodes) {
  const Embedding& embedding = region.embedding();
  const Lattice& lattice = region.lattice();
  double embedded = 0;  // [kg]
  for (const Index v : embedding.vertices) {
    lobe_assert(embedding.embeds(v), "lattice: a vertex in the list of embedded ones that is none");
    const Index part =
        v < static_cast<Index>(lattice.part_of_vertex.size()) ? lattice.part_of_vertex[std::size_t(v)] : -1;
    lobe_assert(part >= 0 && part < static_cast<Index>(lattice.parts.size()),
                "lattice: the part of a vertex");
    embedded += lumped_mass(elements, v);
  }
  for (const Index t : embedding.full)
    lobe_assert(elements.is_in(RegionModel::reduced, t), "lattice: a full tetrahedron that is not reduced");
  const double mass = std::accumulate(embedding.mass.begin(), embedding.mass.end(), 0.0);
  lobe_assert(embedding.mass.size() == std::size_t(lattice.node_count()) && mass >= embedded * (1 - 1e-9),
              "lattice: masses of nodes");
  lobe_assert(nodes.u.cols() == lattice.node_count() && nodes.v.cols() == lattice.node_count() &&
                  nodes.u.allFinite() && nodes.v.allFinite(),
              "lattice: one finite displacement and velocity per node");
}

template <class Real>
void validate_lattice(const LatticeRegion<Real>& region, const Elements& elements, const Nodes<Real>& nodes) {
  if (region.any()) validate_lattice_parts(region.lattice(), elements);
  if (region.any_embedded()) validate_embedding(region, elements, nodes);
}

// ---- Pre-computed regions

template <class Real>
void validate_condensed(const Regions<Real>& regions, const Elements& elements) {
  Index condensed = 0;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const bool expected = elements.is_in(RegionModel::precomputed, t);
    lobe_assert(regions.is_condensed(t) == expected, "regions: which tetrahedra are condensed");
    condensed += expected;
  }
  lobe_assert(regions.any_condensed() == (condensed > 0), "regions: whether any is condensed");
}

// The interface of a condensed region carries the mass of its interior, all of it where nothing holds the
// region, and less where a part of the interior moves with what is held.
template <class Real>
void validate_carried_mass(const Regions<Real>& regions, const Model& model, double inside) {
  double carried = 0;
  for (const Index v : regions.shared()) carried += regions.carried(v);
  lobe_assert(carried >= 0 && carried <= inside * (1 + 1e-6), "regions: the mass of a condensed interior");
  const auto holds_region = [&](const HeldVertices::Held& item) {
    const auto around = model.elements.topology.around(item.vertex);
    return std::any_of(around.begin(), around.end(), [&](Index t) { return regions.is_condensed(t); });
  };
  const std::vector<HeldVertices::Held>& held = model.held.all();
  if (std::none_of(held.begin(), held.end(), holds_region))
    lobe_assert(carried >= inside * (1 - 1e-6), "regions: the mass of a condensed interior that is free");
}

}  // namespace

template <class Real>
void validate_regions(const Regions<Real>& regions, const Model& model, const Motion<Real>& motion) {
  validate_condensed(regions, model.elements);
  if (regions.are_up_to_date()) validate_lattice(regions.reduced(), model.elements, motion.nodes);
}

template <class Real>
RegionMass mass_of_regions(const Regions<Real>& regions, const Model& model) {
  const bool is_condensed = regions.any_condensed() && !regions.is_expanded();
  RegionMass mass;
  for (Index v = 0; v < model.elements.topology.vertex_count(); ++v) {
    mass.added += regions.carried(v);
    if (is_condensed && regions.is_interior(v)) mass.inside += lumped_mass(model.elements, v);
  }
  if (is_condensed) validate_carried_mass(regions, model, mass.inside);
  if (const LatticeRegion<Real>& region = regions.reduced(); region.any_embedded()) {
    mass.added += region.mass_added();
    mass.in_nodes = std::accumulate(region.embedding().mass.begin(), region.embedding().mass.end(), 0.0);
  }
  return mass;
}

#define LOBE_INSTANTIATE(Real)                                                             \
  template void validate_regions(const Regions<Real>&, const Model&, const Motion<Real>&); \
  template RegionMass mass_of_regions(const Regions<Real>&, const Model&);
LOBE_INSTANTIATE(float)
LOBE_INSTANTIATE(double)
#undef LOBE_INSTANTIATE

}  // namespace lobe
