#include "fibre_support.h"
#include "golden/boxes.h"
#include "golden/golden.h"

namespace lobe::test {
namespace {

// The box of edge-smoothed tetrahedra, which is cut and burnt in each model that has them.
void add_smoothed(std::vector<GoldenRun>& runs) {
  add_golden(runs, "smoothed, tensor-mass half, blade", smoothed(box_with_blade(RegionModel::tensor_mass)),
             frames, frame, nothing);
  add_golden(runs, "smoothed, precomputed half, blade", smoothed(box_with_blade(RegionModel::precomputed)),
             frames, frame, nothing);
  add_golden(runs, "smoothed, corotational half, blade", smoothed(box_with_blade(RegionModel::corotational)),
             frames, frame, nothing);
  Setup setup = smoothed(averaged(box_with_blade(RegionModel::nonlinear)));
  add_golden(runs, "smoothed, nodal pressure, blade", setup, frames, frame, nothing);
  setup.selective_mass = 5;
  add_golden(runs, "smoothed, nodal pressure, selective masses", setup, frames, frame, nothing);
}

// The box with one law in both halves.
void add_law(std::vector<GoldenRun>& runs, const std::string& name, const Elastic& elastic) {
  Setup setup = box_with_blade(RegionModel::nonlinear);
  std::fill(setup.materials.begin(), setup.materials.end(), elastic);
  if (elastic.has_direction()) setup.mesh.fibres = fibrous_setup(setup.mesh).mesh.fibres;
  add_golden(runs, name, setup, frames, frame, nothing);
  add_golden(runs, name + ", smoothed", smoothed(setup), frames, frame, nothing);
}

void add_further_laws(std::vector<GoldenRun>& runs) {
  const TetMesh mesh = irregular_box(1);
  add_law(runs, "Yeoh", yeoh_setup(mesh).materials[0]);
  add_law(runs, "Mooney-Rivlin", mooney_rivlin_setup(mesh).materials[0]);
  add_law(runs, "Holzapfel", holzapfel_setup(mesh).materials[0]);
}

// The box of two materials that relax, one of them in volume too where nothing averages its pressure.
void add_viscous(std::vector<GoldenRun>& runs) {
  const auto relaxing = [](Setup setup, double bulk) {
    setup.materials[0].viscosity = {PronyTerm{0.3, bulk, 0.02}, PronyTerm{0.2, 0, 0.3}};
    setup.materials[1].viscosity = {PronyTerm{0.4, 0, 0.05}};
    return setup;
  };
  const Setup nonlinear = box_with_blade(RegionModel::nonlinear),
              corotational = box_with_blade(RegionModel::corotational);
  add_golden(runs, "viscous, blade", relaxing(nonlinear, 0.2), frames, frame, nothing);
  add_golden(runs, "viscous, corotational half, nodal pressure, blade", relaxing(averaged(corotational), 0),
             frames, frame, nothing);
  add_golden(runs, "viscous, smoothed, corotational half, blade", relaxing(smoothed(corotational), 0.2),
             frames, frame, nothing);
  add_golden(runs, "viscous, smoothed, nodal pressure, blade", relaxing(smoothed(averaged(nonlinear)), 0),
             frames, frame, nothing);
}

}  // namespace

std::vector<GoldenRun> element_scenes() {
  std::vector<GoldenRun> runs;
  add_smoothed(runs);
  add_further_laws(runs);
  add_viscous(runs);
  return runs;
}

}  // namespace lobe::test
