#include "lobe/scene/read_selector.h"

#include <nlohmann/json.hpp>

namespace lobe {
namespace {

using nlohmann::json;

SelectPlane read_plane(const json& plane) {
  SelectPlane select{read_vector(plane["point"]), read_vector(plane["normal"])};
  if (plane.contains("within")) {
    select.within = plane["within"];
  } else {
    select.side = plane["side"] == "above" ? SelectPlane::Side::above : SelectPlane::Side::below;
  }
  return select;
}

// One, or a list of them.
json as_list(const json& value) { return value.is_array() ? value : json::array({value}); }

SelectLabel read_labels(const json& value) {
  SelectLabel select;
  for (const json& label : as_list(value))
    label.is_string() ? select.names.push_back(label) : select.labels.push_back(label);
  return select;
}

SelectSurface read_surfaces(const json& value) {
  SelectSurface select;
  for (const json& surface : as_list(value))
    select.names.push_back(surface.is_string() ? surface.get<std::string>() : surface.dump());
  return select;
}

SelectBody read_bodies(const json& value) {
  SelectBody select;
  for (const json& name : as_list(value)) select.names.push_back(name);
  return select;
}

std::vector<Selector> read_parts(const json& array) {
  std::vector<Selector> parts;
  for (const json& part : array) parts.push_back(read_selector(part));
  return parts;
}

}  // namespace

Vec3d read_vector(const nlohmann::json& row, std::size_t from) {
  return Vec3d(row[from].get<double>(), row[from + 1].get<double>(), row[from + 2].get<double>());
}

Selector read_selector(const nlohmann::json& object) {
  const std::string& key = object.begin().key();
  const json& value = object.front();
  if (key == "box") return {SelectBox{read_vector(value["min"]), read_vector(value["max"])}};
  if (key == "sphere") return {SelectSphere{read_vector(value["center"]), value["radius"].get<double>()}};
  if (key == "plane") return {read_plane(value)};
  if (key == "nearest") return {SelectNearest{read_vector(value["point"]), value["count"].get<int>()}};
  if (key == "label") return {read_labels(value)};
  if (key == "body") return {read_bodies(value)};
  if (key == "surface") return {read_surfaces(value)};
  if (key == "patch") return {SelectPatch{read_vector(value["point"]), value.value("angle", 40.0)}};
  if (key == "vertices") return {SelectVertices{value.get<std::vector<Index>>()}};
  if (key == "tetrahedra") return {SelectTetrahedra{value.get<std::vector<Index>>()}};
  if (key == "any_of") return {SelectAnyOf{read_parts(value)}};
  if (key == "all_of") return {SelectAllOf{read_parts(value)}};
  if (key == "not") return {SelectNot{{read_selector(value)}}};
  return {SelectAll{}};
}

}  // namespace lobe
