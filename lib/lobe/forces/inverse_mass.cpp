#include "lobe/forces/inverse_mass.h"

namespace lobe {

void set_inverse_mass(const BodyView& body, Mat3X<double>& inverse_mass) {
  inverse_mass.resize(3, Eigen::Index(body.mass.size()));
  for (std::size_t v = 0; v < body.mass.size(); ++v)
    inverse_mass.col(Eigen::Index(v)).setConstant(body.mass[v] > 0 ? 1 / body.mass[v] : 0);
  for (const HeldVertices::Held& item : body.model.held.all())
    for (int i = 0; i < 3; ++i)
      if (item.axes[i]) inverse_mass(i, item.vertex) = 0;
}

}  // namespace lobe
