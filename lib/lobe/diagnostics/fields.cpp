#include "lobe/diagnostics/fields.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lobe/diagnostics/averaged_pressures.h"
#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"
#include "lobe/region/energy_density.h"

namespace lobe {
namespace {

Eigen::Matrix<double, 6, 1> voigt(const Mat3<double>& a) {
  return {a(0, 0), a(1, 1), a(2, 2), a(0, 1), a(1, 2), a(0, 2)};
}

Mat34<double> corner_displacements(const Elements& elements, Index tet, const Mat3X<double>& u) {
  Mat34<double> corners;
  for (int c = 0; c < 4; ++c) corners.col(c) = u.col(elements.topology.tets()(c, tet));
  return corners;
}

}  // namespace

TetFields tet_fields(const Elements& elements, Index tet, const Mat34<double>& u, double pressure) {
  const Shape s = elements.shape_of(tet);
  const Mat3<double> H = displacement_gradient<double>(u, s.gradients.rightCols<3>());
  TetFields fields;
  fields.volume_ratio = 1 + volume_change(H);
  fields.stress = stress(elements, tet, H, elements.region_of[tet], pressure);
  if (!is_linear(elements.region_of[tet])) {
    const Mat3<double> F = Mat3<double>::Identity() + H;
    fields.strain = green_strain(H);
    fields.stress = fields.stress * F.transpose() / fields.volume_ratio;
  } else {
    fields.strain = (H + H.transpose()) / 2;
  }
  const Mat3<double> deviator = fields.stress - fields.stress.trace() / 3 * Mat3<double>::Identity();
  fields.von_mises = std::sqrt(1.5) * deviator.norm();
  return fields;
}

void write_frame(const std::filesystem::path& file, const Elements& elements, const Mat3X<double>& u,
                 const Mat3X<double>& v, const std::vector<std::uint8_t>& is_embedded,
                 const Mat3X<double>& reactions) {
  using Type = DataArray::Type;
  const Topology& topology = elements.topology;
  const Eigen::Index n = topology.alive_count();
  TetMesh mesh{elements.points.view(), Tets(4, n), {}};
  if (elements.fibres.cols() > 0) mesh.fibres.resize(3, n);
  DataArray region{"region", Eigen::MatrixXd(1, n), Type::int32},
      source{"source", Eigen::MatrixXd(1, n), Type::int32};
  DataArray ratio{"volume_ratio", Eigen::MatrixXd(1, n), Type::float32},
      density{"density", Eigen::MatrixXd(1, n), Type::float32};
  DataArray strain{"strain", Eigen::MatrixXd(6, n), Type::float32},
      stress{"stress", Eigen::MatrixXd(6, n), Type::float32};
  DataArray von_mises{"von_mises", Eigen::MatrixXd(1, n), Type::float32};
  const std::vector<double> pressures = averaged_pressures(elements, u);
  std::vector<Index> there;
  for (Index t = 0; t < topology.tet_count(); ++t)
    if (topology.alive(t)) there.push_back(t);
  Eigen::Index at = 0;
  for (const Index t : there) {
    const TetFields fields = tet_fields(elements, t, corner_displacements(elements, t, u), pressures[t]);
    mesh.tets.col(at) = topology.tets().col(t);
    if (mesh.fibres.cols() > 0) mesh.fibres.col(at) = elements.fibres.col(t);
    mesh.labels.push_back(elements.label_of(t));
    region.values(0, at) = static_cast<int>(elements.region_of[t]);
    source.values(0, at) = t;
    ratio.values(0, at) = fields.volume_ratio;
    density.values(0, at) = elements.elastic_of(t).density;
    strain.values.col(at) = voigt(fields.strain);
    stress.values.col(at) = voigt(fields.stress);
    von_mises.values(0, at) = fields.von_mises;
    ++at;
  }
  std::vector<DataArray> cells;
  for (DataArray* array : {&region, &ratio, &strain, &stress, &von_mises, &density, &source})
    cells.push_back(std::move(*array));
  if (elements.bodies.any()) cells.push_back(body_cells(elements, there));
  if (!is_embedded.empty()) cells.push_back(embedded_cells(elements, there, is_embedded));
  std::vector<DataArray> points{{"displacement", u, Type::float64}, {"velocity", v, Type::float64}};
  if (reactions.cols() > 0) points.push_back({"reaction", reactions, Type::float64});
  write_vtu(file, mesh, points, cells);
}

DataArray body_cells(const Elements& elements, const std::vector<Index>& tets) {
  DataArray array{"body", Eigen::MatrixXd(1, tets.size()), DataArray::Type::int32};
  for (std::size_t i = 0; i < tets.size(); ++i)
    array.values(0, Eigen::Index(i)) = elements.bodies.body_of(tets[i]);
  return array;
}

DataArray embedded_cells(const Elements& elements, const std::vector<Index>& tets,
                         const std::vector<std::uint8_t>& is_embedded) {
  DataArray array{"embedded", Eigen::MatrixXd(1, tets.size()), DataArray::Type::int32};
  for (std::size_t i = 0; i < tets.size(); ++i) {
    const auto corners = elements.topology.corners(tets[i]);
    array.values(0, Eigen::Index(i)) =
        std::all_of(corners.begin(), corners.end(), [&](Index v) { return is_embedded[std::size_t(v)]; });
  }
  return array;
}

double current_volume(const Elements& elements, const Mat3X<double>& u) {
  double volume = 0;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t))
      volume += elements.share_of(t) *
                signed_volume(elements.corner_points(t) + corner_displacements(elements, t, u));
  return volume;
}

}  // namespace lobe
