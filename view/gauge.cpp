#include "gauge.h"

#include <algorithm>
#include <utility>

#include "lobe/diagnostics/fields.h"

namespace lobe::view {
namespace {

// Averages a value of tetrahedra over the triangles around each vertex of the surface.
template <class OfTet>
void spread(const SurfaceMesh& surface, const OfTet& of_tet, std::vector<float>& values) {
  std::vector<float> triangles_at(std::size_t(surface.vertex_count()), 0);
  values.assign(triangles_at.size(), 0);
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto value = static_cast<float>(of_tet(surface.owner[i].tet));
    for (const int v : surface.triangles[i]) {
      values[std::size_t(v)] += value;
      triangles_at[std::size_t(v)] += 1;
    }
  }
  for (std::size_t v = 0; v < values.size(); ++v)
    if (triangles_at[v] > 0) values[v] /= triangles_at[v];
}

}  // namespace

template <class Real>
std::vector<double> Gauge<Real>::pressures(const World<Real>& world, const Mat3X<double>& u) {
  const Elements& elements = world.elements();
  if (!any_nodal_pressure(elements.materials))
    return std::vector<double>(std::size_t(elements.topology.tet_count()), 0);
  if (averages_edits_.read(world).any()) averages_.emplace(elements);
  return tet_pressures(elements, *averages_, u);
}

template <class Real>
void Gauge<Real>::find_stress(World<Real>& world, bool is_stress, std::vector<float>& values) {
  const Elements& elements = world.elements();
  const Mat3X<double> u = world.displacements().template cast<double>();
  const std::vector<double> pressure = pressures(world, u);
  const auto of_tet = [&](Index tet) {
    const Eigen::Vector4i corners = elements.topology.corners(tet);
    Mat34<double> of_corners;
    for (int c = 0; c < 4; ++c) of_corners.col(c) = u.col(corners[c]);
    const TetFields fields = tet_fields(elements, tet, of_corners, pressure[std::size_t(tet)]);
    return is_stress ? fields.von_mises : fields.volume_ratio;
  };
  spread(world.surface().mesh(), of_tet, values);
}

// Vertices that hands hold count as free, so that near them the estimate is too high.
template <class Real>
void Gauge<Real>::find_error(World<Real>& world, Measured& measured) {
  if (!watch_)
    watch_ = std::make_unique<LinearityWatch<Real>>(world, std::vector<std::vector<Index>>{},
                                                    LinearityOptions{.on_exceeded = {}});
  if (!reduced_ && world.body().regions.reduced().any()) {
    reduced_ = std::make_unique<ReducedWatch<Real>>(world, ReducedOptions{});
    reduced_error_ = reduced_->look(world).error;
  }
  const double error = watch_->look(world).error + reduced_error_;  // of the sum, at most
  // Compared with the rounding that is left of an old motion, an error means nothing.
  constexpr double least = 1e-6;  // of the extent of the body
  const auto points = world.elements().points.view();
  const double extent = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  most_moved_ = std::max(most_moved_, double(world.displacements().colwise().norm().maxCoeff()));
  if (most_moved_ > least * extent) measured.linear_error = error;
  const Mat3X<double>& errors = watch_->zone_errors();
  const std::vector<Index>& zone_of = watch_->zones().of;
  const Mat3X<double> of_vertices = reduced_ ? reduced_->vertex_errors(world) : Mat3X<double>(3, 0);
  const auto of_tet = [&](Index tet) {
    double sum = errors.size() > 0 ? errors.col(zone_of[std::size_t(tet)]).norm() : 0;
    for (const Index v : world.elements().topology.corners(tet))
      if (v < of_vertices.cols()) sum += of_vertices.col(v).norm() / 4;
    return sum;
  };
  spread(world.surface().mesh(), of_tet, measured.values);
}

template <class Real>
void Gauge<Real>::follow(World<Real>& world) {
  const bool is_same = std::exchange(followed_, world.time()) == world.time();  // it pauses
  if (reduced_ && !is_same) reduced_error_ = reduced_->look(world).error;
}

template <class Real>
void Gauge<Real>::measure(World<Real>& world, const std::string& scalar, Measured& measured) {
  const Energies energies = world.energies();
  measured.time = world.time();
  measured.elastic = energies.elastic_linear + energies.elastic_nonlinear;
  measured.kinetic = energies.kinetic;
  measured.linear_error = -1;
  measured.scalar = scalar;
  measured.revision = world.surface().revision();
  if (scalar != "linear_error") reduced_.reset();
  if (scalar == "none")
    measured.values.clear();
  else if (scalar == "linear_error")
    find_error(world, measured);
  else
    find_stress(world, scalar == "von_mises", measured.values);
}

template class Gauge<float>;
template class Gauge<double>;

}  // namespace lobe::view
