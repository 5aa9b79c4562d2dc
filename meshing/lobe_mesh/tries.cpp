// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/tries.h"

#include <cmath>
#include <sstream>
#include <tuple>

#include "lobe/error.h"
#include "lobe/mesh/spatial_order.h"
#include "lobe/text.h"
#include "lobe_mesh/check_options.h"
#include "lobe_mesh/child_process.h"
#include "lobe_mesh/clean.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/expected_tets.h"
#include "lobe_mesh/measure.h"
#include "lobe_mesh/sizing.h"

namespace lobe::meshing {
namespace {

constexpr double finest_feature = 0.15;  // of the shortest edge asked for
constexpr int most_remedies = 3;         // meshes with shorter edges where parts were lost
constexpr double shortened = 0.7;        // edges of a label that has not kept its volume
constexpr double near_gate = 0.8;        // shapes, of those of the gate

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

}  // namespace

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
    if (!model.is_image() && !model.shares_walls())  // an image is smooth but for the steps between voxels
      keep_features(k);
    for (const Polyline& line : scaled_.features[k]) features_.push_back(surface.points(Eigen::all, line));
    surfaces_.emplace_back(surface);
  }
  for (std::size_t k = 0; k < surfaces_.size(); ++k)
    interfaces_[std::minmax(model.sides[k].outside, model.sides[k].inside)] = &surfaces_[k];
  for (double& volume : scaled_.volumes) volume /= std::pow(unit_.size, 3);
  for (Mat3X<double>& line : scaled_.junctions) line = unit_.to_unit(line);
  if (model.shares_walls()) keep_junctions();
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

void Tries::keep_features(std::size_t k) {
  scaled_.features[k] = kept_lines(scaled_.surfaces[k],
                                   model_.surfaces.size() > 1 ? "surface " + std::to_string(k) + ": " : "");
}

// Lines where walls meet, and the sharp edges of all walls: they end on each other.
void Tries::keep_junctions() {
  CleanReport ignored;
  const Surface walls = clean(joined_surface(scaled_.surfaces), ignored);
  scaled_.junctions.clear();
  for (const Polyline& line : kept_lines(walls, ""))
    scaled_.junctions.emplace_back(walls.points(Eigen::all, line));
  features_ = scaled_.junctions;
  for (std::vector<Polyline>& lines : scaled_.features) lines.clear();  // they are among these
}

// A body whose features are far smaller than the edge cannot be meshed well if they are kept. Without this
// check, the refinement, the relaxation and all further tries would take minutes to find that out.
std::vector<Polyline> Tries::kept_lines(const Surface& surface, const std::string& name) {
  const double shortest_edge = Sizing(scaled_, scaled_options_).shortest();
  FeatureLines found = feature_lines(surface, options_.feature_angle, 6 * scaled_options_.edge,
                                     finest_feature * shortest_edge);
  if (found.fine == 0) return std::move(found.lines);
  const Vec3d p = unit_.from_unit(found.fine_at);
  std::ostringstream text;
  text << name << found.fine << (found.fine == 1 ? " sharp edge is" : " sharp edges are") << " shorter than "
       << rounded(finest_feature) << " of the mesh's edge, first near (" << rounded(p.x()) << ", "
       << rounded(p.y()) << ", " << rounded(p.z())
       << ") m: not kept sharp, with the edges that end there; a shorter --edge (or --ball there) keeps them";
  warnings_.push_back(text.str());
  return std::move(found.lines);
}

bool Tries::failed(Mesher mesher) const {
  return std::any_of(report_.attempts.begin(), report_.attempts.end(),
                     [&](const Attempt& a) { return a.mesher == mesher && !a.failure.empty(); });
}

bool Tries::available(Mesher mesher) const {
  if (mesher == options_.mesher) return true;
  if (mesher == Mesher::tetgen)
    return !model_.is_image() && !model_.shares_walls() && options_.label_edges.empty() &&
           options_.balls.empty() && !find_program("lobe-tetgen").empty();
  return true;
}

