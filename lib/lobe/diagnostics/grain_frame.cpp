#include "lobe/diagnostics/grain_frame.h"

#include "lobe/diagnostics/averaged_pressures.h"
#include "lobe/diagnostics/fields.h"
#include "lobe/io/mesh_io.h"

namespace lobe {
namespace {

using Type = DataArray::Type;

Mat34<double> at_corners(const Elements& elements, Index tet, const Mat3X<double>& values) {
  return values(Eigen::all, elements.topology.corners(tet));
}

// Interpolates the vertices' values at a place in a tetrahedron.
Vec3d at_place(const Elements& elements, Index tet, const Mat34<double>& values, const Vec3d& X) {
  const Mat3<double> alpha = elements.shape_of(tet).gradients.rightCols<3>();
  const Vec3d start = elements.points.col(elements.topology.corners(tet)[0]);
  return values.col(0) + displacement_gradient<double>(values, alpha) * (X - start);
}

struct Cells {
  explicit Cells(Eigen::Index n)
      : region{"region", Eigen::MatrixXd(1, n), Type::int32},
        source{"source", Eigen::MatrixXd(1, n), Type::int32},
        parent{"parent", Eigen::MatrixXd(1, n), Type::int32},
        skin{"skin", Eigen::MatrixXd(1, n), Type::int32},
        stroke{"stroke", Eigen::MatrixXd(1, n), Type::int32},
        ratio{"volume_ratio", Eigen::MatrixXd(1, n), Type::float32},
        density{"density", Eigen::MatrixXd(1, n), Type::float32},
        von_mises{"von_mises", Eigen::MatrixXd(1, n), Type::float32} {}
  DataArray region, source, parent, skin, stroke, ratio, density, von_mises;
};

}  // namespace

void write_grain_frame(const std::filesystem::path& file, const Elements& elements, const Grains& grains,
                       const Mat3X<double>& u, const Mat3X<double>& v,
                       const std::vector<std::uint8_t>& is_embedded) {
  std::vector<Index> there;
  for (Index g = 0; g < grains.count(); ++g)
    if (elements.topology.alive(grains[g].element)) there.push_back(g);
  const auto n = static_cast<Eigen::Index>(there.size());
  TetMesh mesh{Mat3X<double>(3, grains.point_count()), Tets(4, n), {}};
  for (Index p = 0; p < grains.point_count(); ++p) mesh.points.col(p) = grains.point(p);
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(3, grains.point_count()), speeds = moved;
  Cells cells(n);
  const std::vector<double> pressures = averaged_pressures(elements, u);
  for (Eigen::Index at = 0; at < n; ++at) {
    const Grains::Grain& grain = grains[there[std::size_t(at)]];
    const Index t = grain.element;
    const Mat34<double> own_u = at_corners(elements, t, u), own_v = at_corners(elements, t, v);
    mesh.tets.col(at) = grain.points;
    mesh.labels.push_back(elements.label_of(t));
    for (Index p : grain.points) {
      moved.col(p) = at_place(elements, t, own_u, grains.point(p));
      speeds.col(p) = at_place(elements, t, own_v, grains.point(p));
    }
    const TetFields fields = tet_fields(elements, t, own_u, pressures[t]);
    cells.region.values(0, at) = static_cast<int>(elements.region_of[t]);
    cells.source.values(0, at) = t;
    cells.parent.values(0, at) = elements.topology.parent(t);
    cells.skin.values(0, at) = grain.boundary;
    cells.stroke.values(0, at) = grain.stroke;
    cells.ratio.values(0, at) = fields.volume_ratio;
    cells.density.values(0, at) = elements.elastic_of(t).density;
    cells.von_mises.values(0, at) = fields.von_mises;
  }
  std::vector<DataArray> all{cells.region, cells.source, cells.parent,  cells.skin,
                             cells.stroke, cells.ratio,  cells.density, cells.von_mises};
  std::vector<Index> tets;
  for (const Index g : there) tets.push_back(grains[g].element);
  if (elements.bodies.any()) all.push_back(body_cells(elements, tets));
  if (!is_embedded.empty()) all.push_back(embedded_cells(elements, tets, is_embedded));
  write_vtu(file, mesh, {{"displacement", moved, Type::float64}, {"velocity", speeds, Type::float64}}, all);
}

}  // namespace lobe
