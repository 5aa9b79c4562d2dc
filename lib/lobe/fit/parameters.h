// The numbers of a material that can be fitted to measurements.
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
  linear        // p / unit
};

struct Parameter {
  std::string name;          // "liver.young_modulus"
  std::size_t material = 0;  // its number in the scene and in the setup
  std::size_t row = 0;       // row in the table of kinds in parameters.cpp
  double start = 0;          // value in the scene
  double unit = 1;           // unit of a linear scale
  ParameterScale scale = ParameterScale::logarithmic;

  double on_scale(double value) const;
  double from_scale(double x) const;
};

// Finds the parameters of a scene by their names: young_modulus [Pa], poisson_ratio, density [kg/m³],
// stiffness (a factor of all moduli), and the further moduli of the material's law, as yeoh_c2 [Pa]. "liver."
// before the name tells the material; it may be left out where there is one material. Throws one InputError
// for all names that mean nothing in the scene; it lists those that do.
std::vector<Parameter> find_parameters(const Scene& scene, const std::vector<std::string>& names);

std::vector<Parameter> all_parameters(const Scene& scene);

double value_of(const Parameter& parameter, const Elastic& material, const Elastic& at_start);
// Poisson's ratio stays when Young's modulus is set, and the other way round. `at_start` is what a factor of
// the stiffness is relative to.
void set(const Parameter& parameter, double value, const Elastic& at_start, Elastic& material);
void set(const Parameter& parameter, double value, Material& material);

}  // namespace lobe
