#include "lobe/contact/softening.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "lobe/mesh/surface.h"
#include "lobe/numerics/lanczos.h"
#include "lobe/region/smoothed_edges.h"
#include "lobe/solve/tangent.h"

namespace lobe {
namespace {

constexpr double most_added = 0.2;  // of ω_max²
constexpr double least = 1e-3;      // of the stiffness

// Products with the stiffness of a whole body at rest, whatever the models of its regions.
class RestStiffness {
 public:
  explicit RestStiffness(const Elements& elements) : elements_(elements) {
    for (Index t = 0; t < elements.topology.tet_count(); ++t)
      if (elements.topology.alive(t))
        of_tets_.push_back(
            unsmoothed_stiffness(elements, t, Mat34<double>::Zero(), RegionModel::nonlinear, 0));
    if (!any_smoothed(elements.materials)) return;
    const SmoothedEdges edges(elements);
    for (Index e = 0; e < edges.count(); ++e)
      if (edges[e].volume > 0)
        of_domains_.push_back({edges[e].vertices, domain_stiffness(elements, edges[e], Mat3<double>::Zero(),
                                                                   RegionModel::nonlinear, 0)});
  }

  void add_forces(const Mat3X<double>& u, Mat3X<double>& f) const {  // f −= K u [N]
    auto own = of_tets_.begin();
    for (Index t = 0; t < elements_.topology.tet_count(); ++t) {
      if (!elements_.topology.alive(t)) continue;
      const Eigen::Vector4i corners = elements_.topology.corners(t);
      const Mat34<double> there = u(Eigen::all, corners);
      const Eigen::Vector<double, 12> force = *own++ * there.reshaped();
      for (int c = 0; c < 4; ++c) f.col(corners[c]) -= force.segment<3>(3 * c);
    }
    for (const OfDomain& domain : of_domains_) {
      const Mat3X<double> there = u(Eigen::all, domain.vertices);
      const Eigen::VectorXd force = domain.K * there.reshaped();
      for (std::size_t j = 0; j < domain.vertices.size(); ++j)
        f.col(domain.vertices[j]) -= force.segment<3>(3 * Eigen::Index(j));
    }
  }

 private:
  const Elements& elements_;
  std::vector<TetStiffness> of_tets_;
  struct OfDomain {  // of smoothed tetrahedra
    std::vector<Index> vertices;
    Eigen::MatrixXd K;
  };
  std::vector<OfDomain> of_domains_;
};

// λ_max is a convex function of the share, so that lines through two of its values meet the bound at too
// small a share, never at too large a one. square(share) [1/s²].
template <class Square>
double largest_share(double without, Square&& square) {
  const double most = (1 + most_added) * without;
  double low = 0, at_low = without, high = 1, at_high = square(high);
  if (at_high <= most) return 1;
  for (int i = 0; i < 6; ++i) {
    const double share = low + (high - low) * (most - at_low) / (at_high - at_low);
    const double there = square(share);
    if (there > most) {
      high = share;
      at_high = there;
    } else {
      low = share;
      at_low = there;
    }
    if (most - at_low < 0.02 * most) break;
  }
  return std::max(low, least);
}

// Puts all vertices into motion but those that are held.
template <class Real>
void begin_moving(Model& model, int degree, Inertia<Real>& inertia) {
  const Index vertices = model.elements.topology.vertex_count();
  Motion<Real> motion;
  motion.extend(vertices);
  std::vector<Index> all(static_cast<std::size_t>(vertices));
  std::iota(all.begin(), all.end(), 0);
  inertia.update(model, all);
  for (Index v : all) inertia.update_inverse(model, v);
  inertia.use(degree);
  inertia.find_moving(
      model, 0, [](Index) { return false; }, motion);
  inertia.prepare(model, false, [](Index) { return true; });
}

template <class Real>
double softening_of(const Setup& setup, Inertia<Real> inertia, int degree, const RestFrequencies& at_rest,
                    Parallel& parallel) {
  Model model{Elements(setup), held_by(setup.prescribed), {}};
  const Elements& elements = model.elements;
  begin_moving(model, degree, inertia);
  const Surface boundary(elements.topology, elements.region_of);
  ContactSurface surface;
  surface.rebuild({.model = model,
                   .surface = boundary.mesh(),
                   .mass = inertia.mass(),
                   .omega = at_rest.omega,
                   .lumped_omega = at_rest.lumped,
                   .ratio = at_rest.ratio});
  const RestStiffness stiffness(elements);
  const auto scale = [&](Mat3X<double>& forces) {
    Mat3X<Real> scaled = forces.template cast<Real>();
    inertia.apply(parallel, scaled);
    forces = scaled.template cast<double>();
  };
  const auto square = [&](double share) {
    const HighestFrequency found = highest_frequency<double>(
        inertia.inverse_mass(), [](Index) { return 1.0; }, 1,
        [&](const Mat3X<double>& u, Mat3X<double>& f) {
          stiffness.add_forces(u, f);
          surface.add_forces(elements, u, share, f);
        },
        {.tolerance = 0.01, .most = 40}, scale);
    return found.omega * found.omega;
  };
  return largest_share(at_rest.omega > 0 ? at_rest.omega * at_rest.omega : square(0), square);
}

}  // namespace

template <class Real>
double find_softening(const Setup& setup, Inertia<Real> inertia, int degree, const RestFrequencies& at_rest,
                      Parallel& parallel) {
  return softening_of(setup, std::move(inertia), degree, at_rest, parallel);
}

template double find_softening(const Setup&, Inertia<float>, int, const RestFrequencies&, Parallel&);
template double find_softening(const Setup&, Inertia<double>, int, const RestFrequencies&, Parallel&);

}  // namespace lobe
