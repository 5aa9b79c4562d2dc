// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/tetrahedralise.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <sstream>
#include <tuple>

#include "lobe/error.h"
#include "lobe/mesh/spatial_order.h"
#include "lobe/text.h"
#include "lobe_mesh/area.h"
#include "lobe_mesh/check_options.h"
#include "lobe_mesh/child_process.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/measure.h"
#include "lobe_mesh/mesh_model.h"
#include "lobe_mesh/relax.h"
#include "lobe_mesh/sizing.h"
#include "lobe_mesh/steps.h"
#include "lobe_mesh/surface_gap.h"
#include "lobe_mesh/volumes.h"

namespace lobe::meshing {
namespace {

// Remeshing to this multiple of the edge gives boundary tetrahedra of the volume aimed at.
constexpr double surface_edge_factor = 1.08;

constexpr double finest_feature = 0.15;  // of the shortest edge asked for

// Numbers vertices and tetrahedra along a curve through space: what lies close together in the body then lies
// close together in memory. Meshers leave them in no such order.
TetMesh in_spatial_order(const TetMesh& mesh) {
  Mat3X<double> middles(3, mesh.tet_count());
  for (Index t = 0; t < mesh.tet_count(); ++t) middles.col(t) = barycentre(mesh, t);
  const std::vector<Index> vertices = spatial_order(mesh.points), tets = spatial_order(middles);
  std::vector<Index> number(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) number[std::size_t(vertices[i])] = static_cast<Index>(i);
  TetMesh ordered{mesh.points(Eigen::all, vertices), mesh.tets(Eigen::all, tets), {}};
  for (Index& v : ordered.tets.reshaped()) v = number[std::size_t(v)];
  for (Index t : tets) ordered.labels.push_back(mesh.labels[std::size_t(t)]);
  return ordered;
}

class Stopwatch {
 public:
  explicit Stopwatch(std::vector<Phase>& phases) : phases_(phases) {}
  void phase(const std::string& name) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    const auto same = [&](const Phase& phase) { return phase.name == name; };
    const auto known = std::find_if(phases_.begin(), phases_.end(), same);
    if (known != phases_.end())
      known->seconds += seconds;
    else
      phases_.push_back({name, seconds});
    last_ = now;
  }
  double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::vector<Phase>& phases_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_ = start_;
};

// Remeshing may fold thin parts onto themselves, which TetGen refuses: then a finer surface is tried.
Model remesh_without_intersections(const Model& model, double edge) {
  Model result = model;
  for (const double factor : {1.0, 0.85, 0.7, 0.5}) {
    for (std::size_t k = 0; k < model.surfaces.size(); ++k)
      result.surfaces[k] = remesh(model.surfaces[k], model.features[k], surface_edge_factor * factor * edge);
    if (diagnose(joined_surface(result.surfaces)).self_intersections.count == 0) return result;
  }
  throw MeshingFailure("remeshing left self-intersections: use --mesher cgal, or a shorter --edge");
}

// A third of the size of a region, 6 V/A: of a cube that is its edge, of a ball its diameter.
double edge_within(const Model& model, int region) {
  double faces = 0;
  for (std::size_t k = 0; k < model.surfaces.size(); ++k)
    if (model.sides[k].inside == region || model.sides[k].outside == region) faces += area(model.surfaces[k]);
  return faces > 0 ? 2 * model.volumes[std::size_t(region)] / faces : 0;
}

// The repair separates bodies that touch along an edge or at a vertex, but leaves them in the same place.
// Mesh_3 refines there without end.
void refuse_touching(const Surface& surface) {
  std::map<std::array<double, 3>, Index> seen;
  for (Index v = 0; v < surface.points.cols(); ++v) {
    const Vec3d p = surface.points.col(v);
    if (seen.try_emplace({p.x(), p.y(), p.z()}, v).second) continue;
    std::ostringstream place;
    place << "two bodies touch at (" << p.x() << ", " << p.y() << ", " << p.z()
          << ") m: use --mesher tetgen, or move them apart";
    throw InputError("surface", place.str());
  }
}

// Meshes one model several times, in a box of unit size, and keeps the best mesh.
class Tries {
 public:
  Tries(const Model& model, const MeshOptions& options, MeshReport& report);
  TetMesh best();

