// Keys of `materials` (docs/scene/materials.md). Internal, not part of the public interface.
#pragma once

#include "lobe/scene/key_table.h"

namespace lobe::keys {

template <>
inline constexpr auto words_of<MaterialLaw> = [] {
  std::array<const char*, law_count> names{};
  for (int law = 0; law < law_count; ++law) names[std::size_t(law)] = law_rows[law].name;
  return names;
}();
template <>
inline constexpr std::array words_of<ElementType>{"tetrahedron", "edge-smoothed"};
template <>
inline constexpr std::array words_of<FibreArray>{"fibre"};

// ---- Fibres

template <>
inline constexpr auto table_of<FibreHarmonic> =
    Table("", "", Key("from", &FibreHarmonic::from, any.required(), "vertices where they begin"),
          Key("to", &FibreHarmonic::to, any.required(), "vertices where they end"));

template <>
inline constexpr auto table_of<FibreAround> =
    Table("", "", Key("point", &FibreAround::point, any.in("m").required(), "a point of the axis"),
          Key("direction", &FibreAround::axis, any.required(), "its direction, of any length but 0"));

template <>
inline constexpr auto table_of<FibreField> =
    Table("fibre", R"({"minProperties": 1, "maxProperties": 1, "description":
                       "Which way the fibres run, at rest."})",
          Key("direction", alternative(std::identity{}, &FibreDirection::direction), any.optional(),
              "the same everywhere"),
          Key("array", alternative<FibreArray>(std::identity{}), any.optional(),
              "a cell array of three components of the mesh file (VTU)"),
          Key("harmonic", alternative<FibreHarmonic>(std::identity{}), any.optional(),
              "along the gradient of the harmonic function between two sets of vertices"),
          Key("axis", alternative<FibreAround>(std::identity{}), any.optional(),
              "fibres in circles around an axis: vessels, sphincters"));

// ---- Materials

inline constexpr auto is_isotropic = [](const Material& material) { return !material.transverse; };
inline constexpr auto has_fibre_families = [](const Material& material) {
  return has_families(material.law);
};
// A constant of a material with fibres.
struct Transverse {
  double TransverseConstants::*member;
  double& operator()(Material& material) const {
    if (!material.transverse) material.transverse.emplace();
    return (*material.transverse).*member;
  }
  const double* operator()(const Material& material) const {
    return material.transverse ? &((*material.transverse).*member) : nullptr;
  }
};
// A constant of one law.
struct OfLaw {
  MaterialLaw law;
  std::size_t number;
  double& operator()(Material& material) const { return material.further[number]; }
  const double* operator()(const Material& material) const {
    return material.law == law ? &material.further[number] : nullptr;
  }
};
template <>
struct Form<std::array<double, 3>> {
  static constexpr const char *schema = R"({"$ref": "#/definitions/vector"})", *type = "[x, y, z]";
  static void read(const nlohmann::json& given, std::array<double, 3>& value) { given.get_to(value); }
  static nlohmann::ordered_json write(const std::array<double, 3>& value) { return value; }
};

// Terms of a Prony series: the first ones of the array, of which the others have no time.
template <>
inline constexpr auto table_of<PronyTerm> =
    Table("prony_term", R"({"anyOf": [{"required": ["shear"]}, {"required": ["bulk"]}]})",
          Key("shear", &PronyTerm::shear, at_least(0).below(1),
              "share of the shear modulus at once that relaxes; all of them sum to less than 1"),
          Key("bulk", &PronyTerm::bulk, at_least(0).below(1),
              "share of the bulk modulus at once that relaxes; all of them sum to less than 1. Not with "
              "`nodal_pressure`"),
          Key("time", &PronyTerm::time, above(0).in("s").required(), "relaxation time"));
template <>
struct Form<std::array<PronyTerm, most_prony_terms>> {
  static_assert(most_prony_terms == 3);  // as the schema says
  static constexpr const char* schema =
      R"({"type": "array", "minItems": 1, "maxItems": 3, "items": {"$ref": "#/definitions/prony_term"}})";
  static constexpr const char* type = "list of 1 to 3 objects";
  static void read(const nlohmann::json& given, std::array<PronyTerm, most_prony_terms>& terms) {
    for (std::size_t i = 0; i < given.size(); ++i) read_keys(given[i], terms[i], "");
  }
  static nlohmann::ordered_json write(const std::array<PronyTerm, most_prony_terms>& terms) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const PronyTerm& term : terms)
      if (term.time > 0) list.push_back(write_value(term));
    return list;
  }
};
inline constexpr auto relaxes = [](const Material& material) { return material.viscosity[0].time > 0; };

