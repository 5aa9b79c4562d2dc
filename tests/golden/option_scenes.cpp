#include "fibre_support.h"
#include "golden/boxes.h"
#include "golden/golden.h"
#include "joined_meshes.h"
#include "lattice/lattice_worlds.h"
#include "linearity/liver.h"
#include "lobe/linearity/mass_watch.h"
#include "lobe/linearity/watch.h"
#include "squeezed_bar.h"

namespace lobe::test {
namespace {

std::vector<Index> tets_around(const Setup& setup, const Vec3d& centre, double radius) {
  std::vector<Index> tets;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if ((barycentre(setup.mesh, t) - centre).norm() < radius) tets.push_back(t);
  return tets;
}

// What a setup may ask for, each with tools and a cut through both halves.
void add_options(std::vector<GoldenRun>& runs) {
  Setup setup = box_with_tools(RegionModel::tensor_mass);
  add_golden(runs, "tensor-mass half", setup, frames, frame, nothing);

  setup = box_with_tools(RegionModel::precomputed);
  add_golden(runs, "precomputed half", setup, frames, frame, nothing);
  setup.load_ramp = 0.2;
  setup.loose_pieces = LoosePieces::stay;
  add_golden(runs, "precomputed half, loads that grow, loose pieces stay", setup, frames, frame, nothing);
  setup.precomputed_frame = RegionFrame::corotated;
  add_golden(runs, "corotated half", setup, frames, frame, nothing);

  add_golden(runs, "nodal pressure", averaged(box_with_tools(RegionModel::nonlinear)), frames, frame,
             nothing);
  setup = squeezed_bar();
  add_golden(runs, "guard and a tangle that is unravelled", setup, frames, 0.2, nothing);
  setup.selective_mass = 5;
  add_golden(runs, "selective masses of a tangle", setup, frames, 0.2, nothing);
}

void add_sleep(std::vector<GoldenRun>& runs) {
  Setup setup = held_liver();
  setup.damping = 20;
  setup.sleep = 1e-4;
  setup.grasps.push_back({"grasp", left_lobe(setup), {{0.8, Vec3d::Zero()}, {0.9, {0, 0, 0.01}}}, true});
  setup.cauteries.push_back({"cautery", 0.008, {{1.1, {0.03, -0.06, 0.03}}, {1.2, {0.03, 0.0, 0.03}}}});
  const std::vector<Index> tets = tets_around(setup, {-0.03, 0, 0}, 0.02);
  add_golden(runs, "sleep", setup, 40, 0.04, [=](auto& world) {
    return [&world, tets](int i) {
      if (i == 35) world.apply(SetRegion{tets, RegionModel::tensor_mass});
    };
  });
}

void add_inertia(std::vector<GoldenRun>& runs) {
  Setup setup = box_with_tools(RegionModel::tensor_mass);
  setup.selective_mass = 9;
  add_golden(runs, "selective masses whose degree changes", setup, frames, frame, [](auto& world) {
    return [&world](int i) {
      if (i % 4 == 1) world.apply(SetMassDegree{i % 8 == 1 ? 3 : 9});
    };
  });
  setup = held_liver();
  setup.damping = 20;
  setup.selective_mass = 12;
  setup.grasps.push_back({"grasp", left_lobe(setup), {{0, Vec3d::Zero()}, {0.3, {0, 0, 0.03}}}, true});
  setup.cauteries.push_back({"cautery", 0.006, {{0.5, {0.03, -0.06, 0.03}}, {0.6, {0.03, 0.0, 0.03}}}});
  add_watched(runs, "selective masses that are watched", setup, 2 * frames, frame,
              []<class Real>(World<Real>& world) {
                return [watch = std::make_shared<MassWatch<Real>>(world, 0.02), &world](int) {
                  watch->look(world);
                };
              });
}

// Edits by hand of each region, and a precomputed one that is expanded, cut, linearised anew and condensed
// again.
void add_edits(std::vector<GoldenRun>& runs) {
  Setup setup = box_of(RegionModel::precomputed);
  setup.expandable = true;
  const std::vector<Index> some = tets_around(setup, {0.02, 0.03, 0.02}, 0.012),
                           others = tets_around(setup, {0.04, 0.01, 0.02}, 0.012);
  const auto edit = [=](auto& world) {
    return [&world, some, others](int i) {
      if (i == 2) world.apply(Expand{});
      if (i == 4) world.apply(Condense{});
      if (i == 5) world.remove_tets({some.begin(), some.begin() + 3});
      if (i == 7) world.apply(Expand{});
      if (i == 8) world.remove_tets({some.begin() + 3, some.begin() + 5});
      if (i == 9) world.apply(Relinearise{0.03});
      if (i == 13 && world.body().regions.can_condense()) world.apply(Condense{});
      if (i == 15) world.apply(SetRegion{others, RegionModel::tensor_mass});
      if (i == 17) world.apply(SetRegion{others, RegionModel::nonlinear});
      if (i == 18) world.remove_tets(others);
    };
  };
  add_golden(runs, "edits", setup, frames, frame, edit);
  setup.selective_mass = 5;
  add_golden(runs, "edits with selective masses", setup, frames, frame, edit);

  setup = held_liver(RegionModel::tensor_mass);
  setup.damping = 20;
  setup.grasps.push_back({"grasp", left_lobe(setup), {{0, Vec3d::Zero()}, {0.4, {0, 0, 0.05}}}, true});
  add_watched(
      runs, "tensor-mass zones that are corrected", setup, 2 * frames, frame,
      [grasps = std::vector<std::vector<Index>>{setup.grasps[0].vertices}]<class Real>(World<Real>& world) {
        return [watch = std::make_shared<LinearityWatch<Real>>(world, grasps, LinearityOptions{0.02, true}),
                &world](int) { watch->look(world); };
      });
}

void add_implicit_run(std::vector<GoldenRun>& runs, const std::string& name, Setup setup) {
  setup.integrator = Integrator::generalised_alpha;
  setup.implicit_step = 0.01;
  runs.push_back(golden_run<double>(name, setup, frames, frame, nothing));
}

void add_implicit(std::vector<GoldenRun>& runs) {
  add_implicit_run(runs, "implicit", box_with_tools(RegionModel::tensor_mass));
}

void add_blades(std::vector<GoldenRun>& runs) {
  Setup setup = box_with_blade(RegionModel::tensor_mass);
  add_golden(runs, "blade through a tensor-mass half", setup, frames, frame, nothing);
  add_implicit_run(runs, "blade, implicit", setup);
  setup.selective_mass = 5;
  add_golden(runs, "blade, selective masses", setup, frames, frame, nothing);
  setup.scalpels[0].along_faces = true;
  add_golden(runs, "blade along faces, selective masses", setup, frames, frame, nothing);
  setup = box_with_blade(RegionModel::precomputed);
  add_golden(runs, "blade through a precomputed half", setup, frames, frame, nothing);
  setup.expandable = true;
  add_golden(runs, "blade through a precomputed half that is expanded", setup, frames, frame, nothing);
  setup = averaged(box_with_blade(RegionModel::nonlinear));
  add_golden(runs, "blade, nodal pressure", setup, frames, frame, nothing);
  setup = box_with_blade(RegionModel::precomputed);
  setup.precomputed_frame = RegionFrame::corotated;
  add_golden(runs, "blade through a corotated half", setup, frames, frame, nothing);
}

// A precomputed half whose linearisation changes while it is pulled and cut; one that is expanded while a
// ball presses on its interior, and condensed again once nothing has touched it for a while.
void add_condensing(std::vector<GoldenRun>& runs) {
  Setup setup = box_with_tools(RegionModel::precomputed);
  add_golden(runs, "precomputed half that is relinearised", setup, frames, frame, [](auto& world) {
    return [&world](int i) {
      if (i == 6) world.apply(Relinearise{0.05});
    };
  });
  setup = box_of(RegionModel::precomputed);
  setup.expandable = true;
  const double radius = 0.01, above = 0.05 + radius;
  setup.probes.push_back({"probe",
                          RigidShape::sphere(radius),
                          0.2,
                          {{0.0, {0.015, 0.025, above + 0.01}},
                           {0.2, {0.015, 0.025, above - 0.005}},
                           {0.4, {0.02, 0.025, above - 0.005}},
                           {0.5, {0.02, 0.025, above + 0.02}}}});
  add_golden(runs, "precomputed half that is touched", setup, 3 * frames, frame, nothing);
}

// A blade's lips rub on each other above a table; a finger, and then jaws, press and rub beside them.
void add_contact_with_tools(std::vector<GoldenRun>& runs) {
  Setup setup = box_with_blade(RegionModel::tensor_mass);
  setup.contact.self = true;
  setup.contact.friction = 0.2;
  setup.contact.obstacles.push_back({"table", RigidShape::plane(), {0, 0, -0.0005}});
  setup.probes.push_back(
      {"finger",
       RigidShape::sphere(0.008),
       0.1,
       {{0, {0.02, 0.035, 0.06}}, {0.2, {0.022, 0.035, 0.055}}, {0.4, {0.035, 0.033, 0.055}}}});
  setup.probes.push_back({"rod",
                          RigidShape::capsule(0.004, 0.03),
                          0.3,
                          {{0.1, {0.03, -0.01, 0.02}}, {0.3, {0.03, -0.002, 0.02}}},
                          true});
  add_golden(runs, "contact of lips, a finger, a rod and a table", setup, frames, frame, nothing);
}

// A box is thrown on another one, whose face coincides with its own; both rub, and the lower one swings.
void add_contact_of_parts(std::vector<GoldenRun>& runs) {
  TetMesh upper = irregular_box(3, 0.012, 2);
  upper.points.colwise() += Vec3d(0.006, 0.008, 0.05);
  Setup setup = setup_of(joined(box_mesh(Vec3d::Constant(0.05), 5, 5, 5), upper));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {2, 0, -9.81};
  setup.damping = 5;
  setup.contact.self = true;
  setup.contact.friction = 0.3;
  add_golden(runs, "contact of two parts", setup, frames, frame, []<class Real>(World<Real>& world) {
    State<Real> state = world.state();
    for (Eigen::Index v = 216; v < state.v.cols(); ++v) state.v(2, v) = Real(-0.3);
    world.set_state(state);
    return [](int) {};
  });
}

// The box with another law in both halves, which the same tools pull, cut and burn.
void add_laws(std::vector<GoldenRun>& runs) {
  Setup setup = box_with_blade(RegionModel::nonlinear);
  for (auto& material : setup.materials) material.law = MaterialLaw::neo_hookean;
  add_golden(runs, "neo-Hookean", setup, frames, frame, nothing);
  setup = box_with_blade(RegionModel::tensor_mass);
  std::fill(setup.materials.begin(), setup.materials.end(), fibrous());
  setup.mesh.fibres = fibrous_setup(setup.mesh).mesh.fibres;
  add_golden(runs, "fibres, tensor-mass half", setup, frames, frame, nothing);
}

// A reduced bar that is pulled, cut by a blade and burnt.
void add_corotational(std::vector<GoldenRun>& runs) {
  add_golden(runs, "corotational half", box_with_tools(RegionModel::corotational), frames, frame, nothing);
  add_golden(runs, "corotational half, blade", box_with_blade(RegionModel::corotational), frames, frame,
             nothing);
  add_implicit_run(runs, "implicit, corotational half", box_with_tools(RegionModel::corotational));
}

void add_reduced(std::vector<GoldenRun>& runs) {
  Setup setup = pulled_bar();
  add_golden(runs, "reduced", setup, frames, frame, nothing);
  add_golden(runs, "reduced, kept full for a while", setup, frames, frame,
             [some = vertices_near(setup.mesh, {0.08, 0.02, 0.02}, 0.03)](auto& world) {
               return [&world, some](int i) {
                 if (i == 6) world.apply(KeepFull{some, 0.1});
               };
             });
  setup.cauteries.push_back({"cautery", 0.006, {{0.2, {0.12, 0, 0.05}}, {0.3, {0.12, 0.03, 0.05}}}});
  setup.scalpels.push_back({"blade",
                            0.1,
                            {{0.1, {0.081, -0.01, 0.06}}, {0.2, {0.081, -0.01, 0.015}}},
                            {{0.082, 0.05, 0.06}, {0.082, 0.05, 0.015}}});
  add_golden(runs, "reduced, blade and cautery", setup, frames, frame, nothing);

  setup = pulled_bar();  // by jaws, which close on its end and rise
  setup.grasps.clear();
  const double half = std::sqrt(0.5);
  const Eigen::Vector4d along_the_bar{0, -half, 0, half};
  setup.probes.push_back({"jaws",
                          RigidShape::jaws({0.02, 0.005, 0.04}),
                          0.5,
                          {{0.0, {0.185, 0.02, 0.02}, along_the_bar, 0.05},
                           {0.1, {0.185, 0.02, 0.02}, along_the_bar, 0.036},
                           {0.3, {0.185, 0.02, 0.04}, along_the_bar, 0.034}}});
  add_golden(runs, "reduced, jaws", setup, frames, frame, nothing);
}

// Forces and springs that are set and moved while it runs, and a grasp that turns.
void add_applied(std::vector<GoldenRun>& runs) {
  Setup setup = box_of(RegionModel::tensor_mass);
  add_grasp(setup);
  const double half = std::sqrt(0.5);
  setup.grasps[0].path[1].orientation = {half, 0, 0, half};
  add_golden(runs, "a grasp that turns", setup, frames, frame, nothing);
  setup = box_of(RegionModel::tensor_mass);
  const Index end = setup.mesh.vertex_count() - 1;
  const Vec3d at = setup.mesh.points.col(end);
  add_golden(runs, "forces and springs", setup, frames, frame, [=](auto& world) {
    return [&world, at, end](int i) {
      if (i == 2) world.apply(SetForces{{{end, {0.05, 0, 0.02}}, {end - 3, {0, 0.03, 0}}}});
      if (i == 5) world.apply(SetSprings{{{end, 20, at}}});
      if (i > 5 && i < 12) world.apply(MoveSprings{at + 0.002 * (i - 5) * Vec3d(0, 1, 1)});
      if (i == 15) world.apply(SetForces{});
    };
  });
}

}  // namespace

std::vector<GoldenRun> option_scenes() {
  std::vector<GoldenRun> runs;
  add_options(runs);
  add_sleep(runs);
  add_inertia(runs);
  add_edits(runs);
  add_implicit(runs);
  add_blades(runs);
  add_condensing(runs);
  add_laws(runs);
  add_corotational(runs);
  add_reduced(runs);
  add_applied(runs);
  add_contact_with_tools(runs);
  add_contact_of_parts(runs);
  return runs;
}

}  // namespace lobe::test
