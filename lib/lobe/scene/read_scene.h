// Reads a scene from JSON. docs/scene.md is the reference, scene.schema.json the grammar.
//
// Bad input throws one InputError that carries every fault, each with its JSON pointer, the value found and
// what was expected: "/materials/1/poisson_ratio: 0.5, must be below 0.5". Unknown keys are refused, with the
// nearest known key as a suggestion; so are keys given twice.
#pragma once

#include <filesystem>
#include <string_view>

#include "lobe/scene/scene.h"

namespace lobe {

// Files of at most 64 MB, nested at most 64 levels deep.
Scene read_scene(const std::filesystem::path& file);

// `file` is the name of the text in messages, and what relative paths are relative to; it is not opened.
Scene parse_scene(std::string_view text, const std::filesystem::path& file = "scene.json");

// Where the mesh of a scene lies. Throws InputError for a scene with bodies (scene_mesh.h).
std::filesystem::path mesh_path(const Scene& scene);
std::filesystem::path skin_path(const Scene& scene);  // skin of a scene that has one
// Makes paths of a scene absolute, so that it may be written to another folder.
Scene with_absolute_paths(Scene scene);

}  // namespace lobe
