// What a clip closes on, and where bodies that carry something are open.
#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/forces/clips.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr int columns = 9, rows = 2;  // of rays from leg to leg

// A turn into the axes of a clip.
struct ClipAxes {
  Mat3<double> turn;
  Vec3d centre;
  explicit ClipAxes(const ClipClosure& closure)
      : turn(Eigen::Quaterniond(closure.orientation).normalized().toRotationMatrix().transpose()),
        centre(closure.position) {}
  Vec3d operator()(const Vec3d& x) const { return turn * (x - centre); }
  Vec3d back(const Vec3d& local) const { return turn.transpose() * local + centre; }
};

// Where a ray along z at (x, y) meets a triangle; NaN: nowhere.
double meets_at(double x, double y, const Mat3<double>& corners) {
  const auto cross = [&](int a, int b) {
    return (corners(0, a) - x) * (corners(1, b) - y) - (corners(1, a) - y) * (corners(0, b) - x);
  };
  const double w0 = cross(1, 2), w1 = cross(2, 0), w2 = cross(0, 1), sum = w0 + w1 + w2;
  const bool is_inside = (w0 >= 0 && w1 >= 0 && w2 >= 0) || (w0 <= 0 && w1 <= 0 && w2 <= 0);
  if (!is_inside || sum == 0) return std::numeric_limits<double>::quiet_NaN();
  return (w0 * corners(2, 0) + w1 * corners(2, 1) + w2 * corners(2, 2)) / sum;
}

struct Ray {
  double x = 0, y = 0;
  double low = std::numeric_limits<double>::infinity(), high = -low;  // along z [m]
  Index low_tet = -1, high_tet = -1;
  void meet(double z, Index tet) {
    if (z < low) low = z, low_tet = tet;
    if (z > high) high = z, high_tet = tet;
  }
};

std::vector<Ray> rays_of(const ClipShape& shape) {
  std::vector<Ray> rays;
  for (int i = 0; i < columns; ++i)
    for (int k = 0; k < rows; ++k)
      rays.push_back({((i + 0.5) / columns - 0.5) * shape.length, (k - 0.5) * shape.width / 2});
  return rays;
}

}  // namespace

template <class Real>
ClipSetup Clips<Real>::find(const ClipClosure& closure, const SurfaceMesh& surface, const At& at) {
  const Elements& elements = at.model.elements;
  const ClipAxes axes(closure);
  ClipSetup clip{closure.name, closure.shape, closure.tool, closure.number, at.time, {}, {}};
  Mat3X<Real> x(3, surface.vertex_count());
  update_positions<Real>(surface, elements.points.view(), at.u.leftCols(elements.points.count()), x);
  std::vector<Ray> rays = rays_of(closure.shape);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Index tet = surface.owner[t].tet;
    if (elements.region_of[std::size_t(tet)] == RegionModel::precomputed) continue;
    Mat3<double> corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = axes(x.col(surface.triangles[t][k]).template cast<double>());
    for (Ray& ray : rays)
      if (const double z = meets_at(ray.x, ray.y, corners); std::abs(z) <= closure.shape.opening / 2)
        ray.meet(z, tet);
  }
  const auto corners_now = [&](Index tet) -> Mat34<double> {
    const Eigen::Vector4i corners = elements.topology.corners(tet);
    return elements.corner_points(tet) + at.u(Eigen::all, corners).template cast<double>();
  };
  const auto point_on = [&](const Ray& ray, double z, Index tet) -> EmbeddedPoint {
    return {tet, barycentric(corners_now(tet), axes.back({ray.x, ray.y, z}))};
  };
  for (const Ray& ray : rays) {
    if (!(ray.high - ray.low > 1e-3 * closure.shape.gap)) continue;
    const ClipSetup::Pair pair{point_on(ray, ray.low, ray.low_tet), point_on(ray, ray.high, ray.high_tet),
                               ray.high - ray.low};
    if (pair.from.is_valid() && pair.to.is_valid()) clip.pairs.push_back(pair);
  }
  for (Index tet = 0; tet < elements.topology.tet_count() && !clip.pairs.empty(); ++tet) {
    if (!elements.topology.alive(tet)) continue;
    Mat34<double> local = corners_now(tet);
    for (int c = 0; c < 4; ++c) local.col(c) = axes(local.col(c));
    const Vec3d centre = local.rowwise().mean();
    if (local.row(1).minCoeff() < 0 && local.row(1).maxCoeff() >= 0 &&
        std::abs(centre[0]) <= closure.shape.length / 2 && std::abs(centre[2]) <= closure.shape.opening / 2)
      clip.squeezed.push_back(tet);
  }
  return clip;
}

