#include "lobe/scene/read_selector.h"

#include <nlohmann/json.hpp>

#include "lobe/scene/json_text.h"

namespace lobe {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

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

ordered_json parts(const std::vector<Selector>& selectors) {
  ordered_json array = ordered_json::array();
  for (const Selector& part : selectors) array.push_back(write_selector(part));
  return array;
}

ordered_json write(const SelectAll&) { return {{"all", true}}; }
ordered_json write(const SelectBox& box) {
  return {{"box", {{"min", vector_json(box.min)}, {"max", vector_json(box.max)}}}};
}
ordered_json write(const SelectSphere& sphere) {
  return {{"sphere", {{"center", vector_json(sphere.center)}, {"radius", sphere.radius}}}};
}
ordered_json write(const SelectPlane& plane) {
  ordered_json object = {{"point", vector_json(plane.point)}, {"normal", vector_json(plane.normal)}};
  if (plane.side == SelectPlane::Side::within) {
    object["within"] = plane.within;
  } else {
    object["side"] = plane.side == SelectPlane::Side::above ? "above" : "below";
  }
  return {{"plane", object}};
}
ordered_json write(const SelectNearest& nearest) {
  return {{"nearest", {{"point", vector_json(nearest.point)}, {"count", nearest.count}}}};
}
ordered_json write(const SelectLabel& label) {
  ordered_json labels = label.labels;
  for (const std::string& name : label.names) labels.push_back(name);
  return {{"label", labels}};
}
ordered_json write(const SelectSurface& select) { return {{"surface", select.names}}; }
ordered_json write(const SelectBody& select) { return {{"body", select.names}}; }
ordered_json write(const SelectPatch& patch) {
  return {{"patch", {{"point", vector_json(patch.point)}, {"angle", patch.angle}}}};
}
ordered_json write(const SelectVertices& select) { return {{"vertices", select.vertices}}; }
ordered_json write(const SelectTetrahedra& select) { return {{"tetrahedra", select.tetrahedra}}; }
ordered_json write(const SelectAnyOf& any) { return {{"any_of", parts(any.parts)}}; }
ordered_json write(const SelectAllOf& all) { return {{"all_of", parts(all.parts)}}; }
ordered_json write(const SelectNot& negated) {
  return {{"not", negated.part.size() == 1 ? write_selector(negated.part[0]) : ordered_json(nullptr)}};
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

nlohmann::ordered_json write_selector(const Selector& value) {
  return std::visit([](const auto& select) { return write(select); }, value.value);
}

}  // namespace lobe
