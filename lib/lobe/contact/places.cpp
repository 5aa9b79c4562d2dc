#include "lobe/contact/places.h"

namespace lobe {

void Places::of_points(const std::vector<int>& points, PointRows& x, PointRows& v) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    x.col(Eigen::Index(i)) = of_point(points[i]);
    v.col(Eigen::Index(i)) = velocity_of_point(points[i]);
  }
}

void Places::of_vertices(const std::vector<Index>& vertices, const std::vector<int>& to, double* x,
                         double* v) const {
  with([&](const auto& u, const auto& velocities) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::size_t place = 4 * std::size_t(to[i]);
      Eigen::Map<Vec3d>(x + place) = of_vertex_in(u, vertices[i]);
      if (v) Eigen::Map<Vec3d>(v + place) = velocities.col(vertices[i]).template cast<double>();
    }
  });
}

}  // namespace lobe