// ---- Bodies that carry something

template <class Real>
std::vector<char> Clips<Real>::reached(const CarrierSetup& carrier, const Elements& elements) const {
  const Topology& topology = elements.topology;
  std::vector<char> is_closed(std::size_t(topology.tet_count()), 0);
  for (const ClipSetup& clip : state_.clips)
    if (!clip.pairs.empty())
      for (const Index tet : clip.squeezed) is_closed[std::size_t(tet)] = 1;
  std::vector<char> is_reached(is_closed.size(), 0);
  std::vector<Index> queue;
  const auto reach = [&](Index tet) {
    if (is_closed[std::size_t(tet)] || is_reached[std::size_t(tet)] ||
        elements.bodies.body_of(tet) != carrier.body)
      return;
    is_reached[std::size_t(tet)] = 1;
    queue.push_back(tet);
  };
  for (const Index vertex : carrier.fed)
    for (const Index tet : topology.around(vertex)) reach(tet);
  for (std::size_t at = 0; at < queue.size(); ++at)
    topology.for_neighbours(queue[at], [&](int, Index other) { reach(other); });
  return is_reached;
}

// Sums over triangles in the order of their tetrahedra: that of the surface depends on its past.
template <class Real>
void Clips<Real>::find_open(std::size_t which, const SurfaceMesh& surface, const At& at) {
  const CarrierSetup& carrier = carriers_[which];
  const Elements& elements = at.model.elements;
  const std::vector<char> is_reached = reached(carrier, elements);
  std::vector<std::size_t> open;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (surface.cut[t] && is_reached[std::size_t(surface.owner[t].tet)]) open.push_back(t);
  std::sort(open.begin(), open.end(), [&](std::size_t a, std::size_t b) {
    const FaceOwner &one = surface.owner[a], &other = surface.owner[b];
    return std::pair(one.tet, one.code) < std::pair(other.tet, other.code);
  });
  double area = 0;
  Vec3d moment = Vec3d::Zero();
  if (!open.empty()) {
    Mat3X<double> X(3, surface.vertex_count()), x = X;
    const Mat3X<double> u = at.u.leftCols(elements.points.count()).template cast<double>();
    update_positions<double>(surface, elements.points.view(), Mat3X<double>::Zero(3, u.cols()), X);
    update_positions<double>(surface, elements.points.view(), u, x);
    for (const std::size_t t : open) {
      const Mat3<double> rest = X(Eigen::all, surface.triangles[t]),
                         now = x(Eigen::all, surface.triangles[t]);
      const double part = (rest.col(1) - rest.col(0)).cross(rest.col(2) - rest.col(0)).norm() / 2;
      area += part;
      moment += part * now.rowwise().mean();
    }
  }
  const double before = std::exchange(state_.open[which], area);
  if (!(area > (1 + 1e-6) * before)) return;
  const bool is_blood = carrier.carries == Carries::blood;
  std::string text;
  if (before == 0)
    text =
        "\"" + elements.bodies.names[std::size_t(carrier.body)] + (is_blood ? "\" bleeds" : "\" leaks bile");
  state_.events.push_back(
      {is_blood ? Event::Kind::bleeding : Event::Kind::leak, at.time, Vec3d(moment / area), area, text});
}

template <class Real>
void Clips<Real>::see_body(const BodyView& body, const At& at) {
  if (!std::exchange(has_changed_, false) && body.surface.revision == seen_) return;
  seen_ = body.surface.revision;
  for (std::size_t i = 0; i < carriers_.size(); ++i) find_open(i, body.surface, at);
}

}  // namespace lobe
