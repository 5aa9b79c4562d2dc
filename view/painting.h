// What is painted on a body at rest: the model of each tetrahedron and which vertices are held; as a scene,
// with the labels
// of its regions in the mesh.
#pragma once

#include <filesystem>
#include <vector>

#include "lobe/mesh/surface.h"
#include "lobe/scene/resolve.h"

namespace lobe::view {

class Painting {
 public:
  // `resolved` is of this scene and mesh.
  Painting(Scene scene, const Resolved& resolved);

  // ---- Painting; what is done until end_stroke() is undone at once.

  void paint(const Vec3d& at, double radius,
             RegionModel model);                         // tetrahedra by their barycentre, at least one
  void hold(const Vec3d& at, double radius, bool held);  // vertices of the skin, at least one
  void paint_all(RegionModel model);
  void use(const std::vector<RegionModel>& region_of);  // per tetrahedron
  void end_stroke() { is_in_stroke_ = false; }
  bool can_undo() const { return !past_.empty(); }
  void undo();

  // ---- What there is

  const SurfaceMesh& surface() const { return surface_.mesh(); }
  const Mat3X<float>& rest() const { return rest_; }                   // 3 × #vertices of the surface [m]
  const std::vector<std::uint8_t>& held() const { return now_.held; }  // per vertex of the mesh
  const std::vector<RegionModel>& regions() const { return now_.region_of; }  // per tetrahedron
  std::array<double, 3> shares() const;                                       // of the volume, by RegionModel

  // The scene as it was, but for its regions, which are those labels of mesh(), and for what is fixed, where
  // that was painted.
  // `mesh` is the file that mesh() will be in.
  Scene scene(const std::filesystem::path& mesh) const;
  TetMesh mesh() const;
  // Both as files `name`.json and `name`.vtu; returns the first. Throws InputError for a name that is none,
  // or what cannot
  // be written.
  std::filesystem::path save(const std::filesystem::path& folder, const std::string& name) const;

 private:
  struct State {
    std::vector<RegionModel> region_of;
    std::vector<std::uint8_t> held;
  };

  void begin();
  void follow(const std::vector<Index>& tets) { surface_.follow_regions(tets, now_.region_of); }
  void follow_all();
  int label(Index tet) const;
  void relabel(Selector& selector) const;

  Scene scene_;
  TetMesh mesh_;
  Topology topology_;
  State now_;
  std::vector<std::uint8_t> held_at_first_;
  std::vector<State> past_;
  bool is_in_stroke_ = false;
  std::vector<int> labels_;  // of the mesh as it was, each once, ascending
  Surface surface_;
  Mat3X<float> rest_;
  std::vector<Index> skin_;      // vertices of the mesh, each once
  Mat3X<double> barycentres_;    // 3 × #tetrahedra [m]
  std::vector<double> volumes_;  // of tetrahedra [m³]
};

// A name of a file without folder and extension: letters, digits, "_" and "-", at most 60 of them. Throws
// InputError.
void check_file_name(const std::string& name);

}  // namespace lobe::view
