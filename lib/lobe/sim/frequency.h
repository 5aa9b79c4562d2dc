// The highest frequency of a model, which limits the explicit time step to 2/ω_max.
#pragma once

#include <vector>

#include "lobe/region/elements.h"

namespace lobe {

// The vertex estimate, ω² ≈ max over free vertices of λ_max(K_ii)/m_i: what a vertex feels when it moves
// alone. A lower bound of ω_max (a Rayleigh quotient); on organ meshes within 10 % of it, on irregular boxes within 25 % (tests). O(#vertices).
struct VertexFrequency {
  double omega = 0;  // [rad/s], 0 if nothing is free
  Index vertex = -1;
};
VertexFrequency vertex_frequency(const DiagonalStiffness& K,                // 6 × #vertices [N/m]
                                 const std::vector<double>& inverse_mass);  // [1/kg], 0 where held

// ω_max of the model at rest by Lanczos iterations of M^-½ K M^-½, started at the vertex estimate's vertex; a
// lower bound that converges fast, since the highest mode is local. Costs one linear force evaluation per
// iteration.
double lanczos_frequency(const Elements& elements, const std::vector<double>& inverse_mass,
                         int iterations = 30);

// 2/ω_max [s] of a free mesh of one material: what `lobe info` and `lobe-mesh` print.
double rest_time_step(const TetMesh& mesh, const Elastic& elastic);

}  // namespace lobe
