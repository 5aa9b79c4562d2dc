#include "lobe/haptic/local_model.h"

#include <Eigen/LU>
#include <algorithm>

namespace lobe {
namespace {

// Along the normal alone; what friction there is goes with it in proportion.
struct Push {
  double force, stiffness;  // at x_k [N], [N/m]
  Vec3d per_normal;         // the whole force, where that along the normal is 1

  explicit Push(const LocalModel& model)
      : force(std::max(0.0, model.normal.dot(model.force))),
        stiffness(model.normal.dot(model.K * model.normal)),
        per_normal(force > 0 ? Vec3d(model.force / force) : model.normal) {}
};

}  // namespace

LocalModel aged(const LocalModel& model, double since) {
  LocalModel now = model;
  now.force += std::min(since + 0.5 * model.frame, 2 * model.frame) * model.rate;
  return now;
}

Vec3d force_at(const LocalModel& model, const Vec3d& x) {
  const Vec3d way = x - model.position;
  if (model.is_bilateral) return model.force - model.K * way;
  const Push push(model);
  return std::max(0.0, push.force - push.stiffness * model.normal.dot(way)) * push.per_normal;
}

Proxy quasi_static_proxy(const LocalModel& model, const Vec3d& device, double coupling, const Vec3d& offset) {
  const Vec3d way = device - model.position;
  if (model.is_bilateral) {
    const Mat3<double> both = coupling * Mat3<double>::Identity() + model.K;
    const Vec3d y = both.inverse() * (coupling * way + model.force + offset);
    return {model.position + y, model.force + offset - model.K * y};
  }
  const Push push(model);
  const double alone = push.force - push.stiffness * model.normal.dot(way + offset / coupling);
  const double normal_force = std::max(0.0, alone / (1 + push.stiffness / coupling));
  const Vec3d force = normal_force * push.per_normal + offset;
  return {device + force / coupling, force};
}

}  // namespace lobe
