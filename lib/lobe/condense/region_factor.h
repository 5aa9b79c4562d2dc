// What the sparse factor of a pre-computed region is made of: the stiffness of its tetrahedra at one moment,
// without the rest of the body.
#pragma once

#include "lobe/condense/condensing_log.h"
#include "lobe/condense/linearisation.h"
#include "lobe/fem/elements.h"
#include "lobe/numerics/sparse_factor.h"

namespace lobe {

// The role of a displacement component of a vertex of the region.
enum class Role : std::uint8_t {
  none,      // outside of the region, or fixed
  interior,  // quasi-static, follows the interface
  interface  // moves by itself: shared with other regions, or grasped
};
using Roles = Eigen::Matrix<Role, 3, Eigen::Dynamic>;              // 3 × #vertices
using ComponentNumbers = Eigen::Matrix<Index, 3, Eigen::Dynamic>;  // 3 × #vertices, −1: none

// K̂ = K + springs, K the stiffness of the region's tetrahedra on all components with a role, and a spring on
// each vertex whose components are all interface or fixed. The springs hold K̂ if nothing else holds the
// region. They are as stiff as the region. Condensing removes them again.
struct RegionFactor {
  RegionFactor(const Elements& elements, const Roles& roles, const Linearisation& linearisation = {});
  std::unique_ptr<SparseFactor> factorise(const SparseFactorMaker& make_factor, CondensingLog& log) const;

  ComponentNumbers number;      // rows of K̂
  std::vector<double> springs;  // stiffness of the spring of each row [N/m]
  double mean_stiffness = 0;    // mean of K's diagonal [N/m]
  Index size = 0;               // rows of K̂
  SparseFactor::Matrix K;       // K̂, its lower triangle
};

// Lumped masses of the components of the interior, 0 for others: 3 × #vertices [kg].
Eigen::VectorXd interior_masses(const Elements& elements, const Roles& roles);
// Components of the interface whose vertices belong to tetrahedra of other regions as well.
std::vector<Index> shared_components(const Elements& elements, const Roles& roles);

}  // namespace lobe
