// The numbers of a scene that can be fitted to measurements.
#pragma once

#include <string>
#include <vector>

#include "lobe/scene/scene.h"

namespace lobe {

// How a parameter is searched: on a scale on which steps and errors mean the same everywhere, and which it
// cannot leave.
enum class ParameterScale : std::uint8_t {
  logarithmic,  // ln p: positive
  below_half,   // ln(½ − p): Poisson's ratio
  share,        // ln(p / (1 − p)): between 0 and 1
  linear        // p / unit
};

struct Parameter {
  enum class Of : std::uint8_t { material, attachment, body };

  std::string name;  // "liver.young_modulus"
  Of of = Of::material;
  std::size_t number = 0;  // number of the material or attachment, in the scene and in the setup
  std::size_t row = 0;     // row in the table of kinds of material parameters in parameters.cpp
  double start = 0;        // value in the scene
  double unit = 1;         // unit of a linear scale
  ParameterScale scale = ParameterScale::logarithmic;
  bool in_motion = false;  // whether it changes motions alone, and no equilibrium
  Elastic at_start{};      // its material in the scene, which a factor of the stiffness is relative to

  double on_scale(double value) const;
  double from_scale(double x) const;
};

// Finds the parameters of a scene by their names. Of a material: young_modulus [Pa], poisson_ratio, density
// [kg/m³], stiffness (a factor of all moduli), the further moduli of its law, as yeoh_c2 [Pa], and
// prony_shear_1, prony_bulk_1, prony_time_1 [s] and so on of its viscosity. "liver." before the name tells
// the material; it may be left out where there is one material. Of an attachment: attachments.NAME.stiffness
// [Pa/m] or [N/m]. Of the body: damping [1/s]. What is 0 in the scene is no parameter. Throws one InputError
// for all names that mean nothing in the scene; it lists those that do.
std::vector<Parameter> find_parameters(const Scene& scene, const std::vector<std::string>& names);

std::vector<Parameter> all_parameters(const Scene& scene);

double value_of(const Parameter& parameter, const Elastic& material);  // takes a parameter of a material
// Sets it in what the scene was resolved to, or in the scene. Poisson's ratio stays when Young's modulus is
// set, and the other way round. An attachment keeps its strength, or its fracture energy.
void set(const Parameter& parameter, double value, Elastic& material);  // takes a parameter of a material
void set(const Parameter& parameter, double value, Setup& setup);
void set(const Parameter& parameter, double value, Scene& scene);

}  // namespace lobe
