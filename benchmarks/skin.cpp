// lobe bench skin: what a fine textured surface costs per frame, and at a cut.
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/refine.h"
#include "lobe/sim/world.h"
#include "lobe/skin/skin.h"

namespace lobe::bench {
namespace {

constexpr Index tets_per_cut = 10;  // tetrahedra of one cut

struct SkinRow {
  std::string mesh;
  Index tets = 0, vertices = 0, triangles = 0;
  double build_ms = 0;
  double update_ns = 0,
         update_double_ns = 0;  // positions and normals, per vertex; of displacements in double precision
  double copy_ns = 0;           // reference: positions and normals copied, per vertex
  double follow_us = 0;         // per cut
  double blade_us = 0;          // per tetrahedron that a blade has parted
};

// A linear field is carried exactly: displacements of it must come out as it.
void check(Skin& skin, const TexturedSurface& surface, const TetMesh& mesh) {
  const Mat3<double> F = 0.3 * Mat3<double>::Random();
  Mat3X<float> x, normals;
  skin.update(mesh.points, (F * mesh.points).eval(), x, normals);
  const Mat3X<double> X = surface.points(Eigen::all, skin.mesh().file_vertex);
  const double error = (x.cast<double>() - X - F * X).cwiseAbs().maxCoeff();
  if (!(error < 1e-6 * X.cwiseAbs().maxCoeff())) throw WrongResult("the skin does not follow affine motion");
}

void time_frame(Skin& skin, const TetMesh& mesh, SkinRow& row) {
  const Mat3X<float> u = 0.01F * Mat3X<float>::Random(3, mesh.vertex_count());
  const Mat3X<double> u_double = u.cast<double>();
  Mat3X<float> x, normals, x_copy, normals_copy;
  const auto samples = sample_in_turn({{[&] { skin.update(mesh.points, u, x, normals); }},
                                       {[&] { skin.update(mesh.points, u_double, x, normals); }},
                                       {[&] {
                                         x_copy = x;
                                         normals_copy = normals;
                                       }}},
                                      {});
  const double per_vertex = 1e9 / row.vertices;
  row.update_ns = per_vertex * median(samples[0]);
  row.update_double_ns = per_vertex * median(samples[1]);
  row.copy_ns = per_vertex * median(samples[2]);
}

// A blade goes through the body, across its longest side, in 60 frames. Per copy of a tetrahedron [µs].
double time_blade(const TexturedSurface& surface, const TetMesh& mesh) {
  constexpr double moment = 1e-4;
  constexpr int frames = 60;
  Setup setup;
  setup.mesh = mesh;
  setup.materials = {{4e4, 1e4, 1000}};
  setup.material_of.assign(std::size_t(mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  const Vec3d low = mesh.points.rowwise().minCoeff(), high = mesh.points.rowwise().maxCoeff();
  Eigen::Index longest = 0;
  (high - low).maxCoeff(&longest);
  const Eigen::Index down = (longest + 1) % 3, along = (longest + 2) % 3;
  const double reach = 0.6 * (high - low).norm();
  Vec3d from = (low + high) / 2, to = from, edge = Vec3d::Zero();
  from[down] -= reach;
  to[down] += reach;
  edge[along] = reach;
  setup.scalpels = {{"blade",
                     0.1,
                     {{moment / 2, from - edge}, {moment / 2 + frames * moment, to - edge}},
                     {from + edge, to + edge}}};
  World<float> world(setup);
  Skin skin(surface, mesh);
  double seconds = 0;
  world.on_cut([&](const Topology& topology, const MeshEdit& edit) {
    const Stopwatch following(true);
    skin.follow(topology, edit, world.grains());
    seconds += following.seconds();
  });
  for (int i = 0; i <= frames; ++i) world.advance(moment);
  if (!skin.is_divided()) throw WrongResult("a blade has not divided the skin");
  return 1e6 * seconds / world.elements().topology.tet_copy_count();
}

SkinRow measure(const std::string& name, const TetMesh& mesh, int finer, int cuts) {
  SkinRow row{name, mesh.tet_count()};
  TetMesh fine = mesh;
  for (int i = 0; i < finer; ++i) fine = refine(fine).mesh;
  const TexturedSurface surface = textured_boundary(fine);
  const Stopwatch building(true);
  Skin skin(surface, mesh);
  row.build_ms = 1e3 * building.seconds();
  row.vertices = skin.mesh().vertex_count();
  row.triangles = skin.mesh().triangle_count();
  check(skin, surface, mesh);
  time_frame(skin, mesh, row);
  Topology topology(mesh);
  for (int cut = 0; cut < cuts; ++cut) {
    const std::vector<Index>& faces = topology.boundary_faces();
    std::vector<Index> pit;
    topology.visit_piece(faces[std::size_t(cut) * faces.size() / std::size_t(cuts)] / 4, [&](Index t) {
      pit.push_back(t);
      return Index(pit.size()) == tets_per_cut;
    });
    const MeshEdit edit = topology.remove(pit);
    const Stopwatch following(true);
    skin.follow(topology, edit);
    row.follow_us += 1e6 * following.seconds() / cuts;
  }
  row.blade_us = time_blade(surface, mesh);
  return row;
}

void print(const SkinRow& r) {
  std::printf("%-20s %8d %9d %9d %9.0f %9.2f %9.2f %8.2f %9.1f %9.1f\n", r.mesh.c_str(), r.tets, r.vertices,
              r.triangles, r.build_ms, r.update_ns, r.update_double_ns, r.copy_ns, r.follow_us, r.blade_us);
  std::fflush(stdout);
}

std::string csv(const std::vector<SkinRow>& rows) {
  std::ostringstream out;
  out << "mesh,tets,vertices,triangles,build_ms,update_ns,update_double_ns,copy_ns,follow_us,blade_us\n"
      << std::setprecision(4);
  for (const SkinRow& r : rows)
    out << r.mesh << ',' << r.tets << ',' << r.vertices << ',' << r.triangles << ',' << r.build_ms << ','
        << r.update_ns << ',' << r.update_double_ns << ',' << r.copy_ns << ',' << r.follow_us << ','
        << r.blade_us << '\n';
  return out.str();
}

}  // namespace

void bench_skin(const Options& options) {
  begin_results(options.output, "skin");
  std::printf("\n%-20s %8s %9s %9s %9s %9s %9s %8s %9s %9s\n", "mesh", "tets", "vertices", "triangles",
              "build ms", "update ns", "double ns", "copy ns", "follow us", "blade us");
  const std::filesystem::path meshes = std::filesystem::path(LOBE_DATA_DIR) / "meshes";
  std::vector<SkinRow> rows;
  const int cuts = options.quick ? 10 : 50;
  print(rows.emplace_back(measure("liver_2k", read_mesh(meshes / "liver_2k.vtu").mesh, 2, cuts)));
  print(rows.emplace_back(measure("liver_10k", read_mesh(meshes / "liver_10k.vtu").mesh, 1, cuts)));
  if (!options.quick)
    print(rows.emplace_back(measure("liver_10k", read_mesh(meshes / "liver_10k.vtu").mesh, 2, cuts)));
  io::write_file(options.output / "skin.csv", csv(rows));
}

}  // namespace lobe::bench
