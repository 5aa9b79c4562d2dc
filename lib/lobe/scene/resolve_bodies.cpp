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

// A body that carries something is fed where the scene holds it.
void resolve_carriers(Resolution& resolution) {
  Setup& setup = resolution.result.setup;
  const std::vector<SceneBody>& bodies = resolution.scene.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].carries == Carries::nothing) continue;
    std::vector<char> is_of(std::size_t(setup.mesh.vertex_count()), 0);
    for (Index t = 0; t < setup.mesh.tet_count(); ++t)
      if (setup.mesh.bodies.body_of(t) == int(i))
        for (const Index v : setup.mesh.tets.col(t)) is_of[std::size_t(v)] = 1;
    CarrierSetup carrier{int(i), bodies[i].carries, {}};
    for (const PrescribedVertex& held : setup.prescribed)
      if (is_of[std::size_t(held.vertex)]) carrier.fed.push_back(held.vertex);
    for (const PartlyHeldVertex& held : setup.partly_held)
      if (is_of[std::size_t(held.vertex)]) carrier.fed.push_back(held.vertex);
    if (!carrier.fed.empty()) {
      setup.carriers.push_back(std::move(carrier));
      continue;
    }
    resolution.fail("/bodies/" + std::to_string(i) + "/carries",
                    std::string(carries_names[std::size_t(bodies[i].carries)]) +
                        " comes in where a body is held, and \"" + bodies[i].name +
                        "\" is held nowhere: hold its end that is fed by a \"fix\" of /boundary");
  }
}

void warn_of_bodies(Resolution& resolution) {
  if (resolution.mesh().bodies.count() > 1 && !resolution.scene.contact.self)
    resolution.warn("/contact/self", "is false, so that the bodies do not feel each other");
}

}  // namespace lobe
