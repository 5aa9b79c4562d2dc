// Keys of `contact` (docs/scene/tools.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/key_table.h"

namespace lobe::keys {

template <>
struct Form<Eigen::Vector3i> {
  static constexpr const char* schema =
      R"({"type": "array", "minItems": 3, "maxItems": 3, "items": {"$ref": "#/definitions/index"}})";
  static void read(const nlohmann::json& given, Eigen::Vector3i& value) {
    for (int i = 0; i < 3; ++i) given[std::size_t(i)].get_to(value[i]);
  }
  static nlohmann::ordered_json write(const Eigen::Vector3i& value) { return {value[0], value[1], value[2]}; }
};

inline constexpr Takes edges = any.in("m").required().as(
    R"({"type": "array", "minItems": 3, "maxItems": 3, "items": {"type": "number", "exclusiveMinimum": 0}})",
    "[x, y, z]");

template <>
inline constexpr auto table_of<RigidShape> = Table(
    "shape", R"({"minProperties": 1, "maxProperties": 1, "description":
                 "Shape of a rigid body. Its origin is the body's position."})",
    Key("sphere",
        Inner(&RigidShape::kind, RigidShape::Kind::sphere,
              Table("", "", Key("radius", &RigidShape::radius, above(0).in("m").required(), ""))),
        any.optional(), "about the origin"),
    Key("capsule",
        Inner(&RigidShape::kind, RigidShape::Kind::capsule,
              Table("", "", Key("radius", &RigidShape::radius, above(0).in("m").required(), ""),
                    Key("length", &RigidShape::length, at_least(0).in("m").required(),
                        "length of its axis, from the origin along z"))),
        any.optional(), "a shaft with a round tip about the origin"),
    Key("box",
        Inner(&RigidShape::kind, RigidShape::Kind::box,
              Table("", "", Key("size", &RigidShape::size, edges, "its edges"))),
        any.optional(), "about the origin"),
    Key("plane", Inner(&RigidShape::kind, RigidShape::Kind::plane, Table("", "")), any.optional(),
        "all that is below z = 0: a table"),
    Key("jaws",
        Inner(&RigidShape::kind, RigidShape::Kind::jaws,
              Table("", "",
                    Key("size", &RigidShape::size, edges,
                        "width along x, thickness along y and length along z of each"))),
        any.optional(),
        "two boxes that start at the origin, one above and one below the plane y = 0, and open in parallel"),
    Key("mesh",
        Inner(&RigidShape::kind, RigidShape::Kind::mesh,
              Table("", R"({"dependencies": {"points": ["triangles"], "triangles": ["points"]},
                            "oneOf": [{"required": ["file"]}, {"required": ["points"]}]})",
                    Key("file", NotKept<std::filesystem::path>{}, any.items(1).optional(),
                        "OBJ or VTP, in metres, relative to the scene file"),
                    Key("points", &RigidShape::points, any.in("m").items(4).optional(), "vertices"),
                    Key("triangles", &RigidShape::triangles, any.items(4).optional(),
                        "counter-clockwise seen from outside"))),
        any.optional(), "a closed triangle mesh"));

template <>
inline constexpr auto table_of<ObstacleSetup> = Table(
    "obstacle", "", Key("name", &ObstacleSetup::name, any, "for reports"),
    Key("shape", &ObstacleSetup::shape, any.required(), "what the organ touches"),
    Key("position", &ObstacleSetup::position, any.in("m"), "place of the origin of its shape"),
    Key("orientation", &ObstacleSetup::orientation, any, "unit quaternion x, y, z, w"),
    Key("friction", &ObstacleSetup::friction, at_least(0), "coefficient of Coulomb's law against tissue"));

template <>
inline constexpr auto table_of<ContactSetup> =
    Table("contact", "",
          Key("self", &ContactSetup::self, any,
              "contact of the body with itself: lips of cuts, pieces that fall, parts of the mesh that are "
              "not connected, bodies"),
          Key("friction", &ContactSetup::friction, at_least(0),
              "coefficient of Coulomb's law of tissue against tissue"),
          Key("damping", &ContactSetup::damping, at_least(0).up_to(0.2),
              "damping of the normal speed of all contact, as a share of the critical damping at the highest "
              "frequency of the body"),
          Key("obstacles", &ContactSetup::obstacles, any, "rigid bodies that do not move"));

}  // namespace lobe::keys