inline constexpr auto material_keys = Table(
    "material", "", Key("name", &Material::name, any, "for reports"),

    Key("young_modulus_along", Transverse{&TransverseConstants::young_along}, any.in("Pa").optional(),
        "E_L, along the fibre; with the four constants below in place of the isotropic ones"),
    Key("young_modulus_across", Transverse{&TransverseConstants::young_across}, any.in("Pa").optional(),
        "E_T, across it"),
    Key("poisson_ratio_along", Transverse{&TransverseConstants::poisson_along}, any.optional(),
        "ratio nu_LT: how much it shrinks across when stretched along; its square is below (1 - nu_TT) E_L / "
        "(2 "
        "E_T)"),
    Key("poisson_ratio_across", Transverse{&TransverseConstants::poisson_across}, any.optional(),
        "ratio nu_TT, within the plane across, above -1 and below 1"),
    Key("shear_modulus_along", Transverse{&TransverseConstants::shear_along}, any.in("Pa").optional(),
        "G_LT, of shear along the fibre"),
    Key("lame_lambda", When(&Material::lame_lambda, is_isotropic), any.in("Pa").optional(),
        "first Lame coefficient, above -2/3 of lame_mu"),
    Key("lame_mu", When(&Material::lame_mu, is_isotropic), above(0).in("Pa").optional(),
        "second Lame coefficient, the shear modulus"),

    Key("young_modulus", NotKept<double>{}, above(0).in("Pa").optional(),
        "Young's modulus, in place of both"),
    Key("poisson_ratio", NotKept<double>{}, above(-1).below(0.5).optional(),
        "Poisson's ratio, with it; linear tetrahedra lock above 0.45: see `nodal_pressure`"),

    Key("density", &Material::density, above(0).in("kg/m³"), "mass per volume at rest"),
    Key("fracture_energy", &Material::fracture_energy, at_least(0).in("J/m²"),
        "work of a scalpel per area that it opens, felt as a force on the tool"),
    Key("nodal_pressure", &Material::nodal_pressure, at_least(0).up_to(1).or_false().optional(),
        "share of lame_lambda whose pressure is averaged around vertices in nonlinear regions, against "
        "locking; `true` is 1. Default: 0; 1 in edge-smoothed materials of a Poisson's ratio above 0.45, "
        "where "
        "it goes with the rest of the scene"),
    Key("law", &Material::law, any,
        "law of nonlinear regions: St Venant-Kirchhoff's; that of a compressible neo-Hookean solid, which "
        "does not soften in compression; Yeoh's, which stiffens when stretched; Mooney and Rivlin's; or "
        "Holzapfel, Gasser and Ogden's, with two families of fibres"),
    Key("yeoh_c2", OfLaw{MaterialLaw::yeoh, 0}, any.optional(),
        "constant c2 of Yeoh's law [Pa], whose energy is mu/2 q + c2 q^2 + c3 q^3 with q = tr(F^T F) / "
        "J^(2/3) - 3; above -sqrt(1.5 c3 lame_mu). 0 if it is left out"),
    Key("yeoh_c3", OfLaw{MaterialLaw::yeoh, 1}, at_least(0).optional(),
        "constant c3 of Yeoh's law [Pa], the factor of q^3 in its energy. 0 if it is left out"),
    Key("mooney_c01", OfLaw{MaterialLaw::mooney_rivlin, 0}, at_least(0).optional(),
        "constant c01 of Mooney and Rivlin's law [Pa], the modulus of the second invariant, at most lame_mu "
        "/ 2; that of the first is lame_mu / 2 - c01. 0 if it is left out"),
    Key("holzapfel_k1", OfLaw{MaterialLaw::holzapfel, 0}, above(0).optional(),
        "constant k1 of Holzapfel's law [Pa]: a stretched fibre has the energy k1/(2 k2) (exp(k2 E^2) - 1), "
        "where E is its squared stretch less 1. The material needs \"fibre\""),
    Key("holzapfel_k2", OfLaw{MaterialLaw::holzapfel, 1}, at_least(0).optional(),
        "constant k2 of Holzapfel's law [-]: how fast its fibres stiffen. 0 if it is left out"),
    Key("holzapfel_angle", When(&Material::fibre_angle, has_fibre_families),
        at_least(0).up_to(90).in("degrees").optional(),
        "angle of both families of Holzapfel's law to the direction of `fibre`; 0 if it is left out"),
    Key("holzapfel_plane", When(&Material::fibre_plane, has_fibre_families), any.optional(),
        "a vector of the plane of both families, other than that direction; needed unless the angle is 0"),
    Key("viscosity", When(&Material::viscosity, relaxes), any.optional(),
        "terms of a Prony series, of nonlinear and corotational regions. The moduli of the material are "
        "those "
        "after long rest, with which `lobe solve` computes; at once it is stiffer by 1 / (1 - sum)"),
    Key("element", &Material::element, any.optional(),
        "tetrahedra each with its own strain, or with strains averaged around edges, which are far less "
        "stiff on the same mesh. Default: edge-smoothed; tetrahedron in a scene with reduced regions"),
    Key("fibre", &Material::fibre, any.optional(), "which way the fibres run"),
    Key("where", &Material::where, any.optional(), "which tetrahedra"));

}  // namespace lobe::keys
