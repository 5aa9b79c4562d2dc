#include "lobe/lattice/zone_mass.h"

#include <algorithm>
#include <numeric>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {

double ZoneMass::stiffness_of(const Elements& elements, Index v) {
  Mat3<double> K = Mat3<double>::Zero();
  for (Index t : elements.topology.around(v)) {
    const Eigen::Vector4i corners = elements.topology.corners(t);
    const Shape shape = elements.shape_of(t);
    for (int c = 0; c < 4; ++c)
      if (corners[c] == v)
        K += shape.volume * law_diagonal_block<double>(nonlinear_law(elements, t), Mat3<double>::Zero(),
                                                       shape.gradients.col(c));
  }
  return largest_eigenvalue(K);
}

void ZoneMass::raise(const Embedding& embedding, double omega, const std::vector<Index>& vertices,
                     std::vector<double>& mass) {
  added_.resize(mass.size(), 0);
  for (Index v : vertices) {
    double& own = mass[std::size_t(v)];
    const bool gains = !embedding.vertices.empty() && !embedding.embeds(v) && own > 0;
    if (!gains && asked(v) > 0) ask(v, 0);
    const double raised = gains ? std::max({own, asked(v), least(v, omega)}) : own;
    added_[std::size_t(v)] = raised - own;
    own = raised;
  }
}

double ZoneMass::sum() const { return std::accumulate(added_.begin(), added_.end(), 0.0); }

}  // namespace lobe
