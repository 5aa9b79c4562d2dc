// The mesh of a scene: that of one file, or those of several bodies as one mesh.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lobe/io/mesh_io.h"
#include "lobe/scene/scene.h"

namespace lobe {

// Reads it for bind_groups() and resolve(). Meshes of bodies are scaled, turned and moved to their places,
// and numbered one after the other; groups of surfaces of the same name become one. Throws InputError as
// read_mesh() does, and for a place that is out of range.
MeshFile read_scene_mesh(const Scene& scene);

// Returns the files that it reads.
std::vector<std::filesystem::path> mesh_paths(const Scene& scene);

// Replaces the mesh of the scene by a file, as an option of a program asks. Throws InputError for a scene
// with bodies.
void replace_mesh(const std::filesystem::path& mesh, Scene& scene);

// Writes a mesh in metres as STEM.vtu, or each of its bodies as STEM_1.vtu and so on, to a folder in which
// the scene is going to be. The scene then names these files, and reading it gives the same numbers.
void save_scene_mesh(const TetMesh& mesh, const std::filesystem::path& folder, const std::string& stem,
                     Scene& scene);

}  // namespace lobe
