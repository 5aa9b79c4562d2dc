// What a user paints on a body at rest: the model and the material of each tetrahedron, and which vertices
// are held. It becomes a scene, with the labels of its regions and materials in the mesh.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "lobe/mesh/surface.h"
#include "lobe/scene/resolve.h"

namespace lobe::view {

class Painting {
 public:
  // `resolved` is of this scene and mesh.
  Painting(Scene scene, const Resolved& resolved);

  // ---- To paint. All that is done until end_stroke() is undone at once.

  // Paints tetrahedra by their barycentre, at least one. A material is given by its number in materials().
  void paint(const Vec3d& at, double radius, RegionModel model);
  void paint_material(const Vec3d& at, double radius, int material);
  // Adds a material like the first one, but with another stiffness, and returns its number. Throws InputError
  // for a name that is in use, an invalid modulus, or if there are too many materials.
  int add_material(const std::string& name, double young /* [Pa] */);
  void hold(const Vec3d& at, double radius, bool held);  // vertices of the skin; free: all
  void paint_all(RegionModel model);
  void use(const std::vector<RegionModel>& region_of);  // model of each tetrahedron
  // Whether precomputed parts follow a rigid motion of their own (condense/rigid_frame.h).
  void set_frame(RegionFrame frame);
  void end_stroke() { is_in_stroke_ = false; }
  bool can_undo() const { return !past_.empty(); }
  void undo();

  // ---- The present painting

  const SurfaceMesh& surface() const { return surface_.mesh(); }
  const Mat3X<float>& rest() const { return rest_; }                   // 3 × #vertices of the surface [m]
  const std::vector<std::uint8_t>& held() const { return now_.held; }  // per vertex of the mesh
  const std::vector<RegionModel>& regions() const { return now_.region_of; }  // per tetrahedron
  std::array<double, region_model_names.size()> shares() const;               // shares of the volume
  const std::vector<Material>& materials() const { return scene_.materials; }
  // Precomputed tetrahedra of parts (connected by faces) that nothing holds; with a corotated frame, of all
  // parts but the largest. No world can be built with these.
  std::vector<Index> unheld() const;
  bool can_turn()
      const;  // there is one precomputed part only, and other regions: it may have a corotated frame
  double share_of(const std::vector<Index>& tets) const;                    // share of the volume
  std::vector<double> material_shares() const;                              // shares of the volume
  const std::vector<int>& material_of() const { return now_.material_of; }  // per tetrahedron

  // The original scene with the painted regions, as labels of mesh(), and with painted materials and held
  // vertices, if there are any. `mesh` is the file that mesh() will be in.
  Scene scene(const std::filesystem::path& mesh) const;
  TetMesh mesh() const;
  // Writes scene and mesh as `name`.json and `name`.vtu, and returns the first; `finish` may change the scene
  // before. Throws InputError for an invalid name, or if they cannot be written.
  std::filesystem::path save(const std::filesystem::path& folder, const std::string& name,
                             const std::function<Scene(Scene)>& finish = {}) const;

 private:
  struct State {
    std::vector<RegionModel> region_of;
    std::vector<int> material_of;
    std::vector<std::uint8_t> held;
    RegionFrame frame = RegionFrame::fixed;  // frame of precomputed parts
  };

  void begin();
  std::vector<std::vector<Index>> precomputed_parts() const;
  void follow(const std::vector<Index>& tets) {
    surface_.follow_regions(TetCells(topology_), tets, now_.region_of);
  }
  void follow_all();
  int label(Index tet) const;
  int label(std::size_t place, int material, RegionModel model) const;
  template <class Choice>
  Selector labelled(const Choice& is_chosen) const;
  void relabel(Selector& selector) const;
  void add_regions(Scene& scene) const;
  void set_materials(Scene& scene) const;
  void set_fixed(Scene& scene) const;

  Scene scene_;
  double cell_;  // edge of the cells of reduced parts [m]; 0: chosen
  TetMesh mesh_;
  Topology topology_;
  State now_;
  std::vector<std::uint8_t> held_at_first_;
  std::vector<int> material_at_first_;
  std::vector<State> past_;
  bool is_in_stroke_ = false;
  std::vector<int> labels_;  // labels of the mesh as it was, each once, ascending
  Surface surface_;
  Mat3X<float> rest_;
  std::vector<Index> skin_;      // vertices of the mesh, each once
  Mat3X<double> barycentres_;    // 3 × #tetrahedra [m]
  std::vector<double> volumes_;  // volume of each tetrahedron [m³]
};

// Young's modulus [Pa]; of a material with fibres, the one across them.
double young_of(const Material& material);

// Throws InputError unless this is a file name without folder and extension: letters, digits, "_" and "-", at
// most 60 of them.
void check_file_name(const std::string& name);

}  // namespace lobe::view
