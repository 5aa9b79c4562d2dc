// Divides a body into zones of about equal size. A zone is linear or non-linear as a whole.
#pragma once

#include <vector>

#include "lobe/fem/elements.h"

namespace lobe {

struct Zones {
  // Divides by METIS, so that zones share few faces, or by halving. `count` 1 … #tetrahedra; at the most each
  // is a zone of its own.
  Zones(const Elements& elements, Index count);

  Index count() const { return static_cast<Index>(tets.size()); }
  // Gives copies of tetrahedra that a blade has cut to the zones of their originals. Call it where there are
  // others than before. O(#tetrahedra).
  void follow_copies(const Topology& topology);
  double norm(const Eigen::VectorXd& u) const;  // √∫|u|² of displacements of zones [m^2.5], 3 × #zones

  std::vector<Index> of;                 // zone of each tetrahedron
  std::vector<std::vector<Index>> tets;  // tetrahedra of each zone, none of them empty
  std::vector<double> volume;            // volume of each zone [m³]
};

// Returns as many as are fine enough to choose from, and few enough to be watched at every frame.
Index usual_zone_count(Index tets);

}  // namespace lobe
