// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <CGAL/Polygon_mesh_processing/remesh.h>

#include "lobe_mesh/cgal_common.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {

Surface remesh(const Surface& surface, const std::vector<Polyline>& features, double edge) {
  return guarded("remeshing", [&] {
    CgalMesh mesh = to_cgal(surface.points, surface.triangles);
    auto sharp = mesh.add_property_map<CgalMesh::Edge_index, bool>("e:sharp", false).first;
    for (const Polyline& line : features) {
      for (std::size_t i = 1; i < line.size(); ++i) {
        const auto h = mesh.halfedge(CgalMesh::Vertex_index(line[i - 1]), CgalMesh::Vertex_index(line[i]));
        if (h != CgalMesh::null_halfedge()) sharp[mesh.edge(h)] = true;
      }
    }
    namespace pmp = CGAL::Polygon_mesh_processing;
    pmp::isotropic_remeshing(mesh.faces(), edge, mesh,
                             CGAL::parameters::number_of_iterations(10)
                                 .number_of_relaxation_steps(2)
                                 .edge_is_constrained_map(sharp)
                                 .protect_constraints(false)
                                 .relax_constraints(false));
    mesh.collect_garbage();
    return from_cgal(mesh);
  });
}

}  // namespace lobe::meshing
