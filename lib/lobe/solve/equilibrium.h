// Finds the equilibrium of a body under growing loads, whatever its elements are (static_solver.h).
#pragma once

#include "lobe/solve/discretisation.h"
#include "lobe/solve/static_solver.h"

namespace lobe {

// Which displacements are unknown, and what loads and holds the nodes.
struct StaticEquations {
  Unknowns unknowns;
  Mat3X<double> prescribed;        // displacements where they are given, 3 × #nodes, at full load [m]
  Mat3X<double> loads;             // 3 × #nodes, at full load [N]
  Mat3X<double> stiffness{};       // stiffness of springs to places, 3 × #nodes [N/m]; or no column
  Mat3X<double> spring_targets{};  // displacements of these places, 3 × #nodes, at full load [m]
};

StaticResult find_equilibrium(const StaticEquations& equations, Discretisation& body,
                              const StaticOptions& options);

}  // namespace lobe
