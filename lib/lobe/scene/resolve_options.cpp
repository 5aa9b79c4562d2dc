// Options of a scene that exclude each other (setup/exclusions.h), each at its place in the file.
#include "lobe/scene/resolve_parts.h"
#include "lobe/setup/exclusions.h"

namespace lobe {
namespace {

// The entries of a list that satisfy a condition, as JSON pointers.
template <class Entry, class Condition>
std::vector<std::string> places_in(const std::vector<Entry>& entries, const std::string& list,
                                   const std::string& key, const Condition& condition) {
  std::vector<std::string> places;
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (condition(entries[i])) places.push_back(list + "/" + std::to_string(i) + "/" + key);
  return places;
}

std::vector<std::string> place_if(bool is_used, const char* place) {
  return is_used ? std::vector<std::string>{place} : std::vector<std::string>{};
}

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& then) {
  first.insert(first.end(), then.begin(), then.end());
  return first;
}

bool holds_partly(const Boundary& entry) { return entry.hold_by != HoldBy::vertices; }
bool grasps_partly(const Tool& tool) {
  return tool.is<GraspSetup>() && tool.as<GraspSetup>().hold_by != HoldBy::vertices;
}

std::vector<std::string> places_of_force_terms(const Scene& scene) {
  const auto pushes = [](const Tool& tool) {
    return std::visit([](const auto& kind) { return needs_force_term(kind); }, tool.kind);
  };
  const auto is_pressure = [](const Boundary& entry) { return entry.kind == Boundary::Kind::pressure; };
  std::vector<std::string> places =
      joined(joined(places_in(scene.tools, "/tools", "type", pushes),
                    places_in(scene.boundary, "/boundary", "pressure", is_pressure)),
             place_if(scene.contact.is_on(), "/contact"));
  for (const std::string& key : scene.force_keys()) places.push_back("/" + key);
  return places;
}

// Where a scene asks for an option; nowhere if it does not.
std::vector<std::string> places_of(const Scene& scene, Option option) {
  const Time& time = scene.time;
  if (std::size_t(option) < region_model_names.size())
    return places_in(scene.regions, "/regions", "model",
                     [&](const Region& region) { return option_of(region.model) == option; });
  switch (option) {
    case Option::fibres:
      return places_in(scene.materials, "/materials", "fibre",
                       [](const Material& material) { return material.transverse.has_value(); });
    case Option::corotated:
      return places_in(scene.regions, "/regions", "frame",
                       [](const Region& region) { return region.frame == RegionFrame::corotated; });
    case Option::nodal_pressure:
      return places_in(scene.materials, "/materials", "nodal_pressure",
                       [](const Material& material) { return material.nodal_pressure > 0; });
    case Option::viscous:
      return places_in(scene.materials, "/materials", "viscosity",
                       [](const Material& material) { return material.viscosity[0].time > 0; });
    case Option::edge_smoothed:
      return places_in(scene.materials, "/materials", "element", [](const Material& material) {
        return material.element == ElementType::edge_smoothed;
      });
    case Option::other_law:
      return places_in(scene.materials, "/materials", "law",
                       [](const Material& material) { return material.law != MaterialLaw::svk; });
    case Option::automatic:
      return place_if(scene.auto_regions.has_value(), "/regions/auto");
    case Option::sleep:
      return place_if(time.sleep.value_or(0) > 0, "/time/sleep");
    case Option::own_steps:
      return place_if(time.own_steps, "/time/own_steps");
    case Option::selective_mass:
      return place_if(time.selective_mass > 1, "/time/selective_mass");
    case Option::implicit:
      return place_if(time.integrator == Integrator::generalised_alpha, "/time/integrator");
    case Option::force_terms:
      return places_of_force_terms(scene);
    case Option::partly_held:
      return joined(places_in(scene.boundary, "/boundary", "hold_by", holds_partly),
                    places_in(scene.tools, "/tools", "hold_by", grasps_partly));
    case Option::expandable:
    case Option::single_precision:
    case Option::static_solution:
      return {};  // a scene cannot say these
  }
  return {};
}

}  // namespace

Options options_of(const Scene& scene) {
  Options used;
  for (std::size_t i = 0; i < option_count; ++i) used.add(Option(i), !places_of(scene, Option(i)).empty());
  return used;
}

void refuse_excluded_options(Resolution& resolution) {
  const auto places = [&](Option option) { return places_of(resolution.scene, option); };
  for (Fault& fault : find_exclusions(options_of(resolution.scene), places))
    resolution.faults.push_back(std::move(fault));
}

}  // namespace lobe
