#include "lobe/linearity/step_cost.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>

#include "lobe/condense/interface_size.h"
#include "lobe/numerics/symmetric_product.h"
#include "lobe/sim/world.h"

namespace lobe {
namespace {

using Functions = std::vector<std::function<void()>>;

// The smallest of repeated measurements in turn, each over at least a twentieth of a second.
std::vector<double> smallest_seconds(const Functions& functions) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> smallest(functions.size(), std::numeric_limits<double>::max());
  double total = 0;
  for (int i = 0; i < 20 || total < 0.05 * double(functions.size()); ++i)
    for (std::size_t f = 0; f < functions.size(); ++f) {
      const auto start = Clock::now();
      functions[f]();
      const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
      smallest[f] = std::min(smallest[f], seconds);
      total += seconds;
    }
  return smallest;
}

template <class Real>
std::vector<double> seconds_of(const std::vector<Setup>& setups) {
  std::vector<std::unique_ptr<World<Real>>> worlds;
  Functions steps;
  for (const Setup& setup : setups) {
    World<Real>& world = *worlds.emplace_back(std::make_unique<World<Real>>(setup));
    State<Real> state = world.state();
    state.u.setRandom();
    state.u *= Real(1e-5) * static_cast<Real>(std::cbrt(total_volume(setup.mesh)));
    for (const HeldVertices::Held& item : world.held().all()) state.u.col(item.vertex).setZero();
    world.set_state(state);
    steps.push_back([&world, dt = 0.5 * world.time_step_limit()] { world.step(dt); });
  }
  return smallest_seconds(steps);
}

template <class Real>
double seconds_of_product(Index size) {
  SymmetricProduct<Real> product;
  product.set(Eigen::MatrixXd::Identity(size, size));
  Parallel alone(1);
  return smallest_seconds({[&] { product.multiply(alone); }})[0];
}

double product_seconds(Index size, bool in_double) {
  return in_double ? seconds_of_product<double>(size) : seconds_of_product<float>(size);
}

}  // namespace

std::vector<double> step_seconds(const std::vector<Setup>& setups, bool in_double) {
  return in_double ? seconds_of<double>(setups) : seconds_of<float>(setups);
}

double step_seconds(const Setup& setup, bool in_double) {
  return step_seconds(std::vector<Setup>{setup}, in_double)[0];
}

StepCost measure_step_cost(const Setup& setup, const Zones& zones, bool in_double) {
  const double tets = double(setup.mesh.tet_count());
  Setup trial = setup;
  const auto seconds = [&](auto&& model_of) {
    for (std::size_t t = 0; t < trial.region_of.size(); ++t) trial.region_of[t] = model_of(t);
    return step_seconds(trial, in_double);
  };
  StepCost cost;
  cost.nonlinear = seconds([](std::size_t) { return RegionModel::nonlinear; }) / tets;
  cost.tensor_mass = seconds([](std::size_t) { return RegionModel::tensor_mass; }) / tets;
  const double mixed = seconds([&](std::size_t t) {
    return zones.of[t] % 2 == 0 ? RegionModel::nonlinear : RegionModel::tensor_mass;
  });
  const auto linear =
      double(std::count(trial.region_of.begin(), trial.region_of.end(), RegionModel::tensor_mass));
  const double unshared = cost.of(tets - linear, linear, 0, 0);
  const Index shared = interface_size(Elements(trial), RegionModel::tensor_mass).vertices;
  if (shared > 0) cost.shared = std::max(0.0, mixed - unshared) / shared;
  constexpr Index usual = 600;
  cost.dense = product_seconds(usual, in_double) / (double(usual) * usual);
  return cost;
}

}  // namespace lobe
