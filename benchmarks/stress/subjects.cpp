#include <random>

#include "benchmarks/stress/plan.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"

namespace lobe::stress {
namespace {

const std::string smoothed = "smoothed ";

std::vector<Index> vertices_between(const TetMesh& mesh, double from, double to) {
  const double low = mesh.points.row(0).minCoeff(), length = mesh.points.row(0).maxCoeff() - low;
  std::vector<Index> vertices;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const double share = (mesh.points(0, v) - low) / length;
    if (share >= from && share <= to) vertices.push_back(v);
  }
  return vertices;
}

}  // namespace

std::vector<Index> Subject::low_end() const { return vertices_between(mesh, 0, 0.1); }
std::vector<Index> Subject::high_end() const { return vertices_between(mesh, 0.9, 1); }
double Subject::length() const { return mesh.points.row(0).maxCoeff() - mesh.points.row(0).minCoeff(); }

Subject box() {
  TetMesh mesh = box_mesh(Vec3d::Constant(0.03), 3, 3, 3);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.0015, 0.0015);
  for (double& x : mesh.points.reshaped()) x += jitter(random);
  return {"box", mesh};
}

std::vector<Subject> organs(bool quick) {
  const auto shipped = [](const std::string& name) {
    return Subject{name, read_mesh(LOBE_DATA_DIR "/meshes/" + name + ".vtu").mesh};
  };
  if (quick) return {shipped("cylinder_1k")};
  return {shipped("cylinder_1k"), shipped("beam_1k"), shipped("liver_2k")};
}

const std::vector<std::string>& models() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names{"nonlinear",   "volume term", "nodal pressure", "tensor-mass", "mixed",
                                   "precomputed", "corotated",   "selective",      "reduced"};
    for (std::size_t i = 0, count = names.size(); i < count; ++i) names.push_back(smoothed + names[i]);
    return names;
  }();
  return all;
}

std::string kind_of(const std::string& model) {
  return model.starts_with(smoothed) ? model.substr(smoothed.size()) : model;
}

Setup tissue(const TetMesh& mesh, const std::string& model) {
  if (model.starts_with(smoothed)) {
    Setup setup = tissue(mesh, kind_of(model));
    setup.materials[0].element = ElementType::edge_smoothed;
    return setup;
  }
  Setup setup;
  setup.mesh = mesh;
  setup.materials = {{4e4, 1e4, 1000, model == "nodal pressure" ? 1.0 : 0.0}};
  setup.material_of.assign(std::size_t(mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(mesh.tet_count()), model == "tensor-mass" ? RegionModel::tensor_mass
                                                        : model == "reduced"   ? RegionModel::reduced
                                                                               : RegionModel::nonlinear);
  setup.guard_below = 0.2;
  setup.volume_penalty = model == "volume term" || model == "selective" ? 1e5 : 0;
  setup.selective_mass = model == "selective" ? 9 : 1;
  if (model == "corotated") setup.precomputed_frame = RegionFrame::corotated;
  if (model != "mixed" && model != "precomputed" && model != "corotated") return setup;
  const double middle = mesh.points.row(0).mean();
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (barycentre(mesh, t).x() < middle)
      setup.region_of[t] = model == "mixed" ? RegionModel::tensor_mass : RegionModel::precomputed;
  return setup;
}

Setup held_tissue(const Subject& subject, const std::string& model) {
  Setup setup = tissue(subject.mesh, model);
  for (Index v : subject.low_end()) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.damping = 30;
  return setup;
}

}  // namespace lobe::stress
