#include "stress/random_setup.h"

#include <algorithm>

#include "lobe/mesh/generators.h"
#include "lobe/mesh/tet_mesh.h"
#include "lobe/setup/check_setup.h"

namespace lobe::test {
namespace {

TetMesh random_mesh(Dice& dice, int cells) {
  TetMesh mesh = box_mesh(Vec3d::Constant(cells * cell), cells, cells, cells);
  if (dice.says(0.7))
    for (double& x : mesh.points.reshaped()) x += dice.between(-0.15, 0.15) * cell;
  prepare(mesh, "random");
  return mesh;
}

void choose_materials(Dice& dice, Setup& setup) {
  setup.materials = {Elastic{4e4, 1e4, 1000}, Elastic{7e4, 2e4, 1100}};
  const double pressure = dice.says(0.25) ? (dice.says(0.5) ? 1 : 0.6) : 0;
  const bool is_neo_hookean = dice.says(0.15), is_smoothed = dice.says(0.35);
  for (Elastic& material : setup.materials) {
    material.nodal_pressure = pressure;
    if (is_neo_hookean) material.law = MaterialLaw::neo_hookean;
    if (is_smoothed && dice.says(0.8)) material.element = ElementType::edge_smoothed;
    if (dice.says(0.3)) material.fracture_energy = 10;
  }
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) setup.material_of.push_back(t % 3 == 0);
  if (!dice.says(0.2)) return;
  setup.materials[0].fibre = {1e4, 1e4, 2e4};
  setup.mesh.fibres = Vec3d(1, 0.2, 0).normalized().replicate(1, setup.mesh.tet_count());
}

RegionModel random_model(Dice& dice) { return RegionModel(dice.below(Index(region_model_names.size()))); }

void choose_regions(Dice& dice, double size, Setup& setup) {
  const RegionModel left = random_model(dice),
                    right = dice.says(0.4) ? RegionModel::nonlinear : random_model(dice);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    setup.region_of.push_back(barycentre(setup.mesh, t).x() < size / 2 ? left : right);
  if (dice.says(0.3)) setup.precomputed_frame = RegionFrame::corotated;
  dice.says(0.15);  // an option that is gone; with its draw a seed has the body that it had
  if (dice.says(0.4)) setup.volume_penalty = 1e5;
  if (dice.says(0.4)) setup.guard_below = 0.2;
  setup.expandable = dice.says(0.5);
}

void choose_boundary(Dice& dice, Setup& setup) {
  const bool is_held = dice.says(0.85);
  for (Index v = 0; v < setup.mesh.vertex_count() && is_held; ++v)
    if (setup.mesh.points(0, v) < 0.3 * cell)
      setup.prescribed.push_back({v, Vec3d::Zero(), dice.says(0.95) ? all_axes : Axes{true, false, true}});
  if (dice.says(0.3)) setup.gravity = {0, 0, -9.81};
  if (dice.says(0.2)) {
    setup.vertex_loads.push_back({dice.below(setup.mesh.vertex_count()), {0, 0, dice.between(-0.2, 0.2)}});
    setup.load_ramp = 0.05;
  }
  setup.contact.self = dice.says(0.3);
  if (dice.says(0.2)) {
    ObstacleSetup floor;
    floor.name = "floor";
    floor.shape = RigidShape::plane();
    floor.position = {0, 0, -0.002};
    setup.contact.obstacles.push_back(floor);
  }
}

void choose_motion(Dice& dice, Setup& setup) {
  setup.loose_pieces = LoosePieces(dice.among(0, 2));
  setup.damping = dice.says(0.2) ? 0 : dice.between(1, 30);
  if (dice.says(0.2)) setup.cut_step = dice.says(0.5) ? 0 : 0.9;
  if (dice.says(0.15)) setup.safety = 0.7;
  if (dice.says(0.25)) setup.selective_mass = dice.among(2, 16);
  if (dice.says(0.2)) setup.sleep = 2e-4;
  if (dice.says(0.05)) setup.integrator = Integrator::generalised_alpha;
}

// The dice are a copy, so that a seed has the rest of its body as before.
void choose_viscosity(Dice dice, Setup& setup) {
  const auto may_be_viscous = [](RegionModel model) {
    return model == RegionModel::nonlinear || model == RegionModel::corotational;
  };
  if (!std::all_of(setup.region_of.begin(), setup.region_of.end(), may_be_viscous) || dice.says(0.4)) return;
  setup.materials[0].viscosity = {PronyTerm{0.3, 0, 0.005}, PronyTerm{0.2, 0, 0.1}};
  if (dice.says(0.5))
    setup.materials[1].viscosity = {PronyTerm{0.5, setup.materials[1].nodal_pressure > 0 ? 0 : 0.2, 0.02}};
}

}  // namespace

RandomSetup random_setup(Dice& dice) {
  const int cells = dice.says(0.85) ? 3 : 5;
  RandomSetup found{{}, cells * cell};
  found.setup.mesh = random_mesh(dice, cells);
  choose_materials(dice, found.setup);
  choose_regions(dice, found.size, found.setup);
  choose_boundary(dice, found.setup);
  choose_motion(dice, found.setup);
  choose_viscosity(dice, found.setup);
  return found;
}

}  // namespace lobe::test