 private:
  void keep_features(std::size_t k);
  void one(Mesher mesher, double factor);
  TetMesh mesh_with(Mesher mesher, double edge);
  void improve(TetMesh& mesh);
  Remedy measure_gap(const TetMesh& mesh, MeshReport& report) const;
  bool ask_for_lost_parts();
  bool available(Mesher mesher) const;
  bool failed(Mesher mesher) const;
  bool out_of_time() const { return stopwatch_.elapsed() > options_.time_limit; }

  const Model& model_;
  const MeshOptions& options_;
  MeshReport& report_;
  UnitBox unit_;
  Model scaled_;
  MeshOptions scaled_options_;
  std::vector<NearestPoint> surfaces_;
  NearestPoint surface_;  // all of them
  std::vector<SurfacePoint> surface_points_;
  Interfaces interfaces_;
  std::vector<Mat3X<double>> features_;  // points of the feature lines, scaled
  std::vector<std::string> warnings_;
  std::vector<Phase> phases_;
  Stopwatch stopwatch_{phases_};
  TetMesh best_;
  MeshReport best_report_;
  Remedy remedy_;  // scaled: what would keep the parts that the best mesh lost
  std::vector<Seed> seeds_;
};

constexpr double point_spacing = 0.5;  // of the edge
constexpr int most_remedies = 3;       // meshes with shorter edges where parts were lost

Tries::Tries(const Model& model, const MeshOptions& options, MeshReport& report)
    : model_(model),
      options_(options),
      report_(report),
      unit_(joined_surface(model.surfaces)),
      scaled_(model),
      scaled_options_(options),
      surface_(Surface{unit_.to_unit(joined_surface(model.surfaces).points),
                       joined_surface(model.surfaces).triangles}) {
  scaled_options_.edge /= unit_.size;
  for (auto& [label, edge] : scaled_options_.label_edges) edge /= unit_.size;
  for (SizeBall& ball : scaled_options_.balls)
    ball = {unit_.to_unit(ball.centre), ball.radius / unit_.size, ball.edge / unit_.size};
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    Surface& surface = scaled_.surfaces[k];
    surface.points = unit_.to_unit(surface.points);
    if (!model.is_image())  // its surfaces are smooth but for the steps between voxels
      keep_features(k);
    for (const Polyline& line : scaled_.features[k]) features_.push_back(surface.points(Eigen::all, line));
    surfaces_.emplace_back(surface);
  }
  for (std::size_t k = 0; k < surfaces_.size(); ++k)
    interfaces_[std::minmax(model.sides[k].outside, model.sides[k].inside)] = &surfaces_[k];
  for (double& volume : scaled_.volumes) volume /= std::pow(unit_.size, 3);
  for (Mat3X<double>& line : scaled_.junctions) line = unit_.to_unit(line);
  if (model.is_image()) {
    scaled_.image_region = [&](const Vec3d& point) { return model.image_region(unit_.from_unit(point)); };
  }
  report_.shortest_edge = unit_.size * Sizing(scaled_, scaled_options_).shortest();
  report_.longest_edge = options.edge;
  for (const auto& [label, edge] : options.label_edges)
    report_.longest_edge = std::max(report_.longest_edge, edge);
  for (std::size_t k = 0; k < scaled_.surfaces.size(); ++k) {
    const auto points = points_on(scaled_.surfaces[k], point_spacing * scaled_options_.edge, k);
    surface_points_.insert(surface_points_.end(), points.begin(), points.end());
  }
  stopwatch_.phase("prepare");
}

// A body whose features are far smaller than the edge cannot be meshed well if they are kept. Without this
// check, the refinement, the relaxation and all further tries would take minutes to find that out.
void Tries::keep_features(std::size_t k) {
  const Surface& surface = scaled_.surfaces[k];
  const double shortest_edge = Sizing(scaled_, scaled_options_).shortest();
  FeatureLines found = feature_lines(surface, options_.feature_angle, 6 * scaled_options_.edge,
                                     finest_feature * shortest_edge);
  scaled_.features[k] = std::move(found.lines);
  if (found.fine == 0) return;
  const Vec3d p = unit_.from_unit(found.fine_at);
  std::ostringstream text;
  text << (model_.surfaces.size() > 1 ? "surface " + std::to_string(k) + ": " : "") << found.fine
       << (found.fine == 1 ? " sharp edge is" : " sharp edges are") << " shorter than "
       << rounded(finest_feature) << " of the mesh's edge, first near (" << rounded(p.x()) << ", "
       << rounded(p.y()) << ", " << rounded(p.z())
       << ") m: not kept sharp, with the edges that end there; a shorter --edge (or --ball there) keeps them";
  warnings_.push_back(text.str());
}

