#include "lobe/linearity/reduced_watch.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace lobe {
namespace {

constexpr double coarse = 2;                 // cells of the region along one of the grid
constexpr double small = 1e-4;               // displacements near rest, of a cell
constexpr double grid_delay = 0.5;           // until a grid that is being made is used [s], and
constexpr double grid_delay_per_tet = 1e-5;  // for each tetrahedron

double norm(const std::vector<double>& mass, const Mat3X<double>& u) {
  double sum = 0;
  for (std::size_t v = 0; v < mass.size(); ++v) sum += mass[v] * u.col(Eigen::Index(v)).squaredNorm();
  return std::sqrt(sum);
}

// K x of all tetrahedra at rest, of vertices that a grid knows.
template <class Real>
Mat3X<double> stiffness_times(Dynamics<Real>& body, const Mat3X<double>& x) {
  const Mat3X<Real>& u = body.motion.u.padded();
  const double largest = x.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return Mat3X<double>::Zero(3, x.cols());
  const double scale = small * body.regions.reduced().lattice().frame.edge / largest;
  Mat3X<Real> near_rest = Mat3X<Real>::Zero(3, u.cols()), f = near_rest;
  near_rest.leftCols(x.cols()) = (scale * x).template cast<Real>();
  for (auto v = static_cast<Index>(x.cols()); v < body.motion.u.count(); ++v)
    if (const Index origin = body.model.elements.topology.origin(v); origin < x.cols())
      near_rest.col(v) = near_rest.col(origin);
  body.regions.add_tet_forces_near_rest(near_rest, f, body.parallel);
  return f.leftCols(x.cols()).template cast<double>() / -scale;
}

}  // namespace

template <class Real>
ReducedWatch<Real>::ReducedWatch(const World<Real>& world, double tolerance, OnExceeded on_exceeded)
    : tolerance_(tolerance),
      on_exceeded_(std::move(on_exceeded)),
      edits_(world.journal().edits.size()),
      restored_(world.body().model.revisions.restored),
      time_(world.time()) {
  const LatticeRegion<Real>& region = world.body().regions.reduced();
  if (region.any())
    equation_.emplace(TwoGrid(world.elements(), coarse * region.lattice().frame.edge), world.body().damping);
}

template <class Real>
void ReducedWatch<Real>::begin_again_if_restored(const World<Real>& world) {
  const std::uint64_t restored = world.body().model.revisions.restored;
  if (std::exchange(restored_, restored) == restored && world.time() >= time_) return;
  time_ = world.time();
  if (next_grid_.valid()) next_grid_.get();
  const double edge = coarse * world.body().regions.reduced().lattice().frame.edge;
  equation_.emplace(TwoGrid(world.elements(), edge), world.body().damping);
  edits_ = world.journal().edits.size();
  last_ = {};
}

// After a cut the grid is made anew from a copy in another thread, because that takes as long as some frames.
template <class Real>
void ReducedWatch<Real>::follow_edits(const World<Real>& world) {
  const Elements& elements = world.elements();
  const double edge = coarse * world.body().regions.reduced().lattice().frame.edge;
  if (next_grid_.valid() && world.time() >= grid_due_) equation_->use(next_grid_.get(), elements.topology);
  const std::size_t edits = world.journal().edits.size();
  if (std::exchange(edits_, edits) != edits) grid_is_stale_ = true;
  if (!grid_is_stale_ || next_grid_.valid()) return;
  grid_is_stale_ = false;
  grid_due_ = world.time() + grid_delay + grid_delay_per_tet * elements.topology.alive_count();
  next_grid_ = std::async(std::launch::async, [elements, edge] { return TwoGrid(elements, edge); });
}

template <class Real>
void ReducedWatch<Real>::estimate(World<Real>& world, double h) {
  Dynamics<Real>& body = world.body();
  const Mat3X<double> u = world.displacements().template cast<double>();
  largest_ = std::max(largest_, norm(equation_->grid().mass(), u));
  body.find_forces();
  const Mat3X<double> r = body.regions.reduced()
                              .residual(world.elements(), body.loads, equation_->grid().mass(),
                                        body.inertia.mass(), body.motion, body.parallel)
                              .leftCols(equation_->grid().vertex_count());
  equation_->step([&](const Mat3X<double>& x) { return stiffness_times(body, x); }, world.held(), r, h);
  last_.error = largest_ > 0 ? equation_->norm() / largest_ : 0;
  Index worst = 0;
  equation_->error().colwise().squaredNorm().maxCoeff(&worst);
  last_.place = world.elements().points.col(worst);
}

template <class Real>
ReducedReport ReducedWatch<Real>::look(World<Real>& world) {
  const auto start = std::chrono::steady_clock::now();
  last_.time = world.time();
  if (equation_) {
    begin_again_if_restored(world);
    follow_edits(world);
    const double since = world.time() - time_;
    if (looks_++ % frames_between == 0 && since > 0) {
      time_ = world.time();
      estimate(world, since);
    }
  }
  last_.exceeded = last_.error > tolerance_;
  looking_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (last_.exceeded && on_exceeded_) on_exceeded_(last_);
  return last_;
}

template class ReducedWatch<float>;
template class ReducedWatch<double>;

}  // namespace lobe
