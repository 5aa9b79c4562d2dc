#include "lobe/setup/exclusions.h"

#include <algorithm>

namespace lobe {
namespace {

constexpr Option precomputed = option_of(RegionModel::precomputed);
constexpr Option reduced = option_of(RegionModel::reduced);
constexpr Option tensor_mass = option_of(RegionModel::tensor_mass);
constexpr Option corotational = option_of(RegionModel::corotational);

constexpr Exclusion table[] = {
    {precomputed, Option::implicit, "an implicit step solves for every vertex", "use \"tensor-mass\""},
    {Option::automatic, Option::implicit, "an implicit step gains nothing from linear regions",
     "leave one of them out"},
    {Option::sleep, Option::implicit, "an implicit step solves for every vertex", "leave it out"},
    {Option::selective_mass, Option::implicit, "it lengthens explicit steps", "leave it out"},
    {Option::force_terms, Option::implicit, "its tangent does not know their stiffness",
     "use external forces, or the explicit integrator"},
    {Option::single_precision, Option::implicit, "its iterations need more digits", "use double precision"},
    {corotational, Option::fibres, "its energy is that of a material alike in all directions",
     "use \"nonlinear\""},
    {Option::partly_held, precomputed, "a precomputed region knows wholly held vertices only",
     "use \"tensor-mass\" or \"nonlinear\""},
    {Option::partly_held, reduced, "nodes of its lattice know wholly held vertices only",
     "use \"nonlinear\""},
    {Option::partly_held, Option::automatic, "estimated errors are of wholly held vertices",
     "leave one of them out"},
    {Option::partly_held, Option::implicit, "its tangent does not know their springs",
     "use the explicit integrator"},
    {Option::partly_held, Option::sleep, "springs of what sleeps are not watched", "leave one of them out"},
    {Option::partly_held, Option::selective_mass, "it couples masses that the springs add to",
     "leave one of them out"},
    {Option::sleep, Option::nodal_pressure, "the pressure of a patch depends on its neighbours",
     "leave one of them out"},
    {Option::expandable, Option::corotated, "an expanded region has no frame", "use a fixed frame"},
    {Option::expandable, Option::nodal_pressure, "the region is condensed without it",
     "leave one of them out"},
    {reduced, Option::implicit, "an implicit step solves for every vertex", "use \"nonlinear\""},
    {reduced, Option::sleep, "nodes of its lattice do not sleep", "leave one of them out"},
    {reduced, Option::selective_mass, "selective masses couple vertices, not nodes", "leave one of them out"},
    {reduced, Option::nodal_pressure, "a cell of the lattice has no nodal pressure", "leave one of them out"},
    {reduced, Option::fibres, "a cell has no direction of fibres", "use \"nonlinear\""},
    {Option::viscous, precomputed, "a condensed stiffness has no strains that could relax",
     "use \"nonlinear\" or \"corotational\""},
    {Option::viscous, reduced, "a cell of the lattice has no strain of its own that could relax",
     "use \"nonlinear\" or \"corotational\""},
    {Option::viscous, tensor_mass, "edges have no strain that could relax",
     "use \"nonlinear\" or \"corotational\""},
    {Option::viscous, Option::automatic, "estimated errors are of elastic regions", "leave one of them out"},
    {Option::viscous, Option::implicit, "its tangent does not know branches that relax",
     "use the explicit integrator"},
    {Option::viscous, Option::sleep, "what is still may go on relaxing", "leave one of them out"},
    {Option::own_steps, Option::implicit, "an implicit step is taken by all vertices", "leave it out"},
    {Option::own_steps, precomputed, "a condensed interior follows its interface in every step",
     "use \"tensor-mass\" or \"nonlinear\""},
    {Option::own_steps, reduced, "nodes of its lattice step together", "use \"nonlinear\""},
    {Option::own_steps, Option::automatic, "regions that lobe chooses may be precomputed or reduced",
     "leave one of them out"},
    {Option::own_steps, Option::selective_mass, "selective masses couple all vertices",
     "leave one of them out"},
    {Option::own_steps, Option::nodal_pressure, "the pressure of a patch depends on its neighbours",
     "leave one of them out"},
    {Option::own_steps, Option::viscous, "dashpots of all patches take the same steps",
     "leave one of them out"},
    {Option::own_steps, Option::sleep, "where lengths of steps differ, vertices at rest have velocities",
     "leave one of them out"},
    {Option::static_solution, Option::corotated, "an equilibrium has no motion that a frame could follow",
     "use \"nonlinear\" or a fixed frame"},
};

constexpr Exclusion table_of_material[] = {
    {Option::other_law, Option::fibres, "constants along and across fibres are those of St Venant-Kirchhoff",
     "use \"law\": \"svk\""},
};

Fault fault_of(const Exclusion& exclusion, const std::string& place) {
  return {place, name(exclusion.option) + " does not go with " + name(exclusion.other) + ": " +
                     exclusion.reason + "; " + exclusion.remedy};
}

bool excludes(const Exclusion& exclusion, Option wanted, const Options& used) {
  return (exclusion.option == wanted && used.has(exclusion.other)) ||
         (exclusion.other == wanted && used.has(exclusion.option));
}

}  // namespace

std::string name(Option option) {
  if (const auto model = std::size_t(option); model < region_model_names.size())
    return "\"model\": \"" + std::string(region_model_names[model]) + "\"";
  switch (option) {
    case Option::corotated:
      return "\"frame\": \"corotated\"";
    case Option::expandable:
      return "an expandable region";
    case Option::automatic:
      return "\"regions\": {\"auto\": …}";
    case Option::nodal_pressure:
      return "\"nodal_pressure\"";
    case Option::edge_smoothed:
      return "\"element\": \"edge-smoothed\"";
    case Option::other_law:
      return "a law other than SVK";
    case Option::fibres:
      return "a material with fibres";
    case Option::sleep:
      return "\"sleep\"";
    case Option::selective_mass:
      return "\"selective_mass\"";
    case Option::force_terms:
      return "a probe, a needle, a pressure, a thread, an attachment, a clip, a force term or springs";
    case Option::implicit:
      return "\"integrator\": \"implicit\"";
    case Option::single_precision:
      return "single precision";
    case Option::own_steps:
      return "\"own_steps\"";
    case Option::viscous:
      return "\"viscosity\"";
    case Option::partly_held:
      return "\"hold_by\": \"volume\" or \"area\"";
    case Option::static_solution:
      return "a static solution";
  }
  return "";
}

std::span<const Exclusion> exclusions() { return table; }
std::span<const Exclusion> material_exclusions() { return table_of_material; }

bool any_partly_held(const Setup& setup) {
  bool any = !setup.partly_held.empty();
  for_each_tool(static_cast<const ToolSetups&>(setup), [&](const auto& tool) {
    if constexpr (requires { tool.any_partly(); }) any = any || tool.any_partly();
  });
  return any;
}

Options options_of(const Setup& setup) {
  Options used;
  for (const RegionModel model : setup.region_of) used.add(option_of(model));
  used.add(Option::corotated, used.has(precomputed) && setup.precomputed_frame == RegionFrame::corotated);
  used.add(Option::expandable, setup.expandable);
  used.add(Option::nodal_pressure, any_nodal_pressure(setup.materials));
  used.add(Option::edge_smoothed, any_smoothed(setup.materials));
  used.add(Option::fibres, any_fibre(setup.materials));
  used.add(Option::viscous, any_viscous(setup.materials));
  used.add(Option::other_law, any_other_law(setup.materials));
  used.add(Option::sleep, setup.sleep > 0);
  used.add(Option::own_steps, setup.own_steps);
  used.add(Option::selective_mass, setup.selective_mass > 1);
  used.add(Option::force_terms, setup.contact.is_on() || !setup.pressures.empty() || setup.any_force());
  for_each_tool(static_cast<const ToolSetups&>(setup),
                [&](const auto& tool) { used.add(Option::force_terms, needs_force_term(tool)); });
  used.add(Option::partly_held, any_partly_held(setup));
  used.add(Option::implicit, setup.integrator == Integrator::generalised_alpha);
  return used;
}

std::vector<Fault> find_exclusions(const Options& used, const PlacesOf& places_of) {
  std::vector<Fault> faults;
  for (const Exclusion& exclusion : table)
    if (used.has(exclusion.option) && used.has(exclusion.other))
      for (const std::string& place : places_of(exclusion.option))
        faults.push_back(fault_of(exclusion, place));
  return faults;
}

std::vector<Fault> find_material_exclusions(MaterialLaw law, bool has_fibres, const std::string& place) {
  Options used;
  used.add(Option::other_law, law != MaterialLaw::svk);
  used.add(Option::fibres, has_fibres);
  std::vector<Fault> faults;
  for (const Exclusion& exclusion : table_of_material)
    if (used.has(exclusion.option) && used.has(exclusion.other)) faults.push_back(fault_of(exclusion, place));
  return faults;
}

bool goes_with(Option wanted, const Options& used) {
  return std::none_of(std::begin(table), std::end(table),
                      [&](const Exclusion& exclusion) { return excludes(exclusion, wanted, used); });
}

void refuse_excluded(Option wanted, const Options& used, const std::string& place) {
  for (const Exclusion& exclusion : table)
    if (excludes(exclusion, wanted, used)) throw InputError({fault_of(exclusion, place)});
}

}  // namespace lobe
