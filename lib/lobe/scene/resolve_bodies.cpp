#include <algorithm>

#include "lobe/diagnostics/body_overlap.h"
#include "lobe/scene/resolve_parts.h"

namespace lobe {
namespace {

// What overlaps by less is pushed apart by contact, as where two bodies are meshed apart along a curved face.
constexpr double most_overlap = 0.1;  // of an edge

std::string overlap_text(const MeshBodies& bodies, const BodyOverlap& found) {
  const Vec3d& at = found.place;
  return "overlaps \"" + bodies.names[std::size_t(found.body)] + "\" by " + rounded(found.depth) + " m at [" +
         rounded(at[0]) + ", " + rounded(at[1]) + ", " + rounded(at[2]) + "] m";
}

}  // namespace

// The mesh is that of the scene's bodies, and they lie apart.
void check_bodies(Resolution& resolution) {
  const MeshBodies& bodies = resolution.mesh().bodies;
  const std::vector<SceneBody>& wanted = resolution.scene.bodies;
  const bool is_same =
      std::equal(wanted.begin(), wanted.end(), bodies.names.begin(), bodies.names.end(),
                 [](const SceneBody& body, const std::string& name) { return body.name == name; });
  if (!wanted.empty() && !is_same)
    throw InputError("/bodies", "the mesh is not that of these bodies: read it with read_scene_mesh()");
  for (const BodyOverlap& found : body_overlaps(resolution.mesh())) {
    const std::string place =
        wanted.empty() ? "mesh" : "/bodies/" + std::to_string(found.other) + "/position";
    if (found.depth > most_overlap * found.edge)
      resolution.fail(place, overlap_text(bodies, found) + "; move one of them");
    else
      resolution.warn(place, overlap_text(bodies, found) + "; contact will push them apart");
  }
}

void warn_of_bodies(Resolution& resolution) {
  if (resolution.mesh().bodies.count() > 1 && !resolution.scene.contact.self)
    resolution.warn("/contact/self", "is false, so that the bodies do not feel each other");
}

}  // namespace lobe
