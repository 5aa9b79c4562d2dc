// The scene that begins without loads: its mesh has the rest shape of a scene whose mesh is the image of a
// loaded body (solve/rest_shape.h).
#pragma once

#include "lobe/io/mesh_io.h"
#include "lobe/scene/resolve.h"
#include "lobe/solve/rest_shape.h"

namespace lobe {

struct RestScene {
  Scene scene;                     // it names no mesh yet
  TetMesh mesh;                    // the mesh at rest [m]
  RestShape shape;                 // `points` are those of the mesh
  std::vector<std::string> notes;  // one line each: selections that are by number now
  // One line each: what the scene has on the mesh at rest that the given one has not on its mesh.
  std::vector<std::string> warnings;
};

// `loaded` is `scene`, with groups bound, resolved on the mesh of `file`. The new scene holds, loads and
// takes what the given one does: selections by place that take other vertices, tetrahedra or faces of the
// mesh at rest become numbers, points of threads and ligaments move with the tissue. Shares of held vertices
// and directions of fibres that follow the shape are found again on it, in rounds. Throws InputError as
// find_rest_shape() does.
RestScene find_rest_scene(const Scene& scene, const MeshFile& file, const Setup& loaded,
                          const RestShapeOptions& options = {});

// Writes the scene (.json) with a mesh beside it, or one for each body: FILE.vtu or FILE_1.vtu, with fibres,
// point and cell data of `file` and the point data "displacement"; or FILE.msh, if `file` has groups of
// triangles or names of labels. A skin becomes FILE_skin.obj, which has moved with the tissue. Returns all
// files.
std::vector<std::filesystem::path> write_rest_scene(const std::filesystem::path& json, const RestScene& rest,
                                                    const MeshFile& file);
// Writes the mesh at rest alone (.vtu), with the same data.
void write_rest_mesh(const std::filesystem::path& vtu, const RestScene& rest, const MeshFile& file);

}  // namespace lobe
