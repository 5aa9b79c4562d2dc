#include "lobe/time/mass_scaling.h"

#include <algorithm>
#include <numeric>

namespace lobe {

// With the k highest vertices raised, level = Σ m ω² / (Σ m + added); k grows until the next vertex is below
// it.
std::vector<double> mass_factors(const std::vector<double>& mass, const std::vector<double>& squares,
                                 double added) {
  std::vector<Index> order(mass.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return squares[a] > squares[b]; });
  double stiffness = 0, sum = added, level = 0;
  for (Index v : order) {
    if (squares[v] <= level) break;
    stiffness += mass[v] * squares[v];
    sum += mass[v];
    level = stiffness / sum;
  }
  std::vector<double> factors(mass.size(), 1);
  if (level > 0)
    for (std::size_t v = 0; v < mass.size(); ++v) factors[v] = std::max(1.0, squares[v] / level);
  return factors;
}

}  // namespace lobe
