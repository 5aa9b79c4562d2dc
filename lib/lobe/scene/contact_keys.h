// Keys of `contact` (docs/scene/tools.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/key_table.h"
#include "lobe/scene/read_shape.h"

namespace lobe::keys {

template <>
struct Form<RigidShape> {
  static constexpr const char *schema = R"({"$ref": "#/definitions/shape"})", *type = "shape";
  static void read(const nlohmann::json& given, RigidShape& shape) { shape = read_shape(given); }
  static nlohmann::ordered_json write(const RigidShape& shape) { return write_shape(shape, {}); }
};

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
