#include "lobe_petsc/solve_scene.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "lobe/diagnostics/fields.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/read_scene.h"
#include "lobe_petsc/clock.h"
#include "lobe_petsc/resolve_part.h"

namespace lobe::petsc {
namespace {

using Json = nlohmann::ordered_json;

double peak_memory() {  // of this process [byte]
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * double(usage.ru_maxrss);
}

std::string piece_name(int rank) {
  char name[32];
  std::snprintf(name, sizeof name, "solution_%04d.vtu", rank);
  return name;
}

void write_piece(const std::filesystem::path& file, int rank, const Part& part, const Elements& elements,
                 const Mat3X<double>& u) {
  const Index tets = part.mesh.tet_count(), vertices = part.mesh.vertex_count();
  Eigen::MatrixXd ratio(1, tets), stress(1, tets), region(1, tets), source(1, tets), number(1, vertices);
  for (Index t = 0; t < tets; ++t) {
    Mat34<double> corners;
    for (int c = 0; c < 4; ++c) corners.col(c) = u.col(part.mesh.tets(c, t));
    const TetFields fields = tet_fields(elements, t, corners, 0);
    ratio(t) = fields.volume_ratio;
    stress(t) = fields.von_mises;
    region(t) = int(elements.region_of[t]);
    source(t) = part.tet_number[t];
  }
  for (Index v = 0; v < vertices; ++v) number(v) = part.vertex_number[v];
  using enum DataArray::Type;
  TetMesh mesh = part.mesh;
  mesh.fibres.resize(3, 0);  // a piece without them would have another set of arrays
  write_vtu(file, mesh, {{"displacement", u}, {"vertex", number, int32}},
            {{"region", region, int32},
             {"volume_ratio", ratio, float32},
             {"von_mises", stress, float32},
             {"source", source, int32},
             {"rank", Eigen::MatrixXd::Constant(1, tets, rank), int32}});
}

std::string index_of_pieces(int ranks) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n <PUnstructuredGrid GhostLevel=\"0\">\n"
      "  <PPointData>\n   <PDataArray type=\"Float64\" Name=\"displacement\" NumberOfComponents=\"3\"/>\n"
      "   <PDataArray type=\"Int32\" Name=\"vertex\" NumberOfComponents=\"1\"/>\n  </PPointData>\n  "
      "<PCellData>\n";
  for (const char* array : {"type=\"Int32\" Name=\"label\"", "type=\"Int32\" Name=\"region\"",
                            "type=\"Float32\" Name=\"volume_ratio\"", "type=\"Float32\" Name=\"von_mises\"",
                            "type=\"Int32\" Name=\"source\"", "type=\"Int32\" Name=\"rank\""})
    text += std::string("   <PDataArray ") + array + " NumberOfComponents=\"1\"/>\n";
  text +=
      "  </PCellData>\n  <PPoints>\n   <PDataArray type=\"Float64\" Name=\"Points\" "
      "NumberOfComponents=\"3\"/>\n"
      "  </PPoints>\n";
  for (int r = 0; r < ranks; ++r) text += "  <Piece Source=\"" + piece_name(r) + "\"/>\n";
  return text + " </PUnstructuredGrid>\n</VTKFile>\n";
}

// Writes the index after all pieces. So no index names pieces of two runs.
void write_solution(const Ranks& ranks, const std::filesystem::path& directory, const Part& part,
                    const Elements& elements, const Mat3X<double>& u) {
  ranks.together([&] {
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (!std::filesystem::is_directory(directory, error))
      throw InputError(directory.string(), "cannot be made a directory for the results");
    if (ranks.rank() == 0) std::filesystem::remove(directory / "solution.pvtu", error);
  });
  ranks.together([&] { write_piece(directory / piece_name(ranks.rank()), ranks.rank(), part, elements, u); });
  ranks.together([&] {
    if (ranks.rank() == 0) io::write_file(directory / "solution.pvtu", index_of_pieces(ranks.count()));
  });
}

struct Run {  // what the report tells
  SceneOptions options;
  std::string scene;
  Part part;
  Solution solution;
  double reading = 0, partition = 0, resolving = 0, writing = 0, wall = 0;  // [s]
  std::vector<std::string> warnings = {};
};

Json report_of(const Ranks& ranks, const Run& run) {
  const Solution& s = run.solution;
  const std::vector<double> memory = ranks.gather(peak_memory());
  const double largest = std::sqrt(ranks.max(s.u.colwise().squaredNorm().maxCoeff()));
  return {{"ok", s.converged},
          {"scene", run.scene},
          {"solver", "petsc"},
          {"method", s.method},
          {"ranks", ranks.count()},
          {"tetrahedra", run.part.all_tets},
          {"vertices", run.part.all_owned},
          {"unknowns", s.unknowns},
          {"load_fraction", s.load_fraction},
          {"relative_residual", s.residual},
          {"newton_iterations", s.newton_iterations},
          {"linear_iterations", s.linear_iterations},
          {"most_linear_iterations", s.most_linear_iterations},
          {"load_steps", s.load_steps},
          {"tangent_nonzeros", s.nonzeros},
          {"elastic_energy", s.energy},
          {"largest_displacement", largest},
          {"smallest_volume_ratio", s.smallest_volume_ratio},
          {"tetrahedra_of_rank", ranks.gather(double(run.part.mesh.tet_count()))},
          {"ghost_vertices_of_rank", ranks.gather(double(run.part.mesh.vertex_count() - run.part.owned))},
          {"peak_memory_bytes_of_rank", memory},
          {"halo_bytes_of_rank", ranks.gather(double(s.ghost_bytes))},
          {"wall_s", run.wall},
          {"seconds",
           {{"read", run.reading},
            {"partition", run.partition},
            {"resolve", run.resolving},
            {"forces", s.seconds.forces},
            {"assembly", s.seconds.assembly},
            {"preconditioner", s.seconds.setup},
            {"linear_solver", s.seconds.solve},
            {"write", run.writing}}},
          {"warnings", run.warnings}};
}

void print(const Run& run, const Json& report) {
  if (run.options.json) {
    std::printf("%s\n", report.dump(1).c_str());
    return;
  }
  const Solution& s = run.solution;
  std::printf(
      "%d tetrahedra on %d ranks, %s: %s at %.4g %% of the load\n"
      "residual %.2g after %d Newton and %d linear iterations in %.2f s\n"
      "largest displacement %.6g m, elastic energy %.6g J\n",
      run.part.all_tets, report["ranks"].get<int>(), s.method.c_str(),
      s.converged ? "equilibrium" : "stopped", 100 * s.load_fraction, s.residual, s.newton_iterations,
      s.linear_iterations, run.wall, report["largest_displacement"].get<double>(), s.energy);
  for (const std::string& warning : run.warnings)
    std::fprintf(stderr, "lobe: warning: %s\n", warning.c_str());
}

}  // namespace

