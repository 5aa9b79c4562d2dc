#include "gauge.h"

#include "lobe/diagnostics/fields.h"

namespace lobe::view {
namespace {

// Means over the triangles around each vertex, of the tetrahedra behind them.
template <class Real>
void find_field(World<Real>& world, bool is_stress, std::vector<float>& values) {
  const SurfaceMesh& surface = world.surface().mesh();
  const Elements& elements = world.elements();
  const Mat3X<double> u = world.displacements().template cast<double>();
  std::vector<float> triangles_at(std::size_t(surface.vertex_count()), 0);
  values.assign(triangles_at.size(), 0);
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const Index tet = surface.owner[i].tet;
    const Eigen::Vector4i corners = elements.topology.corners(tet);
    Mat34<double> of_corners;
    for (int c = 0; c < 4; ++c) of_corners.col(c) = u.col(corners[c]);
    const TetFields fields = tet_fields(elements, tet, of_corners, 0);
    for (const int v : surface.triangles[i]) {
      values[std::size_t(v)] += static_cast<float>(is_stress ? fields.von_mises : fields.volume_ratio);
      triangles_at[std::size_t(v)] += 1;
    }
  }
  for (std::size_t v = 0; v < values.size(); ++v)
    if (triangles_at[v] > 0) values[v] /= triangles_at[v];
}

}  // namespace

template <class Real>
void measure(World<Real>& world, const std::string& scalar, Measured& measured) {
  const Energies energies = world.energies();
  measured.time = world.time();
  measured.elastic = energies.elastic_linear + energies.elastic_nonlinear;
  measured.kinetic = energies.kinetic;
  measured.scalar = scalar;
  measured.revision = world.surface().revision();
  if (scalar == "none")
    measured.values.clear();
  else
    find_field(world, scalar == "von_mises", measured.values);
}

template void measure(World<float>&, const std::string&, Measured&);
template void measure(World<double>&, const std::string&, Measured&);

}  // namespace lobe::view
