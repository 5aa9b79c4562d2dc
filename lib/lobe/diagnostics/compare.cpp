#include "lobe/diagnostics/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/diagnostics/overlap.h"
#include "lobe/error.h"
#include "lobe/fem/shape.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/quality.h"
#include "lobe/mesh/refine.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr double far_allowed = 0.01;    // of b's volume may be further from a than an edge
constexpr double volume_allowed = 2;    // ratio of the rest volumes
constexpr int most_refinements = 2;     // of b: 64 times its tetrahedra
constexpr double half_an_edge = 0.501;  // rounding must not refine once more

double ratio(double difference, double reference) {
  if (difference == 0) return 0;
  return reference > 0 ? difference / reference : std::numeric_limits<double>::infinity();
}

// Integrals of squares: of the difference and of b, of values and of gradients.
struct Squares {
  double l2[2] = {}, h1[2] = {};

  void set(Difference& d) const {
    d.l2 = std::sqrt(ratio(l2[0], l2[1]));
    d.h1 = std::sqrt(ratio(h1[0], h1[1]));
  }
};

// ∫|w|² over one tetrahedron of volume V: V/20 (Σ|w_i|² + |Σ w_i|²).
double l2_square(const Mat34<double>& w, double volume) {
  return volume / 20 * (w.squaredNorm() + w.rowwise().sum().squaredNorm());
}

template <class Matrix>
bool equal(const Matrix& a, const Matrix& b) {
  return a.cols() == b.cols() && a == b;
}

Mat34<double> at_corners(const TetMesh& mesh, const Mat3X<double>& u, Index tet) {
  Mat34<double> corners;
  for (int c = 0; c < 4; ++c) corners.col(c) = u.col(mesh.tets(c, tet));
  return corners;
}

// ∇u of every tetrahedron.
std::vector<Mat3<double>> gradients(const TetMesh& mesh, const Mat3X<double>& u) {
  std::vector<Mat3<double>> all(std::size_t(mesh.tet_count()));
  for (Index t = 0; t < mesh.tet_count(); ++t)
    all[std::size_t(t)] = displacement_gradient<double>(at_corners(mesh, u, t),
                                                        shape(tet_points(mesh, t)).gradients.rightCols<3>());
  return all;
}

double deformed_volume(const TetMesh& mesh, const Mat3X<double>& u) {
  double volume = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    volume += signed_volume(tet_points(mesh, t) + at_corners(mesh, u, t));
  return volume;
}

// Largest difference at the vertices of b, where a's values are given.
void set_largest(const Mat3X<double>& a, const Mat3X<double>& b, Difference& d) {
  if (b.cols() == 0) return;
  Eigen::Index worst = 0;
  d.max = (a - b).colwise().norm().maxCoeff(&worst);
  d.worst_vertex = static_cast<Index>(worst);
  d.relative_max = ratio(d.max, b.colwise().norm().maxCoeff());
}

void check(const Field& field) {
  if (field.mesh.tet_count() == 0) throw InputError(field.name, "has no tetrahedron to compare on");
  if (field.u.cols() != field.mesh.vertex_count())
    throw InputError(field.name, "needs one displacement per vertex of its mesh");
  for (Index v = 0; v < field.mesh.vertex_count(); ++v)
    if (!field.u.col(v).allFinite())
      throw InputError(
          field.name + ": vertex " + std::to_string(v),
          "its displacement is not a finite number; a field without NaN or infinity is needed, as of a run "
          "that did not diverge");
  if (field.density.empty()) return;
  if (field.density.size() != std::size_t(field.mesh.tet_count()))
    throw InputError(field.name, "needs one density per tetrahedron, or none");
  for (Index t = 0; t < field.mesh.tet_count(); ++t)
    if (!(field.density[std::size_t(t)] > 0) || !std::isfinite(field.density[std::size_t(t)]))
      throw InputError(field.name + ": tetrahedron " + std::to_string(t),
                       "its cell data \"density\" is " + rounded(field.density[std::size_t(t)]) +
                           " kg/m³, must be finite and above 0");
}

void check_sizes(const Field& a, const Field& b, const Difference& d) {
  const double times = d.rest_volume_a / d.rest_volume_b;
  if (times < volume_allowed && times > 1 / volume_allowed) return;
  const bool thousandfold = std::abs(std::abs(std::log10(times)) - 9) < 0.5;
  throw InputError(a.name, "does not cover the same body as " + b.name + ": " + rounded(d.rest_volume_a) +
                               " m³ at rest against " + rounded(d.rest_volume_b) + " m³" +
                               (thousandfold ? "; one of them seems to be in millimetres, metres are expected"
                                             : "; two meshes of one body are needed"));
}

// Returns b on a mesh that is so fine that its quadrature resolves the kinks of a.
Field refined_for(const Field& a, Field b) {
  const double edge_a = mesh_quality(a.mesh).mean_edge;
  double edge_b = mesh_quality(b.mesh).mean_edge;
  for (int i = 0; i < most_refinements && edge_b > half_an_edge * edge_a; ++i, edge_b /= 2) {
    RefinedMesh fine = refine(b.mesh);
    b.u = fine.prolongate(b.u);
    if (!b.density.empty()) {
      std::vector<double> density;
      for (Index parent : fine.parent_of) density.push_back(b.density[std::size_t(parent)]);
      b.density = std::move(density);
    }
    b.mesh = std::move(fine.mesh);
  }
  return b;
}