// Shortens the edges of a label whose volume the best mesh has not kept: to those of edge_within(), then by
// less each time. Returns whether it did.
bool Tries::shorten_edges_of(int region) {
  const int label = model_.labels[std::size_t(region)];
  if (options_.label_edges.contains(label)) return false;
  const auto known = scaled_options_.label_edges.find(label);
  const double now = known == scaled_options_.label_edges.end() ? scaled_options_.edge : known->second,
               edge = std::min(edge_within(scaled_, region), shortened * now);
  if (!(edge > 0) || !keeps_few_tets(scaled_, region, edge)) return false;
  scaled_options_.label_edges[label] = edge;
  return true;
}

// Shortens edges where the best mesh has lost a label or, if asked to, a part of the surface or of a label's
// volume. Returns whether it did.
bool Tries::ask_for_lost_parts() {
  if (options_.mesher != Mesher::cgal) return false;
  bool any = false;
  for (std::size_t r = 0; r < best_report_.parts.size(); ++r) {
    const int label = model_.labels[r];
    if (best_report_.parts[r].tets > 0 || scaled_options_.label_edges.contains(label)) continue;
    scaled_options_.label_edges[label] = edge_within(scaled_, int(r));
    any = true;
  }
  for (std::size_t r = 0; options_.keep_thin && r < best_report_.parts.size(); ++r) {
    const MeshReport::Part& part = best_report_.parts[r];
    if (part.tets > 0 && std::abs(part.volume_error()) > kept_volume) any |= shorten_edges_of(int(r));
  }
  if (options_.keep_thin && !remedy_.balls.empty()) {
    scaled_options_.balls.insert(scaled_options_.balls.end(), remedy_.balls.begin(), remedy_.balls.end());
    seeds_.insert(seeds_.end(), remedy_.seeds.begin(), remedy_.seeds.end());
    any = true;
  }
  if (!any) return false;
  report_.shortest_edge = unit_.size * Sizing(scaled_, scaled_options_).shortest();
  shapes_.clear();
  return true;
}

// An edge that is almost the same shakes slivers up, so that shapes differ from try to try. Where two are as
// far from the gate, something else spoils them, such as a wedge of the surface, and will do so again.
bool Tries::may_pass(Mesher mesher) const {
  const auto known = shapes_.find(mesher);
  if (known == shapes_.end() || known->second.size() < 2) return true;
  const auto [worst, best] = std::minmax_element(known->second.begin(), known->second.end());
  return *best >= near_gate || *best + 2 * (*best - *worst) >= 1;
}

// Keeps the mesh if it is the best so far. Meshes are compared by the number of their labels, then by whether
// they have all parts of the surface, then by whether several labels have their volumes, then by how near
// they are to passing the gate, then by their time step.
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
    attempt.largest_gap = now.largest_gap();
    const auto rank = [](const MeshReport& r) {
      const double near = std::min(1.0, quality_gate.gap * r.longest_edge / r.largest_gap());
      const double volume = r.parts.size() > 1 ? std::min(1.0, kept_volume / largest_volume_error(r)) : 1;
      return std::tuple(-r.missing_labels(), near, volume, std::min(1.0, shape_of(r)), r.time_step_star);
    };
    shapes_[mesher].push_back(shape_of(now));
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
  for (int i = 0; i < second_tries && is_worth_a_try(i); ++i) {
    const Mesher mesher = both && i % 2 == 0 ? other : options_.mesher;
    if (may_pass(mesher)) again(mesher, jitter[both ? (i + 1) / 2 : i + 1]);
  }
  if (best_.tet_count() == 0) throw MeshingFailure(report_.attempts.front().failure);
  best_report_.attempts = report_.attempts;
  best_report_.phases = phases_;
  report_ = best_report_;
  report_.warnings.insert(report_.warnings.begin(), warnings_.begin(), warnings_.end());
  return std::move(best_);
}

}  // namespace lobe::meshing
