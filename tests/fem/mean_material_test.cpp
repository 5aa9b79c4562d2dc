#include "lobe/fem/mean_material.h"

#include <doctest/doctest.h>

#include <cmath>

#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Every fourth tetrahedron is of a stiffer material, which has fibres along y or is neo-Hookean.
Setup mixed(MaterialLaw law) {
  Setup setup = setup_of(irregular_box(3));
  Elastic other = seed_material;
  other.lambda = 1e5;
  other.mu = 3e4;
  other.law = law;
  if (law == MaterialLaw::svk) other.fibre = {.coupling = 1e3, .shear = 2e3, .stretch = 5e4};
  setup.materials = {seed_material, other};
  setup.mesh.fibres = Vec3d::UnitY().replicate(1, setup.mesh.tet_count());
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) setup.material_of[std::size_t(t)] = t % 4 == 0 ? 1 : 0;
  return setup;
}

}  // namespace

TEST_CASE("a mean material has the means over the volume, and the law of most of it") {
  for (MaterialLaw law : {MaterialLaw::svk, MaterialLaw::neo_hookean}) {
    const Setup setup = mixed(law);
    const Elements elements(setup);
    std::vector<Index> some, others;  // half of each kind, and only the other kind
    double volume = 0, share = 0;
    for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
      if (t % 4 == 0) others.push_back(t);
      if (t % 8 > 1) continue;
      some.push_back(t);
      volume += elements.shape_of(t).volume;
      if (t % 4 == 0) share += elements.shape_of(t).volume;
    }
    share /= volume;
    const MeanMaterial mean = mean_material(elements, some);
    CHECK(mean.volume == near(volume, 1e-12));
    CHECK(mean.material.lambda == near((1 - share) * seed_material.lambda + share * 1e5, 1e-12));
    CHECK(mean.material.mu == near((1 - share) * seed_material.mu + share * 3e4, 1e-12));
    CHECK((mean.material.law == MaterialLaw::neo_hookean) ==
          (law == MaterialLaw::neo_hookean && share > 0.5));
    CHECK(mean_material(elements, others).material.law == law);
    if (law == MaterialLaw::svk) {
      CHECK(mean.material.fibre.stretch == near(share * 5e4, 1e-12));
      CHECK(mean.material.fibre.coupling == near(share * 1e3, 1e-12));
      CHECK(std::abs(mean.direction.y()) == near(1, 1e-12));
    } else {
      CHECK(mean.direction.norm() == 0);
    }
  }
}

TEST_CASE("nothing has the volume 0") {
  const Setup setup = mixed(MaterialLaw::svk);
  CHECK(mean_material(Elements(setup), {}).volume == 0);
}
