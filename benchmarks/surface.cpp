// lobe bench surface: what it costs to follow cuts with the surface, against finding it anew, and to draw it.
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <numeric>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "benchmarks/timing.h"
#include "lobe/fem/body.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/refine.h"
#include "lobe/mesh/surface.h"

namespace lobe::bench {
namespace {

constexpr Index tets_per_edit = 10;  // tetrahedra of one cut

struct SurfaceRow {
  std::string mesh;
  Index tets = 0, triangles = 0, cuts = 0;
  double remove_us = 0, follow_us = 0, rebuild_us = 0;  // per cut
  double changed_triangles = 0;                         // slots per cut
  double positions_ns = 0, normals_ns = 0;              // per vertex of the surface
  double reference_ns = 0;                              // a copy of the positions, per vertex
};

// Tetrahedra from one on the surface inwards, breadth first, ten at a time: an instrument that digs.
std::vector<std::vector<Index>> pits(const Topology& topology, Index count) {
  std::vector<std::vector<Index>> all;
  Topology probe(topology);
  const std::vector<Index>& faces = topology.boundary_faces();
  std::vector<std::uint8_t> taken(std::size_t(topology.tet_count()), 0);
  for (Index i = 0; i < count; ++i) {
    const Index first = faces[std::size_t(i) * faces.size() / std::size_t(count)] / 4;
    std::vector<Index> pit;
    probe.visit_piece(first, [&](Index t) {
      if (!taken[t]) pit.push_back(t);
      return Index(pit.size()) == tets_per_edit;
    });
    for (Index t : pit) taken[t] = 1;
    all.push_back(std::move(pit));
  }
  return all;
}

void check(const Surface& surface, const Topology& topology, const TetMesh& mesh,
           const std::vector<RegionModel>& regions) {
  const Surface fresh(topology, regions);
  Index cut = 0, fresh_cut = 0;
  for (const std::uint8_t c : surface.mesh().cut) cut += c;
  for (const std::uint8_t c : fresh.mesh().cut) fresh_cut += c;
  Mat3X<double> points(3, topology.vertex_count()), x;
  for (Index v = 0; v < topology.vertex_count(); ++v) points.col(v) = mesh.points.col(topology.origin(v));
  update_positions(surface.mesh(), points, 0 * points, x);
  double volume = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (topology.alive(t)) volume += signed_volume(tet_points(mesh, t));
  const bool same = surface.mesh().triangle_count() == fresh.mesh().triangle_count() &&
                    surface.mesh().vertex_count() == fresh.mesh().vertex_count() && cut == fresh_cut;
  if (!same || std::abs(enclosed_volume(surface.mesh(), x) / volume - 1) > 1e-12)
    throw WrongResult("the surface that followed cuts is not the one built afresh");
}

void time_frame(const SurfaceMesh& surface, const TetMesh& mesh, Index mesh_vertices, SurfaceRow& row) {
  Mat3X<double> X = Mat3X<double>::Zero(3, mesh_vertices);
  X.leftCols(mesh.vertex_count()) = mesh.points;
  const Mat3X<float> u = Mat3X<float>::Zero(3, mesh_vertices);
  Mat3X<float> x, copied, normals;
  const auto samples = sample_in_turn({{[&] { update_positions(surface, X, u, x); }},
                                       {[&] { update_normals(surface, x, normals); }},
                                       {[&] { copied = x; }}},
                                      {});
  const double per_vertex = 1e9 / surface.vertex_count();
  row.positions_ns = per_vertex * median(samples[0]);
  row.normals_ns = per_vertex * median(samples[1]);
  row.reference_ns = per_vertex * median(samples[2]);
}

SurfaceRow measure(const std::string& name, const TetMesh& mesh, Index cuts) {
  SurfaceRow row{name, mesh.tet_count()};
  row.cuts = cuts;
  const std::vector<RegionModel> regions(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  Topology topology(mesh);
  Surface surface(topology, regions);
  const std::vector<std::vector<Index>> order = pits(topology, cuts);
  for (const std::vector<Index>& tets : order) {
    const Stopwatch removing(true);
    const MeshEdit edit = topology.remove(tets);
    row.remove_us += 1e6 * removing.seconds() / cuts;
    const std::uint64_t before = surface.revision();
    const Stopwatch following(true);
    surface.follow(topology, edit, regions);
    row.follow_us += 1e6 * following.seconds() / cuts;
    if (const auto changed = surface.mesh().changed_triangles.since(before))
      row.changed_triangles += double(changed->size()) / cuts;
  }
  check(surface, topology, mesh, regions);
  const Stopwatch rebuilding(true);
  surface.rebuild(topology, regions);
  row.rebuild_us = 1e6 * rebuilding.seconds();
  row.triangles = surface.mesh().triangle_count();
  time_frame(surface.mesh(), mesh, topology.vertex_count(), row);
  return row;
}

void print(const SurfaceRow& r) {
  std::printf("%-20s %8d %9d %5d %9.2f %9.2f %10.0f %8.1f %12.2f %10.2f %7.2f\n", r.mesh.c_str(), r.tets,
              r.triangles, r.cuts, r.remove_us, r.follow_us, r.rebuild_us, r.changed_triangles,
              r.positions_ns, r.normals_ns, r.reference_ns);
  std::fflush(stdout);
}

std::string csv(const std::vector<SurfaceRow>& rows) {
  std::ostringstream out;
  out << "mesh,tets,triangles,cuts,remove_us,follow_us,rebuild_us,changed_triangles,positions_ns,normals_ns,"
         "copy_ns\n"
      << std::setprecision(4);
  for (const SurfaceRow& r : rows)
    out << r.mesh << ',' << r.tets << ',' << r.triangles << ',' << r.cuts << ',' << r.remove_us << ','
        << r.follow_us << ',' << r.rebuild_us << ',' << r.changed_triangles << ',' << r.positions_ns << ','
        << r.normals_ns << ',' << r.reference_ns << '\n';
  return out.str();
}

}  // namespace

void bench_surface(const Options& options) {
  begin_results(options.output, "surface");
  std::printf("\n%-20s %8s %9s %5s %9s %9s %10s %8s %12s %10s %7s\n", "mesh", "tets", "triangles", "cuts",
              "remove us", "follow us", "rebuild us", "changed", "positions ns", "normals ns", "copy ns");
  const std::filesystem::path meshes = std::filesystem::path(LOBE_DATA_DIR) / "meshes";
  std::vector<SurfaceRow> rows;
  const auto run = [&](const std::string& name, TetMesh mesh, int refined) {
    for (int i = 0; i < refined; ++i) mesh = refine(mesh).mesh;
    print(rows.emplace_back(measure(name, mesh, options.quick ? 20 : 100)));
  };
  run("liver_10k", read_mesh(meshes / "liver_10k.vtu").mesh, 0);
  run("liver_10k refined", read_mesh(meshes / "liver_10k.vtu").mesh, 1);
  run("liver_2k refined 2x", read_mesh(meshes / "liver_2k.vtu").mesh, 2);
  if (!options.quick) run("liver_10k refined 2x", read_mesh(meshes / "liver_10k.vtu").mesh, 2);
  io::write_file(options.output / "surface.csv", csv(rows));
}

}  // namespace lobe::bench
