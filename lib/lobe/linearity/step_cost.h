// What a time step costs, measured on this machine.
#pragma once

#include "lobe/linearity/zones.h"
#include "lobe/setup/setup.h"

namespace lobe {

struct StepCost {
  double nonlinear = 0, tensor_mass = 0;  // [s] per tetrahedron, vertices included
  double shared = 0;                      // [s] per vertex that both share
  double dense = 0;                       // [s] per entry of the condensed stiffness

  // Returns the time of a step [s] of a body with so many of each, and so many displacement components on the
  // interface of its condensed region.
  double of(double nonlinear_tets, double tensor_mass_tets, double shared_vertices, double condensed) const {
    return nonlinear * nonlinear_tets + tensor_mass * tensor_mass_tets + shared * shared_vertices +
           dense * condensed * condensed;
  }
};

// The smallest time of one step of a world near rest [s], in the precision of the run. Several setups are
// measured in turn, so that other work of the machine disturbs all of them alike.
std::vector<double> step_seconds(const std::vector<Setup>& setups, bool in_double);
double step_seconds(const Setup& setup, bool in_double);

// Measures steps of the setup with every tetrahedron non-linear, with every one tensor-mass, and with every
// other zone so.
StepCost measure_step_cost(const Setup& setup, const Zones& zones, bool in_double);

}  // namespace lobe
