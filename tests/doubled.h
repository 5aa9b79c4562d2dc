// Bodies whose tetrahedra are there twice, as a blade leaves them.
#pragma once

#include <random>

#include "support.h"

namespace lobe::test {

// Each tetrahedron twice on the same vertices, of a random share of its volume and the rest.
inline Setup doubled(Setup setup) {
  const Index count = setup.mesh.tet_count();
  const Tets tets = setup.mesh.tets;
  setup.mesh.tets.resize(4, 2 * count);
  setup.mesh.tets << tets, tets;
  setup.mesh.labels.resize(std::size_t(2 * count), 0);
  if (setup.mesh.fibres.cols() > 0) {
    const Mat3X<double> fibres = setup.mesh.fibres;
    setup.mesh.fibres.resize(3, 2 * count);
    setup.mesh.fibres << fibres, fibres;
  }
  setup.material_of.insert(setup.material_of.end(), setup.material_of.begin(), setup.material_of.end());
  setup.region_of.insert(setup.region_of.end(), setup.region_of.begin(), setup.region_of.end());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.01, 0.99);
  for (Index t = 0; t < count; ++t) setup.shares.push_back(share(random));
  for (Index t = 0; t < count; ++t) setup.shares.push_back(1 - setup.shares[std::size_t(t)]);
  return setup;
}

}  // namespace lobe::test
