// Keys of a scene itself (docs/scene.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/boundary_keys.h"
#include "lobe/scene/contact_keys.h"
#include "lobe/scene/region_keys.h"
#include "lobe/scene/selector_keys.h"
#include "lobe/scene/time_keys.h"

namespace lobe::keys {

template <>
inline constexpr std::array words_of<LoosePieces>{"fall", "vanish", "stay"};

template <>
struct Form<Material> {
  static constexpr const char* schema = R"({"$ref": "#/definitions/material"})";
  static void read(const nlohmann::json& given, Material& material, const std::string& place);
  static nlohmann::ordered_json write(const Material& material);
};
template <>
struct Form<Tool> {
  static constexpr const char* schema = R"({"$ref": "#/definitions/tool"})";
  static void read(const nlohmann::json& given, Tool& tool, const std::string& place);
  static nlohmann::ordered_json write(const Tool& tool);
};

inline constexpr auto has_one_mesh = [](const Scene& scene) { return scene.bodies.empty(); };

template <class Force>
constexpr auto key_of(std::vector<Force> SceneForces::*all) {
  return Key(Force::key, all, any, Force::sentence);
}

inline constexpr auto scene_keys = Table(
    "", "",

    Key("name", &Scene::name, any, "what the scene is called in reports"),
    Key("mesh", When(&Scene::mesh, has_one_mesh), any.items(1).optional(),
        "file of the tetrahedral mesh, relative to the scene file"),
    Key("mesh_scale", When(&Scene::mesh_scale, has_one_mesh), above(0),
        "what the coordinates of the mesh are multiplied by to be in metres: 0.001 for a mesh in "
        "millimetres"),
    Key("bodies", &Scene::bodies,
        any.optional().as(
            R"({"type": "array", "minItems": 1, "maxItems": 255, "items": {"$ref": "#/definitions/body"}})",
            ""),
        "several organs, in place of `mesh`: each has a mesh of its own. They move in one world, and touch "
        "each other with `contact.self`"),
    Key("materials", &Scene::materials,
        any.required().as(R"({"type": "array", "minItems": 1, "maxItems": 65535,
                              "items": {"$ref": "#/definitions/material"}})",
                          ""),
        "what it is made of: the first entry whose `where` selects a tetrahedron gives its material; the "
        "first entry without `where` is the default"),
    Key("volume_penalty", &Scene::volume_penalty, at_least(0).in("Pa"),
        "κ of the energy that resists change of volume and inversion; 0 switches it off"),
    Key("guard_below", &Scene::guard_below, at_least(0).below(1),
        "share of its volume below which a non-linear tetrahedron resists collapse and inversion; 0 switches "
        "the guard off"),
    Key("regions", &Scene::regions,
        any.as(
            R"({"type": ["array", "object"], "items": {"$ref": "#/definitions/region"},
                   "properties": {"auto": {"$ref": "#/definitions/auto_regions"}}, "required": ["auto"],
                   "additionalProperties": false})",
            "list, or `{\"auto\": {…}}`"),
        "which model computes which tetrahedra: the first matching entry wins; where none matches, "
        "nonlinear"),
    Key("boundary", &Scene::boundary, any, "what is held, and what is loaded"),
    Key("gravity", &Scene::gravity, any.in("m/s²"), "body force per mass"),
    Key("tools", &Scene::tools, any, "instruments that act while the scene runs"),
    std::apply([](auto... all) { return Table("", "", key_of(all)...); }, SceneForces::fields),
    Key("contact", &Scene::contact, any.derived(),
        "how the body touches itself and what stands around it. Probes touch it in any case"),
    Key("loose_pieces", &Scene::loose_pieces, any,
        "what pieces do that a cut has separated from everything held: move on freely, be removed, or be "
        "frozen where they are"),
    Key("skin", &Scene::skin, any,
        "OBJ file, relative to the scene file, of a finer surface that the tetrahedra carry, for `lobe view` "
        "to show; empty: none"),
    Key("time", &Scene::time, any.derived(), "time integration"),
    Key("output", &Scene::output, any.derived(), "what is written while the scene runs"));

}  // namespace lobe::keys
