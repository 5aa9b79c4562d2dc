#include "lobe/linearity/reduced_watch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "lobe/sort_unique.h"

namespace lobe {
namespace {

constexpr double coarse = 2;                 // cells of the region along one of the grid
constexpr double small = 1e-4;               // displacements near rest, of a cell
constexpr double grid_delay = 0.5;           // until a grid that is being made is used [s], and
constexpr double grid_delay_per_tet = 1e-5;  // for each tetrahedron
constexpr double correct_above = 0.8;        // of the tolerance: where vertices become full, and
constexpr double correct_down_to = 0.4;      // what the others may make
constexpr double least_full = 0.25;          // for which they stay so [s]

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
ReducedWatch<Real>::ReducedWatch(const World<Real>& world, ReducedOptions options)
    : options_(std::move(options)), edits_(world), time_(world.time()) {
  const LatticeRegion<Real>& region = world.body().regions.reduced();
  if (region.any())
    equation_.emplace(TwoGrid(world.elements(), coarse * region.lattice().frame.edge), world.body().damping);
}

template <class Real>
void ReducedWatch<Real>::begin_again(const World<Real>& world) {
  time_ = world.time();
  if (next_grid_.valid()) next_grid_.get();
  const double edge = coarse * world.body().regions.reduced().lattice().frame.edge;
  equation_.emplace(TwoGrid(world.elements(), edge), world.body().damping);
  last_ = {};
  begins_ = true;
}

// A world that was restored is watched anew. After a cut the grid is made anew and factored from a copy in
// another thread, because that takes as long as some frames.
template <class Real>
void ReducedWatch<Real>::follow_edits(const World<Real>& world) {
  const Elements& elements = world.elements();
  const EditReader::News news = edits_.read(world);
  const bool goes_back = news.was_restored || world.time() < time_;
  if (goes_back) begin_again(world);
  const double edge = coarse * world.body().regions.reduced().lattice().frame.edge;
  if (next_grid_.valid() && world.time() >= grid_due_) equation_->use(next_grid_.get(), elements.topology);
  if (news.has_edits && !goes_back) grid_is_stale_ = true;
  if (!grid_is_stale_ || next_grid_.valid()) return;
  grid_is_stale_ = false;
  grid_due_ = world.time() + grid_delay + grid_delay_per_tet * elements.topology.alive_count();
  next_grid_ = std::async(std::launch::async, [make = equation_->grid_maker(), elements, edge,
                                               held = world.held()] { return make(elements, edge, held); });
}

template <class Real>
void ReducedWatch<Real>::estimate(World<Real>& world, double h) {
  Dynamics<Real>& body = world.body();
  world.displacements();  // which recovers them
  body.find_forces();
  const Mat3X<double> r = body.regions.reduced()
                              .residual(world.elements(), body.loads, equation_->grid().mass(),
                                        body.inertia.mass(), body.motion, body.parallel)
                              .leftCols(equation_->grid().vertex_count());
  equation_->step([&](const Mat3X<double>& x) { return stiffness_times(body, x); }, world.held(), r, h);
}

template <class Real>
Mat3X<double> ReducedWatch<Real>::vertex_errors(const World<Real>& world) const {
  if (!equation_) return Mat3X<double>(3, 0);
  const Dynamics<Real>& body = world.body();
  Mat3X<double> e = equation_->error();  // of what the nodes make of displacements
  if (const Mat3X<Real> left = body.regions.reduced().fading(body.motion); left.size() > 0)
    e -= left.leftCols(e.cols()).template cast<double>();
  return e;
}

template <class Real>
void ReducedWatch<Real>::measure(World<Real>& world) {
  const Mat3X<double> u = world.displacements().template cast<double>();
  largest_ = std::max(largest_, norm(equation_->grid().mass(), u));
  before_ = last_.error;
  const Mat3X<double> e = vertex_errors(world);
  last_.error = largest_ > 0 ? norm(equation_->grid().mass(), e) / largest_ : 0;
  Index worst = 0;
  e.colwise().squaredNorm().maxCoeff(&worst);
  last_.place = world.elements().points.col(worst);
}

// Vertices of the lattice's parts with the largest power r·e of the residual: as many as make the error small
// enough if the rest makes its share of it.
template <class Real>
std::vector<Index> ReducedWatch<Real>::where_most_is_made(const World<Real>& world) const {
  const LatticeRegion<Real>& region = world.body().regions.reduced();
  const Eigen::VectorXd power = equation_->power();
  struct Part {
    double power = 0;
    std::vector<Index> vertices;
  };
  std::vector<Part> parts(region.lattice().parts.size());
  for (Index v : region.embedding().vertices) {
    Part& own = parts[std::size_t(region.lattice().part_of_vertex[std::size_t(v)])];
    own.vertices.push_back(v);
    if (v < power.size()) own.power += power[v];
  }
  std::erase_if(parts, [](const Part& part) { return !(part.power > 0); });
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Part& a, const Part& b) { return a.power > b.power; });
  double left = 0;
  for (const Part& part : parts) left += part.power;
  const double goal = correct_down_to * options_.tolerance / last_.error * left;
  std::vector<Index> found;
  for (Part& part : parts) {
    if (left <= goal) break;
    left -= part.power;
    found.insert(found.end(), part.vertices.begin(), part.vertices.end());
  }
  sort_unique(found);
  return found;
}

template <class Real>
ReducedReport ReducedWatch<Real>::look(World<Real>& world, const CommandSink& send) {
  const auto start = std::chrono::steady_clock::now();
  last_.time = world.time();
  last_.to_full = 0;
  bool is_new = false;
  ++looks_;
  if (equation_) {
    follow_edits(world);
    const double since = world.time() - time_;
    auto& region = world.body().regions.reduced();
    if (std::exchange(begins_, false)) {  // what was lost before is no error, nor what fades now
      region.take_lost();
      equation_->add(region.fading(world.body().motion).template cast<double>());
    }
    const bool is_due = since > 0 && looks_ % frames_between == 0;
    if (is_due) {
      time_ = world.time();
      estimate(world, since);
    }
    is_new = is_due || region.has_lost();
    if (region.has_lost()) equation_->add(region.take_lost().template cast<double>());
    if (is_new) measure(world);
  }
  last_.exceeded = last_.error > options_.tolerance;
  const bool grows = last_.error > 0.95 * before_;
  if (options_.correct && is_new && grows && last_.error > correct_above * options_.tolerance) {
    const std::vector<Index> vertices = where_most_is_made(world);
    last_.to_full = static_cast<Index>(vertices.size());
    if (!vertices.empty()) send(KeepFull{vertices, least_full});
  }
  looking_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (last_.exceeded && options_.on_exceeded) options_.on_exceeded(last_);
  return last_;
}

template class ReducedWatch<float>;
template class ReducedWatch<double>;

}  // namespace lobe
