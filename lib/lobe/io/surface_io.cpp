#include "lobe/io/surface_io.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>

#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/file/scanner.h"
#include "lobe/io/vtk_xml_write.h"
#include "lobe/text.h"

namespace lobe {
namespace {

static_assert(std::endian::native == std::endian::little, "STL and PLY are written as they are in memory");

using Points = Mat3X<double>;

void write_obj(io::AtomicFile& file, const Points& points, const Triangles& triangles) {
  for (const auto& p : points.colwise())
    file.stream() << "v " << exact(p[0]) << ' ' << exact(p[1]) << ' ' << exact(p[2]) << '\n';
  for (const auto& t : triangles.colwise())
    file.stream() << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
}

void write_off(io::AtomicFile& file, const Points& points, const Triangles& triangles) {
  file.stream() << "OFF\n" << points.cols() << ' ' << triangles.cols() << " 0\n";
  for (const auto& p : points.colwise())
    file.stream() << exact(p[0]) << ' ' << exact(p[1]) << ' ' << exact(p[2]) << '\n';
  for (const auto& t : triangles.colwise())
    file.stream() << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
}

std::string ply_property(const DataArray& array, const std::string& place) {
  if (array.values.rows() != 1)
    throw InputError(place, "array '" + array.name + "' has several components: use .vtp or .vtu");
  std::string name = array.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return (array.type == DataArray::Type::int32 ? "property int " : "property double ") + name + "\n";
}

void write_ply(io::AtomicFile& file, const Points& points, const Triangles& triangles,
               const std::vector<DataArray>& data, const std::string& place) {
  file.stream() << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.cols()
                << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
                << triangles.cols() << "\nproperty list uchar int vertex_indices\n";
  for (const DataArray& array : data) file.stream() << ply_property(array, place);
  file.stream() << "end_header\n";
  file.write(points.data(), static_cast<std::size_t>(points.size()) * sizeof(double));
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    file.stream().put(3);
    file.write(triangles.col(t).data(), 3 * sizeof(Index));
    for (const DataArray& array : data) {
      const double value = array.values(0, t);
      const auto whole = static_cast<std::int32_t>(value);
      if (array.type == DataArray::Type::int32)
        file.write(&whole, sizeof whole);
      else
        file.write(&value, sizeof value);
    }
  }
}

void write_stl(io::AtomicFile& file, const Points& points, const Triangles& triangles) {
  char header[80] = "binary STL";
  file.write(header, sizeof header);
  const auto count = static_cast<std::uint32_t>(triangles.cols());
  file.write(&count, sizeof count);
  for (const auto& t : triangles.colwise()) {
    const Vec3d a = points.col(t[0]), b = points.col(t[1]), c = points.col(t[2]);
    Eigen::Matrix<float, 3, 4> facet;
    facet << (b - a).cross(c - a).normalized().cast<float>(), a.cast<float>(), b.cast<float>(),
        c.cast<float>();
    file.write(facet.data(), sizeof(float) * 12);
    const std::uint16_t attributes = 0;
    file.write(&attributes, sizeof attributes);
  }
}

}  // namespace

void write_surface(const std::filesystem::path& file, const Mat3X<double>& points, const Triangles& triangles,
                   const std::vector<DataArray>& data) {
  const std::string extension = io::lower_case(file.extension().string());
  const bool is_vtk = extension == ".vtp" || extension == ".vtu", is_ply = extension == ".ply";
  const auto write = extension == ".obj"   ? write_obj
                     : extension == ".off" ? write_off
                     : extension == ".stl" ? write_stl
                                           : nullptr;
  if (!write && !is_vtk && !is_ply)
    throw InputError(file.string(),
                     "unknown extension '" + extension + "', expected .obj, .off, .ply, .stl, .vtp or .vtu");
  if (write && !data.empty())
    throw InputError(file.string(), "the format holds no data of triangles: use .vtp, .vtu or .ply");
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    if (triangles.col(t).minCoeff() < 0 || triangles.col(t).maxCoeff() >= points.cols())
      throw InputError(file.string(), "triangle " + std::to_string(t) + " names a vertex beyond 0 … " +
                                          std::to_string(points.cols() - 1));
  for (const DataArray& array : data)
    if (array.values.cols() != triangles.cols())
      throw InputError(file.string(), "array '" + array.name + "' has not one value per triangle");
  if (is_vtk) return io::write_vtk_triangles(file, points, triangles, data);
  io::AtomicFile target(file);
  if (is_ply)
    write_ply(target, points, triangles, data, file.string());
  else
    write(target, points, triangles);
  target.commit();
}

}  // namespace lobe
