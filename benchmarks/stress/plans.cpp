// What trainees, scenes and meshes do to a body.
#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "benchmarks/stress/plan.h"
#include "lobe/mesh/generators.h"

namespace lobe::stress {
namespace {

Mat3X<double> random_field(Index count, double size, unsigned seed = 5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Mat3X<double> field(3, count);
  for (double& x : field.reshaped()) x = uniform(random);
  return field;
}

Plan& add(std::vector<Plan>& plans, const std::string& name, const std::string& body,
          const std::string& model, Must must, Setup setup) {
  Plan& plan = plans.emplace_back();
  plan.name = name;
  plan.body = body;
  plan.model = model;
  plan.must = must;
  plan.setup = std::move(setup);
  return plan;
}

// A grasp of its own for every vertex, whose path follows to(X, s) − X while s goes from 0 to 1, then lets
// go.
template <class To>
void handle(Setup& setup, const std::vector<Index>& vertices, double seconds, To&& to) {
  constexpr int rows = 64;
  for (Index v : vertices) {
    GraspSetup grasp{"hand", {v}, {}, true};
    for (int i = 0; i <= rows; ++i) {
      const double s = double(i) / rows;
      grasp.path.push_back({s * seconds, to(Vec3d(setup.mesh.points.col(v)), s) - setup.mesh.points.col(v)});
    }
    setup.grasps.push_back(std::move(grasp));
  }
}

// Blades on planes in any direction, all the way through the middle of the body, one after the other.
void add_strokes(Setup& setup, int count) {
  const Vec3d low = setup.mesh.points.rowwise().minCoeff(), high = setup.mesh.points.rowwise().maxCoeff();
  const double reach = (high - low).norm();
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  for (int i = 0; i < count; ++i) {
    const Vec3d n = Vec3d(normal(random), normal(random), normal(random)).normalized(),
                along = n.unitOrthogonal(), edge = n.cross(along);
    const Vec3d from = (low + high) / 2 - reach * along, to = from + 2 * reach * along;
    const double time = 0.2 + 0.25 * i;
    setup.scalpels.push_back({"blade",
                              0.1,
                              {{time, from - reach * edge}, {time + 0.3, to - reach * edge}},
                              {from + reach * edge, to + reach * edge}});
  }
}

// There and back: 0, 1, 0.
double there_and_back(double s) { return 1 - std::abs(2 * s - 1); }

}  // namespace

void add_time_step_plans(std::vector<Plan>& plans, bool quick) {
  const Subject subject = box();
  const auto shaken = [&](Plan& plan, double speed) {
    const bool is_selective = plan.setup.selective_mass > 1;  // of whose inertia a tenth has as much energy
    plan.v = random_field(subject.mesh.vertex_count(), is_selective ? speed / 10 : speed);
    return &plan;
  };
  for (const std::string& model : models()) {
    const bool is_free = kind_of(model) != "precomputed";  // such a region needs fixed vertices
    Setup undamped = is_free ? tissue(subject.mesh, model) : held_tissue(subject, model);
    undamped.damping = 0;
    for (const double factor : {0.5, 0.9, 0.99}) {
      Plan& plan = add(plans, "undamped, " + std::to_string(factor).substr(0, 4) + " of the limit", "box",
                       model, Must::keep_energy, held_tissue(subject, model));
      plan.setup.damping = 0;
      shaken(plan, 1e-3)->steps = quick ? 20000 : 1000000;
      plan.step_factor = factor;
    }
    if (is_free) {
      Plan& adrift =
          add(plans, "undamped and adrift, 0.90 of the limit", "box", model, Must::keep_energy, undamped);
      shaken(adrift, 1e-3)->steps = quick ? 20000 : 1000000;
      adrift.step_factor = 0.9;
    }
    for (const double factor : {1.01, 1.1}) {
      // The limit of a lattice is a bound (below), and with smoothed cells this is so little beyond it that
      // it is stable.
      const bool is_stable = model == "smoothed reduced" && factor < 1.05;
      Plan& plan = add(plans, "asked for " + std::to_string(factor).substr(0, 4) + " of the limit", "box",
                       model, is_stable ? Must::survive : Must::flag, undamped);
      plan.setup.safety = factor;
      shaken(plan, 1e-3)->seconds = 0.5;
    }
    // The limit of a lattice is a bound, which sums those of its cells.
    const double beyond = kind_of(model) == "reduced" ? 1.8 : 1.1;
    Plan& unchecked = add(plans, "bare steps of " + std::to_string(beyond).substr(0, 4) + " of the limit",
                          "box", model, Must::be_flagged, undamped);
    shaken(unchecked, 1e-6)->steps = 2000;
    unchecked.step_factor = beyond;
    Plan& rest = add(plans, "at rest", "box", model, Must::stay, undamped);
    rest.steps = quick ? 5000 : 100000;
    rest.step_factor = 0.9;
  }
}

void add_shape_plans(std::vector<Plan>& plans, const Subject& subject, const std::string& model) {
  const Mat3X<double>& X = subject.mesh.points;
  const Vec3d middle = X.rowwise().mean();
  const auto start = [&](const char* name, const Mat3X<double>& x) {
    Plan& plan = add(plans, name, subject.name, model, Must::recover, held_tissue(subject, model));
    plan.u = x - X;
    plan.seconds = 6;
    for (const PrescribedVertex& held : plan.setup.prescribed) plan.u.col(held.vertex).setZero();
  };
  start("collapsed to a point", middle.replicate(1, X.cols()));
  Mat3X<double> flat = X, mirrored = X;
  flat.row(2).setConstant(middle.z());
  start("collapsed to a plane", flat);
  mirrored.row(2) = (2 * middle.z() - mirrored.row(2).array()).matrix();
  start("mirrored", mirrored);
  start("randomised", X + random_field(Index(X.cols()), 0.2 * subject.length()));
}

void add_gesture_plans(std::vector<Plan>& plans, const Subject& subject, const std::string& model) {
  const Mat3X<double>& X = subject.mesh.points;
  const double length = subject.length(), low = X.row(0).minCoeff();
  const Vec3d middle = X.rowwise().mean();
  const auto gesture = [&](const char* name, Must must) -> Plan& {
    Plan& plan = add(plans, name, subject.name, model, must, held_tissue(subject, model));
    plan.seconds = 4;
    return plan;
  };
  const auto crush = [&](const char* name, Must must, double left) {
    handle(gesture(name, must).setup, subject.high_end(), 1, [=](Vec3d x, double s) {
      x.x() -= (1 - left) * (x.x() - low) * there_and_back(s);
      return x;
    });
  };
  crush("crushed to 30 %", Must::recover, 0.3);
  crush("crushed to nothing", Must::survive, 0);
  const auto twist = [&](const char* name, Must must, double degrees) {
    handle(gesture(name, must).setup, subject.high_end(), 1, [=](const Vec3d& x, double s) {
      const double angle = degrees * std::acos(-1.0) / 180 * there_and_back(s);
      const Vec3d r = x - middle;
      return Vec3d(x.x(), middle.y() + std::cos(angle) * r.y() - std::sin(angle) * r.z(),
                   middle.z() + std::sin(angle) * r.y() + std::cos(angle) * r.z());
    });
  };
  twist("twisted by 180 degrees", Must::recover, 180);
  twist("twisted by 720 degrees", Must::survive, 720);
  handle(gesture("pulled to 300 %", Must::recover).setup, subject.high_end(), 1,
         [=](Vec3d x, double s) -> Vec3d { return x + Vec3d(2 * length * there_and_back(s), 0, 0); });
  Plan& impact = gesture("thrown against its holder at 20 m/s", Must::recover);
  impact.v = Vec3d(-20, 0, 0).replicate(1, X.cols());
  Plan& teleported = gesture("tool teleports by its length", Must::recover);
  teleported.setup.grasps.push_back(
      {"hand",
       subject.high_end(),
       {{0.2, Vec3d::Zero()}, {0.200001, Vec3d(0, length, 0)}, {0.5, Vec3d(0, length, 0)}},
       true});
  Plan& torn = gesture("two vertices of a tetrahedron torn apart", Must::recover);
  const Index tet = subject.mesh.tet_count() - 1;
  for (const int corner : {0, 1}) {
    const Vec3d away(0, corner == 0 ? -length : length, 0);
    torn.setup.grasps.push_back(
        {"hand", {subject.mesh.tets(corner, tet)}, {{0, Vec3d::Zero()}, {0.5, away}, {1, away}}, true});
  }
  Plan& strokes = gesture("pulled, and cut by five strokes that cross", Must::survive);
  strokes.setup.gravity = {0, 0, -9.81};
  handle(strokes.setup, subject.high_end(), 3,
         [=](Vec3d x, double s) -> Vec3d { return x + Vec3d(0.4 * length * there_and_back(s), 0, 0); });
  add_strokes(strokes.setup, 5);
  Plan& cut = gesture("cut at random until nothing is left", Must::vanish);
  cut.setup.gravity = {0, 0, -9.81};
  cut.cut_share = 0.02;
  cut.seconds = 2;
  Plan& heavy = gesture("a million times its weight", Must::report);
  heavy.setup.gravity = {0, 0, -9.81e6};
  heavy.seconds = 0.5;
}

void add_material_plans(std::vector<Plan>& plans) {
  const Subject subject = box();
  const auto dropped = [&](const std::string& name, const std::string& model, const Elastic& first,
                           const Elastic& second) {
    Plan& plan = add(plans, name, subject.name, model, Must::survive, held_tissue(subject, model));
    const ElementType element = plan.setup.materials[0].element;
    plan.setup.materials = {first, second};
    for (Elastic& material : plan.setup.materials) material.element = element;
    for (std::size_t t = 0; t < plan.setup.material_of.size(); ++t) plan.setup.material_of[t] = t % 2;
    plan.setup.gravity = {0, 0, -9.81};
    plan.setup.damping = 0;
    plan.seconds = 0.3;
  };
  for (const std::string& model : models()) {
    if (kind_of(model) == "volume term") continue;
    const double share = kind_of(model) == "nodal pressure";
    for (const double nu : {0.3, 0.45, 0.49, 0.499}) {
      const Elastic e{2e4 * nu / (1 - 2 * nu), 1e4, 1000, share};
      dropped("Poisson's ratio " + std::to_string(nu).substr(0, 5), model, e, e);
    }
    for (const double contrast : {1e2, 1e4})
      dropped("stiffness contrast 1e" + std::to_string(int(std::log10(contrast))), model,
              {4e4, 1e4, 1000, share}, {4e4 * contrast, 1e4 * contrast, 1000, share});
  }
}

void add_mesh_plans(std::vector<Plan>& plans) {
  const auto dropped = [&](const std::string& name, const TetMesh& mesh, const std::string& model) {
    const Subject subject{"box", mesh};
    // Meshes so coarse have no lattice that is coarser.
    const Must must = kind_of(model) == "reduced" ? Must::report : Must::survive;
    Plan& plan = add(plans, name, "box", model, must, held_tissue(subject, model));
    plan.setup.gravity = {0, 0, -9.81};
    plan.setup.damping = 0;
    plan.seconds = 0.1;
  };
  for (const std::string& model : models()) {
    for (const double degrees : {1.0, 0.1}) {
      // The middle vertex of 2 × 2 × 2 cells nears the face opposite to it in one of its tetrahedra.
      TetMesh mesh = box_mesh(Vec3d::Constant(0.02), 2, 2, 2);
      const Index tet = 0, middle = 13;
      Vec3d face = Vec3d::Zero();
      for (int c = 0; c < 4; ++c)
        if (mesh.tets(c, tet) != middle) face += mesh.points.col(mesh.tets(c, tet)) / 3;
      mesh.points.col(middle) = face + degrees / 60 * (mesh.points.col(middle) - face);
      dropped("slivers of about " + std::to_string(degrees).substr(0, 3) + " degrees", mesh, model);
    }
    TetMesh graded = box_mesh(Vec3d::Ones(), 8, 2, 2);
    for (double& x : graded.points.row(0)) x = std::pow(1000.0, x - 1);
    graded.points.row(1) *= 0.1;
    graded.points.row(2) *= 0.1;
    dropped("cells from 1 to 1/1000", graded, model);
  }
}

std::vector<Plan> all_plans(bool quick) {
  std::vector<Plan> plans;
  add_time_step_plans(plans, quick);
  add_material_plans(plans);
  add_mesh_plans(plans);
  for (const std::string& model : models()) {
    add_shape_plans(plans, box(), model);
    add_gesture_plans(plans, box(), model);
    add_probe_plans(plans, box(), model);
    for (const Subject& organ : organs(quick)) {
      if (quick && kind_of(model) != "nonlinear" && kind_of(model) != "mixed") continue;
      add_shape_plans(plans, organ, model);
      add_gesture_plans(plans, organ, model);
    }
  }
  return plans;
}

}  // namespace lobe::stress
