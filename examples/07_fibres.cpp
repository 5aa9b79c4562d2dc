// What fibres do. A cylinder that is held at one end bends under its own weight: fibres along it stiffen it,
// fibres across do not, and fibres at 45 degrees in a level plane twist it. The left ventricle of a heart,
// held at its base and pulled at its apex, twists as well, and does not if it is isotropic.
//
//   build/bin/07_fibres out/fibres && build/bin/lobe-picture out/fibres/pictures.json
//   cylinder, fibres along:         its end sinks by 14.36 mm and turns by   0.03 degrees
//   (and a row for each of the other cases; a picture of each in the folder)
#include <lobe/lobe.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace {

using lobe::Index;
using lobe::Vec3d;
// E_L, E_T [Pa], ν_LT, ν_TT, G_LT [Pa]
constexpr lobe::TransverseConstants muscle{1.2e5, 3e4, 0.4, 0.4, 1.2e4};
constexpr lobe::TransverseConstants isotropic{3e4, 3e4, 0.4, 0.4, 3e4 / 2.8};

lobe::Setup body_of(const lobe::TetMesh& mesh, const lobe::TransverseConstants& constants) {
  lobe::Setup setup;
  setup.mesh = mesh;
  setup.materials = {{0, 0, 1050}};  // [kg/m³]
  lobe::set_transverse(constants, setup.materials[0]);
  setup.material_of.assign(std::size_t(mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(mesh.tet_count()), lobe::RegionModel::nonlinear);
  return setup;
}

void hold(lobe::Setup& setup, const auto& where) {
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (where(Vec3d(setup.mesh.points.col(v)))) setup.prescribed.push_back({v, {0, 0, 0}});
}

// By how much the vertices near a height have turned about the z axis through their mean [degrees].
double twist(const lobe::TetMesh& mesh, const lobe::Mat3X<double>& u, double z, double near) {
  Vec3d middle = Vec3d::Zero(), moved = Vec3d::Zero();
  std::vector<Index> slice;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (std::abs(mesh.points(2, v) - z) < near) slice.push_back(v);
  for (Index v : slice) {
    middle += mesh.points.col(v) / double(slice.size());
    moved += (mesh.points.col(v) + u.col(v)) / double(slice.size());
  }
  double across = 0, along = 0;
  for (Index v : slice) {
    const Vec3d a = mesh.points.col(v) - middle, b = mesh.points.col(v) + u.col(v) - moved;
    across += a.x() * b.y() - a.y() * b.x();
    along += a.x() * b.x() + a.y() * b.y();
  }
  return std::atan2(across, along) * 180 / std::numbers::pi;
}

void write(const std::string& file, const lobe::Setup& setup, const lobe::Mat3X<double>& u) {
  if (!file.empty())
    lobe::write_frame(file, lobe::Elements(setup), u, lobe::Mat3X<double>::Zero(3, u.cols()));
}

// By how much the end of a cylinder sinks and turns under its own weight.
void hang(const char* name, const Vec3d& fibre, const std::string& file) {
  lobe::Setup setup = body_of(lobe::cylinder_mesh(0.02, 0.1, 3, 12), muscle);
  setup.mesh.fibres = fibre.normalized().replicate(1, setup.mesh.tet_count());
  setup.gravity = {0, -9.81, 0};
  hold(setup, [](const Vec3d& x) { return x.z() < 1e-9; });
  const lobe::Mat3X<double> u = lobe::solve_static(setup).u;
  std::printf("cylinder, fibres %-14s its end sinks by %5.2f mm and turns by %6.2f degrees\n", name,
              -1e3 * u.row(1).minCoeff(), twist(setup.mesh, u, 0.1, 1e-9));
  write(file, setup, u);
}

// By how much the apex of a ventricle turns when it is pulled down by 10 mm.
void pull(const char* name, const lobe::TransverseConstants& constants, const std::string& file) {
  const lobe::VentricleShape shape;
  lobe::Setup setup = body_of(lobe::ventricle_mesh(shape, 10, 2), constants);
  hold(setup, [&](const Vec3d& x) { return x.z() > shape.base - 1e-9; });
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < -0.052)
      setup.prescribed.push_back({v, {0, 0, -0.01}, {false, false, true}});
  const lobe::Mat3X<double> u = lobe::solve_static(setup).u;
  std::printf("ventricle, %-20s its apex turns by %6.2f degrees\n", name,
              twist(setup.mesh, u, -0.055, 0.004));
  write(file, setup, u);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : "";
  const auto file = [&](const char* name) { return folder.empty() ? "" : folder + "/" + name; };
  if (!folder.empty()) std::filesystem::create_directories(folder);
  hang("along:", {0, 0, 1}, file("along.vtu"));
  hang("across:", {1, 0, 0}, file("across.vtu"));
  hang("at 45 degrees:", {1, 0, 1}, file("oblique.vtu"));
  pull("with fibres:", muscle, file("ventricle.vtu"));
  pull("isotropic:", isotropic, file("isotropic.vtu"));
  if (folder.empty()) return 0;
  std::ofstream(folder + "/pictures.json") << R"({"pictures": [
  {"out": "fibres_cylinder.png", "size": [1600, 700],
   "camera": {"direction": [1, 0.5, 0.35], "up": [0, 1, 0]},
   "panels": [{"mesh": "along.vtu", "title": "along", "fibres": true},
              {"mesh": "across.vtu", "title": "across", "fibres": true},
              {"mesh": "oblique.vtu", "title": "at 45 degrees", "fibres": true}]},
  {"out": "fibres_twist.png", "size": [1600, 700], "camera": {"direction": [0, 0, 1], "up": [0, 1, 0]},
   "panels": [{"mesh": "along.vtu", "title": "along", "edges": true},
              {"mesh": "across.vtu", "title": "across", "edges": true},
              {"mesh": "oblique.vtu", "title": "at 45 degrees", "edges": true}]},
  {"out": "fibres_ventricle.png", "size": [1600, 900], "camera": {"direction": [0.6, -1, 0.45]},
   "panels": [{"mesh": "isotropic.vtu", "title": "isotropic", "color": "von_mises"},
              {"mesh": "ventricle.vtu", "title": "with fibres", "color": "von_mises", "fibres": true}]}]})"
                                           << "\n";
}
