// How files become a scene: read as it is, or made by the program `lobe` with what was chosen for it.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "child.h"
#include "lobe/scene/resolve.h"

namespace lobe::view {

// What is chosen where a scene is made. What is empty or 0 is chosen by `lobe`.
struct Choices {
  std::string tissue, hold;      // options --tissue and --hold of `lobe scene`
  double edge = 0;               // edge of tetrahedra that a surface is filled with [m]
  double scale = 0;              // factor from the files' coordinates to metres
  double springs = 0;            // stiffness of a bed under the side that is held [Pa/m]; 0: it is fixed
  std::vector<Vec3d> pins = {};  // places that are fixed, at rest [m]
};

// The origin of a scene that was made.
struct Origin {
  std::vector<std::filesystem::path>
      files;                        // surfaces, a label image or a mesh; none: it was written by hand
  double scale = 0, edge = 0;       // what was asked for, as in Choices
  std::filesystem::path mesh = {};  // mesh of the scene as it was made
  double mesh_scale = 1;
  std::vector<std::string> warnings = {};  // what lobe-mesh has said of its mesh
};

// What to choose where a scene is made anew of the same files, which `origin` then remembers: an edge and a
// scale that are not wanted now (0) are those of before; a scale below 0 is found anew. In other units an
// edge of before is another one.
Choices carried_over(Origin& origin, const Choices& wanted);

// Makes a scene in a folder, and returns its file. Throws InputError with what the program says.
std::filesystem::path make_scene_file(const Origin& origin, const Choices& choices,
                                      const std::filesystem::path& folder, Child& child);

// The warnings of lobe-mesh among what a program has said, without its name.
std::vector<std::string> warnings_of_mesher(const std::string& said);

// What `lobe-mesh --measure` says of surfaces or a label image. Throws InputError with what the program says.
nlohmann::json size_of_files(const std::vector<std::filesystem::path>& files,
                             const std::filesystem::path& folder, Child& child);

// What `lobe check --total-error --json` says of a scene. Throws InputError with what the program says.
nlohmann::json total_errors_of(const std::filesystem::path& scene, const std::filesystem::path& folder,
                               Child& child);

// Throws InputError as reading and resolving do. Warnings of its mesh are among those of what is resolved.
std::pair<Scene, Resolved> load_scene(const std::filesystem::path& file,
                                      const std::function<void(double fraction)>& progress);

// Whether it was made of tetrahedra that were there before, which have no other edge.
bool has_own_mesh(const Origin& origin);

// What was chosen for it, for a page; null for one that was written by hand. Call it when the scene is
// opened: it notes the mesh that it has then.
nlohmann::json note_choices(Origin& origin, const Scene& scene, const Resolved& resolved);

}  // namespace lobe::view