Squares integrate(const Field& a, const Locator& where, const Field& b, Coverage& coverage) {
  const auto gradients_a = gradients(a.mesh, a.u), gradients_b = gradients(b.mesh, b.u);
  Squares sums;
  coverage = for_each_overlap(where, b.mesh, [&](const OverlapPoint& p) {
    const Vec3d at_b = interpolate(b.mesh, b.u, p.tet_b, p.at_b);
    const Vec3d difference = interpolate(a.mesh, a.u, p.tet_a, p.at_a) - at_b;
    const double mass = b.density.empty() ? p.volume : p.volume * b.density[std::size_t(p.tet_b)];
    const Mat3<double>& gradient_b = gradients_b[std::size_t(p.tet_b)];
    sums.l2[0] += mass * difference.squaredNorm();
    sums.l2[1] += mass * at_b.squaredNorm();
    sums.h1[0] += p.volume * (gradients_a[std::size_t(p.tet_a)] - gradient_b).squaredNorm();
    sums.h1[1] += p.volume * gradient_b.squaredNorm();
  });
  return sums;
}

void check_coverage(const Field& a, const Field& b, const Coverage& coverage) {
  if (coverage.far_fraction <= far_allowed) return;
  throw InputError(a.name, "does not cover the same body as " + b.name + ": " +
                               rounded(100 * coverage.far_fraction) + " % of " + b.name +
                               " is more than an edge away from it, up to " + rounded(coverage.largest_gap) +
                               " m; two meshes of one body at rest in one place are needed");
}

Difference compare_by_interpolation(const Field& a, const Field& b) {
  Difference d;
  d.same_mesh = false;
  d.by_mass = !b.density.empty();
  d.rest_volume_a = total_volume(a.mesh);
  d.rest_volume_b = total_volume(b.mesh);
  check_sizes(a, b, d);
  const Locator where(a.mesh);
  Coverage coverage;
  integrate(a, where, refined_for(a, b), coverage).set(d);
  check_coverage(a, b, coverage);
  d.outside_fraction = coverage.outside_fraction;
  d.largest_gap = coverage.largest_gap;
  d.volume_a = deformed_volume(a.mesh, a.u);
  d.volume_b = deformed_volume(b.mesh, b.u);
  Mat3X<double> at_vertices = b.u;
  const auto places = vertex_places(where, b.mesh);
  for (Index v = 0; v < b.mesh.vertex_count(); ++v)
    if (const VertexPlace& place = places[std::size_t(v)]; place.tet >= 0)
      at_vertices.col(v) = interpolate(a.mesh, a.u, place.tet, place.at);
  set_largest(at_vertices, b.u, d);
  return d;
}

}  // namespace

Field read_field(const std::filesystem::path& file) {
  MeshFile read = read_mesh(file);
  const auto found = read.point_data.find("displacement");
  if (found == read.point_data.end() || found->second.rows() != 3)
    throw InputError(
        file.string(),
        "has no point data \"displacement\" of three components; give a VTU file as `lobe run` writes it");
  Field field{file.string(), std::move(read.mesh), std::move(found->second), {}};
  if (const auto density = read.cell_data.find("density");
      density != read.cell_data.end() && density->second.rows() == 1)
    field.density.assign(density->second.data(), density->second.data() + density->second.size());
  check(field);
  return field;
}

Difference compare_displacements(const TetMesh& mesh, const Mat3X<double>& a, const Mat3X<double>& b,
                                 const std::vector<double>& density) {
  if (a.cols() != mesh.vertex_count() || b.cols() != mesh.vertex_count())
    throw InputError("displacement", "one column per vertex of the mesh is needed");
  Difference d;
  d.by_mass = !density.empty();
  Squares sums;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Shape s = shape(tet_points(mesh, t));
    const Mat3<double> alpha = s.gradients.rightCols<3>();
    const Mat34<double> at_b = at_corners(mesh, b, t), w = at_corners(mesh, a, t) - at_b;
    const double mass = d.by_mass ? s.volume * density[std::size_t(t)] : s.volume;
    sums.l2[0] += l2_square(w, mass);
    sums.l2[1] += l2_square(at_b, mass);
    sums.h1[0] += s.volume * displacement_gradient(w, alpha).squaredNorm();
    sums.h1[1] += s.volume * displacement_gradient(at_b, alpha).squaredNorm();
    d.rest_volume_b += s.volume;
  }
  sums.set(d);
  d.rest_volume_a = d.rest_volume_b;
  d.volume_a = deformed_volume(mesh, a);
  d.volume_b = deformed_volume(mesh, b);
  set_largest(a, b, d);
  return d;
}

Difference compare_fields(const Field& a, const Field& b) {
  check(a);
  check(b);
  if (equal(a.mesh.points, b.mesh.points) && equal(a.mesh.tets, b.mesh.tets))
    return compare_displacements(a.mesh, a.u, b.u, b.density);
  return compare_by_interpolation(a, b);
}

}  // namespace lobe
