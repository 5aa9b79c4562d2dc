#include "benchmarks/accuracy_error.h"

#include <cmath>

#include "lobe/diagnostics/compare.h"
#include "lobe/error.h"
#include "lobe/fem/elements.h"

namespace lobe::bench {
namespace {

Field at_rest(const char* name, const TetMesh& mesh) {
  return {name, mesh, Mat3X<double>::Zero(3, mesh.vertex_count()), {}};
}

}  // namespace

ErrorNorm::ErrorNorm(const Setup& reference) {
  const Elements elements(reference);
  for (Index v = 0; v < reference.mesh.vertex_count(); ++v) mass_.push_back(lumped_mass(elements, v));
}

ErrorNorm::ErrorNorm(const Setup& reference, const TetMesh& mesh) : ErrorNorm(reference) {
  compare_fields(at_rest("a mesh", mesh), at_rest("the reference", reference.mesh));  // refuses another body
  mesh_ = mesh;
  places_ = vertex_places(Locator(mesh_), reference.mesh);
}

double ErrorNorm::relative(const Samples& run, const Samples& reference) const {
  double difference = 0, whole = 0;
  for (std::size_t i = 0; i < reference.size(); ++i)
    for (Index v = 0; v < Index(mass_.size()); ++v) {
      if (mass_[std::size_t(v)] == 0) continue;  // a vertex without tetrahedra
      const Vec3d expected = reference[i].col(v);
      const Vec3d found = places_.empty() ? Vec3d(run[i].col(v))
                                          : interpolate(mesh_, run[i], places_[std::size_t(v)].tet,
                                                        places_[std::size_t(v)].at);
      difference += mass_[std::size_t(v)] * (found - expected).squaredNorm();
      whole += mass_[std::size_t(v)] * expected.squaredNorm();
    }
  if (whole == 0) throw InputError("scene", "nothing moves in it: an error cannot be measured");
  return std::sqrt(difference / whole);
}

}  // namespace lobe::bench