bool Tries::failed(Mesher mesher) const {
  return std::any_of(report_.attempts.begin(), report_.attempts.end(),
                     [&](const Attempt& a) { return a.mesher == mesher && !a.failure.empty(); });
}

bool Tries::available(Mesher mesher) const {
  if (mesher == options_.mesher) return true;
  if (mesher == Mesher::tetgen)
    return !model_.is_image() && options_.label_edges.empty() && options_.balls.empty() &&
           !find_program("lobe-tetgen").empty();
  return true;
}

TetMesh Tries::mesh_with(Mesher mesher, double factor) {
  MeshOptions options = scaled_options_;
  options.time_limit = std::max(0.001, options_.time_limit - stopwatch_.elapsed());
  options.edge *= factor;
  if (mesher == Mesher::cgal) {
    if (!model_.is_image()) refuse_touching(joined_surface(model_.surfaces));
    for (auto& [label, edge] : options.label_edges) edge *= factor;
    for (SizeBall& ball : options.balls) ball.edge *= factor;
    const Sizing sizing(scaled_, options);
    const MeshingRun run{sizing, seeds_, options.time_limit, expected_tets(options, scaled_),
                         [&](double done) { options.progress("mesh (cgal)", done); }};
    TetMesh mesh = model_.is_image() ? mesh_image_with_cgal(scaled_, run) : mesh_with_cgal(scaled_, run);
    stopwatch_.phase("cgal");
    return mesh;
  }
  options.progress("remesh", -1);
  const Model remeshed = remesh_without_intersections(scaled_, options.edge);
  stopwatch_.phase("remesh");
  options.progress("mesh (tetgen)", -1);
  TetMesh mesh = mesh_with_tetgen(remeshed, options.edge, options);
  peel_flat_tets(mesh);
  stopwatch_.phase("tetgen");
  return mesh;
}

void Tries::improve(TetMesh& mesh) {
  options_.progress("relax", -1);
  constexpr double on_line = 0.05;  // of the edge
  const double mean_edge = regular_edge(total_volume(mesh) / mesh.tet_count());
  const double shortest = report_.shortest_edge / unit_.size;
  const double edge = shortest < scaled_options_.edge ? shortest : mean_edge;
  const Freedom freedom = find_freedom(mesh, interfaces_, features_, on_line * edge);
  restore_volume(mesh, interfaces_, freedom);
  match_volumes(mesh, interfaces_, freedom, scaled_.volumes);
  relax(mesh, freedom,
        {.edge = edge, .poisson_ratio = options_.lambda / (2 * (options_.lambda + options_.mu))});
  match_volumes(mesh, interfaces_, freedom, scaled_.volumes);
  stopwatch_.phase("relax");
}

Remedy Tries::measure_gap(const TetMesh& mesh, MeshReport& report) const {
  const Surface faces = faces_of_surfaces(mesh);
  const NearestPoint faces_at(faces);
  const auto in_metres = [&](SurfaceGap gap) {
    for (double* length : {&gap.mean, &gap.percentile_95, &gap.largest}) *length *= unit_.size;
    gap.place = unit_.from_unit(gap.place);
    return gap;
  };
  const double spacing = point_spacing * scaled_options_.edge;
  report.surface_to_mesh = in_metres(gap_between(surface_points_, faces_at));
  report.mesh_to_surface = in_metres(gap_between(points_on(faces, spacing), surface_));
  const double bound = quality_gate.gap * report.longest_edge / unit_.size;
  Remedy remedy = remedy_for(surface_points_, surface_, faces_at, bound, spacing);
  report.keeping_edge = 0;
  for (const SizeBall& ball : remedy.balls)
    report.keeping_edge = report.keeping_edge == 0 ? unit_.size * ball.edge
                                                   : std::min(report.keeping_edge, unit_.size * ball.edge);
  return remedy;
}

