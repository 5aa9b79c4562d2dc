// Divides a body into zones of about equal size. A zone is linear or non-linear as a whole.
#pragma once

#include <vector>

#include "lobe/fem/elements.h"

namespace lobe {

struct Zones {
  // By METIS, so that zones share few faces, or by halving. `count` 1 … #tetrahedra, and then each is a zone
  // of its own.
  Zones(const Elements& elements, Index count);

  Index count() const { return static_cast<Index>(tets.size()); }
  // Copies of tetrahedra that a blade has cut are in the zones of what they are copies of. Call it where
  // there are others than before. O(#tetrahedra).
  void follow_copies(const Topology& topology);
  double norm(const Eigen::VectorXd& u) const;  // √∫|u|² of a displacement per zone [m^2.5], 3 × #zones

  std::vector<Index> of;                 // per tetrahedron
  std::vector<std::vector<Index>> tets;  // per zone, none of them empty
  std::vector<double> volume;            // per zone [m³]
};

// As many as are fine enough to choose from, and few enough to be watched at every frame.
Index usual_zone_count(Index tets);

}  // namespace lobe
