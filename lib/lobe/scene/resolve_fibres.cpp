// The fibre directions of a scene, one per tetrahedron of the materials that have fibres.
#include <algorithm>

#include "lobe/fem/fibre_fields.h"
#include "lobe/fem/law_fault.h"
#include "lobe/scene/resolve_parts.h"

namespace lobe {
namespace {

void take_array(const Mat3X<double>& array, const std::vector<Index>& tets, TetMesh& mesh,
                const std::string& place) {
  if (array.cols() == 0)
    throw InputError(place,
                     "the mesh has no cell array \"fibre\" of three components; write it to the VTU "
                     "file, or give the fibres by \"direction\", \"axis\" or \"harmonic\"");
  for (Index t : tets) {
    const Vec3d given = array.col(t);
    const double length = given.stableNorm();
    if (!(length > 0 && std::isfinite(length)))
      throw InputError(place, "tetrahedron " + std::to_string(t) + ": its direction has length " +
                                  exact(length) + ", must be above 0 and finite");
    mesh.fibres.col(t) = given / length;
  }
}

struct Filler {
  const Mat3X<double>& array;
  const std::vector<Index>& tets;
  TetMesh& mesh;
  const std::string& place;

  void operator()(const FibreDirection& field) const {
    for (Index t : tets) mesh.fibres.col(t) = field.direction.stableNormalized();
  }
  void operator()(const FibreArray&) const { take_array(array, tets, mesh, place + "/array"); }
  void operator()(const FibreHarmonic& field) const {
    const std::string at = place + "/harmonic";
    set_harmonic_fibres(select_vertices(field.from, mesh, at + "/from"),
                        select_vertices(field.to, mesh, at + "/to"), tets, mesh, at);
  }
  void operator()(const FibreAround& field) const {
    set_fibres_around(field.point, field.axis, tets, mesh, place + "/axis");
  }
};

void check_planes(Resolution& resolution, std::size_t material, const std::vector<Index>& tets) {
  const Setup& setup = resolution.result.setup;
  const auto bad = std::find_if_not(tets.begin(), tets.end(), [&](Index t) {
    return spans_plane(setup.materials[material], setup.mesh.fibres.col(t));
  });
  if (bad != tets.end())
    resolution.fail("/materials/" + std::to_string(material) + "/holzapfel_plane",
                    "is the direction of the fibre of tetrahedron " + std::to_string(*bad) +
                        "; it must be another vector of the plane of both families");
}

}  // namespace

void resolve_fibres(Resolution& resolution) {
  Setup& setup = resolution.result.setup;
  const Mat3X<double> array = std::move(setup.mesh.fibres);
  setup.mesh.fibres.resize(3, 0);  // none, where no material has fibres
  if (!any_fibre(setup.materials)) return;
  setup.mesh.fibres.setZero(3, setup.mesh.tet_count());
  const std::vector<Material>& materials = resolution.scene.materials;
  for (std::size_t m = 0; m < materials.size(); ++m) {
    if (!materials[m].fibre) continue;
    std::vector<Index> tets;
    for (std::size_t t = 0; t < setup.material_of.size(); ++t)
      if (setup.material_of[t] == m) tets.push_back(static_cast<Index>(t));
    if (tets.empty()) continue;
    const std::string place = "/materials/" + std::to_string(m) + "/fibre";
    resolution.selected([&] {
      std::visit(Filler{array, tets, setup.mesh, place}, *materials[m].fibre);
      check_planes(resolution, m, tets);
      return 0;
    });
  }
}

}  // namespace lobe