// Shortens edges where the best mesh has lost a label or, if asked to, a part of the surface. Returns whether
// it did.
bool Tries::ask_for_lost_parts() {
  if (options_.mesher != Mesher::cgal) return false;
  bool any = false;
  for (std::size_t r = 0; r < best_report_.parts.size(); ++r) {
    const int label = model_.labels[r];
    if (best_report_.parts[r].tets > 0 || scaled_options_.label_edges.contains(label)) continue;
    scaled_options_.label_edges[label] = edge_within(scaled_, int(r));
    any = true;
  }
  if (options_.keep_thin && !remedy_.balls.empty()) {
    scaled_options_.balls.insert(scaled_options_.balls.end(), remedy_.balls.begin(), remedy_.balls.end());
    seeds_.insert(seeds_.end(), remedy_.seeds.begin(), remedy_.seeds.end());
    any = true;
  }
  if (any) report_.shortest_edge = unit_.size * Sizing(scaled_, scaled_options_).shortest();
  return any;
}

// Keeps the mesh if it is the best so far. Meshes are compared by the number of their labels, then by whether
// they have all parts of the surface, then by how near they are to passing the gate, then by their time step.
void Tries::one(Mesher mesher, double factor) {
  Attempt attempt{mesher, factor * options_.edge, 0, 0, {}};
  try {
    TetMesh mesh = mesh_with(mesher, factor);
    if (mesh.tet_count() == 0) throw MeshingFailure("no tetrahedra: choose a shorter --edge");
    improve(mesh);
    MeshReport now = report_;
    Remedy remedy = measure_gap(mesh, now);
    mesh.points = unit_.from_unit(mesh.points);
    prepare(mesh, "mesh");
    mesh = in_spatial_order(mesh);
    now.mesher = mesher;
    options_.progress("measure", -1);
    measure(mesh, model_, options_, now);
    stopwatch_.phase("measure");
    attempt.min_dihedral = now.quality.min_dihedral;
    attempt.time_step_star = now.time_step_star;
    const auto rank = [](const MeshReport& r) {
      const double dihedral = r.quality.min_dihedral / quality_gate.min_dihedral,
                   altitude = r.quality.smallest_altitude_ratio / quality_gate.smallest_altitude_ratio,
                   step = r.time_step_star / quality_gate.time_step_star;
      const double near = std::min(1.0, quality_gate.gap * r.longest_edge / r.largest_gap());
      return std::tuple(-r.missing_labels(), near, std::min({1.0, dihedral, altitude, step}), step);
    };
    if (best_.tet_count() == 0 || rank(now) > rank(best_report_)) {
      best_ = std::move(mesh);
      best_report_ = std::move(now);
      remedy_ = std::move(remedy);
    }
  } catch (const MeshingFailure& error) {
    attempt.failure = error.what();
  } catch (const InputError& error) {  // of prepare(), or of a mesher that cannot mesh this body
    attempt.failure = error.what();
  }
  if (!attempt.failure.empty()) stopwatch_.phase(mesher == Mesher::cgal ? "cgal" : "tetgen");
  report_.attempts.push_back(attempt);
}

TetMesh Tries::best() {
  constexpr double jitter[] = {1.0, 0.97, 1.03, 0.94, 1.05, 0.91, 1.02, 0.98};
  const Mesher other = options_.mesher == Mesher::cgal ? Mesher::tetgen : Mesher::cgal;
  const bool both = available(other);
  // A mesher that has failed will fail again at almost the same edge, so the other mesher is tried.
  const auto again = [&](Mesher mesher, double factor) {
    if (!out_of_time() && (!both || !failed(mesher))) one(mesher, factor);
  };
  one(options_.mesher, 1);
  for (int i = 0; i < most_remedies && best_.tet_count() > 0 && ask_for_lost_parts(); ++i)
    again(options_.mesher, 1);
  for (int i = 1; i < options_.tries; ++i) again(options_.mesher, jitter[i]);
  // Almost the same edge loses the same parts of the surface.
  const auto is_worth_a_try = [&](int i) {
    return !best_report_.passes() && (i == 0 || best_.tet_count() == 0 || !best_report_.has_good_shapes());
  };
  for (int i = 0; i < second_tries && is_worth_a_try(i); ++i)
    again(both && i % 2 == 0 ? other : options_.mesher, jitter[both ? (i + 1) / 2 : i + 1]);
  if (best_.tet_count() == 0) throw MeshingFailure(report_.attempts.front().failure);
  best_report_.attempts = report_.attempts;
  best_report_.phases = phases_;
  report_ = best_report_;
  report_.warnings.insert(report_.warnings.begin(), warnings_.begin(), warnings_.end());
  return std::move(best_);
}

