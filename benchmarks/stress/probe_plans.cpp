// What a rigid probe does to a body that it meets where it should not, or too fast.
#include <Eigen/Geometry>

#include "benchmarks/stress/plan.h"

namespace lobe::stress {

void add_probe_plans(std::vector<Plan>& plans, const Subject& subject, const std::string& model) {
  const Mat3X<double>& X = subject.mesh.points;
  const Vec3d low = X.rowwise().minCoeff(), high = X.rowwise().maxCoeff(), middle = (low + high) / 2;
  const double size = (high - low).minCoeff(), radius = 0.15 * size;
  const Vec3d top(middle.x(), middle.y(), high.z()), away = top + Vec3d(0, 0, 3 * size);
  const auto turned = [](double angle) {
    return Eigen::Vector4d(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vec3d::UnitX())).coeffs());
  };
  const auto add = [&](const std::string& name, const RigidShape& shape, const std::vector<PathPoint>& path) {
    Plan& plan = plans.emplace_back();
    plan.name = "a probe " + name;
    plan.body = subject.name;
    plan.model = model;
    plan.must = Must::report;
    plan.setup = held_tissue(subject, model);
    plan.setup.expandable = kind_of(model) == "precomputed";
    plan.setup.probes.push_back({"probe", shape, 0.3, path});
    plan.seconds = 0.5;
  };
  const RigidShape ball = RigidShape::sphere(radius), rod = RigidShape::capsule(radius / 2, size),
                   plate = RigidShape::box({4 * size, 4 * size, radius});
  add("that is inside at the start", ball, {{0, middle}});
  add("that is half inside the skin at the start", ball, {{0, top}});
  add("that teleports into the skin", ball, {{0, away}, {0.2, away}, {0.2001, top}});
  add("that teleports through the body", ball, {{0, away}, {0.2, away}, {0.21, 2 * middle - away}});
  add("that spins in the skin", rod,
      {{0, top, turned(EIGEN_PI / 2)},
       {0.02, top, turned(3)},
       {0.04, top, turned(5)},
       {0.06, top, turned(7)}});
  add("that crushes it by half", plate,
      {{0, top + Vec3d(0, 0, radius)}, {0.3, top - Vec3d(0, 0, 0.5 * (high - low).z() - radius / 2)}});
}

}  // namespace lobe::stress