bool solve_scene(const Ranks& ranks, const SceneOptions& options) {
  Run run{options, options.scene.string(), {}, {}};
  SolverOptions solver;
  solver.tolerance = options.tolerance;
  solver.method = method_of(options.method, available_methods());
  if (options.verbose)
    solver.tell = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  const auto start = Clock::now();
  Scene scene;
  ranks.together([&] { scene = read_scene(options.scene); });
  if (!options.mesh.empty()) scene.mesh = std::filesystem::absolute(options.mesh);
  if (!scene.bodies.empty())
    throw InputError("/bodies", "lobe-petsc solves scenes of one mesh: use lobe solve");
  if (std::any_of(scene.materials.begin(), scene.materials.end(),
                  [](const Material& m) { return !m.element; }))
    run.warnings.push_back(
        "plain tetrahedra, \"element\": \"tetrahedron\": edge-smoothed ones are not available with --solver "
        "petsc");
  if (!scene.tools.empty()) run.warnings.push_back("tools are ignored in a static solution");
  const std::string name = mesh_path(scene).string();
  auto phase = Clock::now();
  MeshSlice slice = read_slice(ranks, mesh_path(scene));
  slice.mesh.points *= scene.mesh_scale;
  if (!slice.read_in_parts)
    run.warnings.push_back(name + ": rank 0 has read all of it; a .vtu as lobe writes it is read in parts");
  run.reading = ranks.max(since(phase));
  phase = Clock::now();
  run.part = make_part(ranks, std::move(slice), name);
  run.partition = ranks.max(since(phase));
  phase = Clock::now();
  const Setup setup = resolve_part(ranks, scene, run.part);
  run.resolving = ranks.max(since(phase));
  run.solution = solve_static(ranks, run.part, setup, solver);
  if (!run.solution.converged) run.warnings.push_back(run.solution.reason);
  phase = Clock::now();
  write_solution(ranks, options.output, run.part, Elements(setup), run.solution.u);
  run.writing = ranks.max(since(phase));
  run.wall = ranks.max(since(start));
  const Json report = report_of(ranks, run);
  ranks.together([&] {
    if (ranks.rank() == 0)
      io::write_file(options.output / "report.json",
                     report.dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
  });
  if (ranks.rank() == 0) print(run, report);
  return run.solution.converged;
}

}  // namespace lobe::petsc
