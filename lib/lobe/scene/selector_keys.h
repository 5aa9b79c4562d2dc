// Keys of selectors (docs/scene.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/key_table.h"

namespace lobe::keys {

// One, or a list of them.
inline nlohmann::json as_list(const nlohmann::json& given) {
  return given.is_array() ? given : nlohmann::json::array({given});
}

template <>
struct Form<SelectLabel> {
  static constexpr const char* schema =
      R"({"type": ["integer", "string", "array"], "minimum": -2147483648, "maximum": 2147483647,
          "minLength": 1, "minItems": 1,
          "items": {"type": ["integer", "string"], "minimum": -2147483648, "maximum": 2147483647,
                    "minLength": 1}})";
  static void read(const nlohmann::json& given, SelectLabel& select) {
    for (const nlohmann::json& label : as_list(given))
      label.is_string() ? select.names.push_back(label) : select.labels.push_back(label);
  }
  static nlohmann::ordered_json write(const SelectLabel& select) {
    nlohmann::ordered_json labels = select.labels;
    for (const std::string& name : select.names) labels.push_back(name);
    return labels;
  }
};

template <>
struct Form<SelectSurface> {
  static constexpr const char* schema =
      R"({"type": ["integer", "string", "array"], "minLength": 1, "minItems": 1,
          "items": {"type": ["integer", "string"], "minLength": 1}})";
  static void read(const nlohmann::json& given, SelectSurface& select) {
    for (const nlohmann::json& surface : as_list(given))
      select.names.push_back(surface.is_string() ? surface.get<std::string>() : surface.dump());
  }
  static nlohmann::ordered_json write(const SelectSurface& select) { return select.names; }
};

template <>
struct Form<SelectBody> {
  static constexpr const char* schema =
      R"({"type": ["string", "array"], "minLength": 1, "minItems": 1,
          "items": {"type": "string", "minLength": 1}})";
  static void read(const nlohmann::json& given, SelectBody& select) { as_list(given).get_to(select.names); }
  static nlohmann::ordered_json write(const SelectBody& select) { return select.names; }
};

template <>
struct Form<SelectPlane::Side> {  // where the plane has no thickness
  static constexpr const char* schema = R"({"enum": ["above", "below"]})";
  static void read(const nlohmann::json& given, SelectPlane::Side& side) {
    side = given == "above" ? SelectPlane::Side::above : SelectPlane::Side::below;
  }
  static nlohmann::ordered_json write(SelectPlane::Side side) {
    return side == SelectPlane::Side::above ? "above" : "below";
  }
};
template <>
inline constexpr auto table_of<SelectBox> = Table("", "", Key("min", &SelectBox::min, any.required(), ""),
                                                  Key("max", &SelectBox::max, any.required(), ""));

template <>
inline constexpr auto table_of<SelectSphere> = Table("", "",
                                                     Key("center", &SelectSphere::center, any.required(), ""),
                                                     Key("radius", &SelectSphere::radius, above(0).required(),
                                                         ""));

template <>
inline constexpr auto table_of<SelectPlane> = Table(
    "", R"({"oneOf": [{"required": ["within"]}, {"required": ["side"]}]})",
    Key("point", &SelectPlane::point, any.required(), ""),
    Key("normal", &SelectPlane::normal, any.required(), ""),
    Key("within", Case(&SelectPlane::side, SelectPlane::Side::within, &SelectPlane::within),
        at_least(0).in("m").optional(), "what is at most this far from the plane"),
    Key("side",
        When(&SelectPlane::side, [](const SelectPlane& p) { return p.side != SelectPlane::Side::within; }),
        any.optional(), "above is where the normal points; the plane itself belongs to both sides"));

template <>
inline constexpr auto table_of<SelectNearest> = Table("", "",
                                                      Key("point", &SelectNearest::point, any.required(), ""),
                                                      Key("count", &SelectNearest::count,
                                                          at_least(1).up_to(most_index).required(), ""));

template <>
inline constexpr auto table_of<SelectPatch> = Table(
    "", "",
    Key("point", &SelectPatch::point, any.in("m").required(),
        "the boundary face that is nearest to it is the first"),
    Key("angle", &SelectPatch::angle, above(0).up_to(180), "degrees by which neighbouring faces may turn"));

template <>
inline constexpr auto table_of<Selector> = Table(
    "selector", R"({"minProperties": 1, "maxProperties": 1, "description":
        "A tetrahedron is selected by its barycentre, a boundary face when its three vertices are."})",

    Key("all", alternative<SelectAll>(&Selector::value), any.optional(), "everything"),
    Key("box", alternative<SelectBox>(&Selector::value), any.in("m").optional(),
        "axis-aligned, its faces included"),
    Key("sphere", alternative<SelectSphere>(&Selector::value), any.in("m").optional(),
        "its surface included"),
    Key("plane", alternative<SelectPlane>(&Selector::value), any.optional(),
        "a layer around a plane, or one side of it"),
    Key("nearest", alternative<SelectNearest>(&Selector::value), any.optional(),
        "the `count` nearest vertices, or tetrahedra"),
    Key("label", alternative<SelectLabel>(&Selector::value), any.optional(),
        "tetrahedra with one of these labels, or of these names that the mesh's file has for labels; "
        "vertices of such tetrahedra"),
    Key("body", alternative<SelectBody>(&Selector::value), any.optional(),
        "tetrahedra of the bodies of these names; their vertices"),
    Key("surface", alternative<SelectSurface>(&Selector::value), any.optional(),
        "boundary faces in one of these groups of triangles of the mesh's file, by name or number; their "
        "vertices; tetrahedra that have such a face"),
    Key("patch", alternative<SelectPatch>(&Selector::value), any.optional(),
        "the smooth part of the boundary around a point, such as an inner wall; vertices of its faces; "
        "tetrahedra that have such a face"),
    Key("vertices", alternative(&Selector::value, &SelectVertices::vertices), index.items(1).optional(),
        "vertex indices, from 0; tetrahedra whose four vertices are listed"),
    Key("tetrahedra", alternative(&Selector::value, &SelectTetrahedra::tetrahedra), index.items(1).optional(),
        "tetrahedron indices, from 0; vertices of these tetrahedra"),
    Key("any_of", alternative(&Selector::value, &SelectAnyOf::parts), any.items(1).optional(),
        "what at least one of these selects"),
    Key("all_of", alternative(&Selector::value, &SelectAllOf::parts), any.items(1).optional(),
        "what each of these selects"),
    Key("not", alternative<SelectNot>(&Selector::value), any.optional(), "what this one does not select"));

template <>
struct Form<SelectNot> {  // exactly one
  static constexpr const char* schema = R"({"$ref": "#/definitions/selector"})";
  static void read(const nlohmann::json& given, SelectNot& negated) {
    read_value(given, negated.part.emplace_back(), "");
  }
  static nlohmann::ordered_json write(const SelectNot& negated) {
    return negated.part.size() == 1 ? write_value(negated.part[0]) : nlohmann::ordered_json(nullptr);
  }
};

}  // namespace lobe::keys