// The refinement of an image separates the labels, but the boundary of the mesh may touch itself where the
// boundary of the labels does.
void warn_of_pinches(const TetMesh& mesh, MeshReport& report) {
  const Diagnosis boundary = diagnose(boundary_surface(mesh));
  for (const Finding* finding : {&boundary.non_manifold_edges, &boundary.non_manifold_points}) {
    if (finding->count == 0) continue;
    report.warnings.push_back("the boundary of the mesh touches itself: " + finding->counted() + ", first " +
                              finding->places.front() +
                              "; choose a shorter --edge, or separate the parts there");
  }
}

// A label that is smaller than an edge gets edges of a third of its size, unless it has others already.
void shorten_for_small_labels(const Model& model, MeshOptions& options, std::vector<std::string>& notes) {
  if (options.mesher != Mesher::cgal) return;
  for (int region = 0; region < model.region_count(); ++region) {
    const double edge = edge_within(model, region);
    const int label = model.labels[std::size_t(region)];
    if (!(edge > 0) || 3 * edge >= options.edge || options.label_edges.contains(label)) continue;
    options.label_edges[label] = edge;
    notes.push_back("label " + std::to_string(label) + " is smaller than an edge: its edges are " +
                    rounded(edge) + " m (--label-edge " + std::to_string(label) + "=EDGE for others)");
  }
}

std::string words_of_gap(const MeshReport& report) {
  const SurfaceGap& gap = report.surface_to_mesh;
  std::ostringstream text;
  text << "parts of the surface are missing from the mesh: the surface is up to " << rounded(gap.largest)
       << " m from it, at (" << rounded(gap.place.x()) << ", " << rounded(gap.place.y()) << ", "
       << rounded(gap.place.z()) << ") m; edges of " << rounded(report.keeping_edge)
       << " m would keep them (--edge " << rounded(report.keeping_edge)
       << ", or --keep-thin for such edges only there)";
  return text.str();
}

}  // namespace

TetMesh mesh_model(const Model& model, const MeshOptions& options, MeshReport& report) {
  report = {};
  MeshOptions chosen = options;
  if (options.edge == 0) {
    chosen.edge = box_diagonal(joined_surface(model.surfaces)) / 25;
    chosen.keep_thin = true;
  }
  std::vector<std::string> notes;
  if (options.mesher == Mesher::cgal && chosen.edge > 0) shorten_for_small_labels(model, chosen, notes);
  check_options(chosen, model);
  report.edge = chosen.edge;
  TetMesh mesh = Tries(model, chosen, report).best();
  if (model.is_image()) warn_of_pinches(mesh, report);
  for (int& label : mesh.labels) label = model.labels[label];
  report.warnings.insert(report.warnings.begin(), notes.begin(), notes.end());
  report.warnings.insert(report.warnings.begin(), model.warnings.begin(), model.warnings.end());
  if (report.keeping_edge > 0) report.warnings.push_back(words_of_gap(report));
  if (!report.passes()) {
    report.warnings.push_back(
        "the mesh is below the gate (every label, smallest dihedral angle 15°, altitude 0.1 of the edge, "
        "dt* 0.5, one edge between surface and mesh): try another --edge, --feature-angle 180 (keeps no edge "
        "sharp), or smooth the surface "
        "there");
  }
  return mesh;
}

TetMesh tetrahedralise(const std::vector<Surface>& surfaces, const MeshOptions& options, MeshReport& report) {
  return mesh_model(make_model(surfaces), options, report);
}

TetMesh tetrahedralise(const LabelImage& image, const MeshOptions& options, MeshReport& report) {
  return mesh_model(make_model(image, options.smoothing), options, report);
}

}  // namespace lobe::meshing
