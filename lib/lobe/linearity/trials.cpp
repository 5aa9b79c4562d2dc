#include "lobe/linearity/trials.h"

#include <algorithm>

#include "lobe/numerics/supernodal_factor.h"

namespace lobe {
namespace {

constexpr double least_reached = 0.05;  // share of a gesture that is still of use

double norm(const Setup& setup, const Mat3X<double>& u) {  // √∫|u|², vertex by vertex
  double sum = 0;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const double share = setup.shares.empty() ? 1 : setup.shares[std::size_t(t)];
    sum += share * signed_volume(tet_points(setup.mesh, t)) / 4 *
           u(Eigen::all, setup.mesh.tets.col(t)).colwise().squaredNorm().sum();
  }
  return std::sqrt(sum);
}

void scale(Setup& setup, double fraction) {
  for (PrescribedVertex& p : setup.prescribed) p.displacement *= fraction;
  for (FaceLoad& load : setup.face_loads) load.traction *= fraction;
  for (VertexLoad& load : setup.vertex_loads) load.force *= fraction;
  for (FacePressure& load : setup.pressures) load.pressure *= fraction;
  setup.gravity *= fraction;
}

StaticOptions static_options() {
  StaticOptions options;
  options.factor = make_supernodal;
  options.tolerance = 1e-8;
  return options;
}

}  // namespace

std::vector<Trial> solve_trials(
    const Setup& setup, const std::vector<Gesture>& gestures,
    const std::function<void(std::size_t gesture, const StaticResult& found)>& followed) {
  std::vector<Trial> trials;
  for (std::size_t g = 0; g < gestures.size(); ++g) {
    Trial trial{at_the_end_of(gestures[g], setup), {}, g};
    std::fill(trial.setup.region_of.begin(), trial.setup.region_of.end(), RegionModel::nonlinear);
    StaticResult found = solve_static(trial.setup, static_options());
    if (followed) followed(g, found);
    if (found.load_fraction < least_reached || found.u.isZero(0)) continue;
    scale(trial.setup, found.load_fraction);
    trial.u = std::move(found.u);
    trial.norm = norm(setup, trial.u);
    trials.push_back(std::move(trial));
  }
  return trials;
}

double static_error(const std::vector<RegionModel>& region_of, const Trial& trial) {
  Setup setup = trial.setup;
  for (std::size_t t = 0; t < region_of.size(); ++t)  // condensed it would be the same equilibrium
    if (is_linear(region_of[t])) setup.region_of[t] = RegionModel::tensor_mass;
  StaticOptions options = static_options();
  options.start = &trial.u;
  const StaticResult found = solve_static(setup, options);
  return found.converged ? norm(setup, found.u - trial.u) / trial.norm : 1;
}

}  // namespace lobe
