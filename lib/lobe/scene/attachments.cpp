// Attachments of a scene as strands between points of the mesh.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>

#include "lobe/cut/distance.h"
#include "lobe/diagnostics/locate.h"
#include "lobe/forces/embedded.h"
#include "lobe/scene/resolve_parts.h"

namespace lobe {
namespace {

constexpr double finest_spacing = 0.2;  // of a face's edge

using Corners = Mat3<double>;  // of a face, one per column [m]

Corners corners_of(const TetMesh& mesh, const TetFace& face) {
  Corners x;
  for (int k = 0; k < 3; ++k)
    x.col(k) = mesh.points.col(mesh.tets(face_corners[std::size_t(face.face)][k], face.tet));
  return x;
}

double area_of(const Corners& x) { return (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm() / 2; }

// The centroids of the n² congruent triangles into which the edges' division by n divides a face.
template <class Visit>
void visit_parts(const Corners& x, int n, Visit&& visit) {
  const Vec3d a = (x.col(1) - x.col(0)) / n, b = (x.col(2) - x.col(0)) / n;
  for (int i = 0; i < n; ++i)
    for (int k = 0; i + k < n; ++k) {
      const Vec3d corner = x.col(0) + i * a + k * b;
      visit(Vec3d(corner + (a + b) / 3));
      if (i + k + 1 < n) visit(Vec3d(corner + 2 * (a + b) / 3));
    }
}

// Finds the nearest of some faces.
class NearestFace {
 public:
  NearestFace(const TetMesh& mesh, const std::vector<TetFace>& faces) {
    for (const TetFace& face : faces) {
      const Corners x = corners_of(mesh, face);
      entries_.push_back({face.tet, x, {x.rowwise().minCoeff(), x.rowwise().maxCoeff()}});
    }
  }
  struct Found {
    Index tet = -1;
    Vec3d place = Vec3d::Zero();  // [m]
    double distance = std::numeric_limits<double>::infinity();
  };
  Found nearest(const Vec3d& p) const {
    Found found;
    for (const Entry& entry : entries_) {
      if (entry.box.exteriorDistance(p) >= found.distance) continue;
      const Vec3d q = nearest_on_triangle(p, entry.x.col(0), entry.x.col(1), entry.x.col(2));
      if (const double distance = (q - p).norm(); distance < found.distance) found = {entry.tet, q, distance};
    }
    return found;
  }

 private:
  struct Entry {
    Index tet;
    Corners x;
    Eigen::AlignedBox3d box;
  };
  std::vector<Entry> entries_;
};

class AttachmentResolver {
 public:
  explicit AttachmentResolver(Resolution& resolution)
      : resolution_(resolution), setup_(resolution.result.setup), faces_(outer_faces(setup_.mesh)) {}

  void resolve(const SceneAttachment& attachment, const std::string& place) {
    const std::size_t faults_before = resolution_.faults.size();
    AttachmentSetup made;
    made.name = attachment.name;
    made.softening = attachment.softening;
    if (const auto* bed = std::get_if<SceneBed>(&attachment.what))
      add_bed(*bed, made, place + "/bed");
    else
      add_ligament(std::get<SceneLigament>(attachment.what), made, place + "/ligament");
    if (resolution_.faults.size() == faults_before) setup_.attachments.push_back(std::move(made));
  }

 private:
  // ---- Beds

  void add_bed(const SceneBed& bed, AttachmentSetup& made, const std::string& place) {
    const std::vector<TetFace> from = faces_of(bed.from, place + "/from"),
                               to = bed.to ? faces_of(*bed.to, place + "/to") : std::vector<TetFace>{};
    if (from.empty() || (bed.to && to.empty()) || share_a_face(from, to, place)) return;
    if (bed.spacing > 0 && !check_spacing(bed, from, place)) return;
    if (bed.fracture_energy)
      made.holds_until = std::sqrt(2 * *bed.fracture_energy / (bed.stiffness * made.softening));
    std::optional<NearestFace> other;
    if (bed.to) other.emplace(setup_.mesh, to);
    NearestFace::Found closest;
    for (const TetFace& face : from) {
      const Corners x = corners_of(setup_.mesh, face);
      const double area = area_of(x);
      const int n = bed.spacing > 0 ? std::max(1, int(std::lround(std::sqrt(area) / bed.spacing))) : 1;
      visit_parts(x, n, [&](const Vec3d& p) {
        StrandSetup strand;
        strand.from = point_in(face.tet, p);
        strand.area = area / (n * n);
        strand.stiffness = bed.stiffness * strand.area;
        if (other && !reach(*other, p, bed.within, closest, strand)) return;
        if (!other) strand.anchor = p;
        made.strands.push_back(std::move(strand));
      });
    }
    if (!made.strands.empty()) return check_ends(made, place);
    resolution_.fail(place + "/within", rounded(bed.within) +
                                            " m: no strand reaches from \"from\" to \"to\", " +
                                            "which are at least " + rounded(closest.distance) +
                                            " m apart, at " + triple_of(closest.place) + " m");
  }

  // False if the other part is too far from p.
  bool reach(const NearestFace& other, const Vec3d& p, double within, NearestFace::Found& closest,
             StrandSetup& strand) const {
    const NearestFace::Found found = other.nearest(p);
    if (found.distance < closest.distance) closest = found;
    if (found.distance > within + rounding()) return false;
    strand.to = point_in(found.tet, found.place);
    strand.length = found.distance;
    return true;
  }

  std::vector<TetFace> faces_of(const Selector& selector, const std::string& place) {
    std::vector<TetFace> found =
        resolution_.selected([&] { return select_faces(selector, setup_.mesh, faces_, place); });
    if (found.empty() && resolution_.faults.empty()) resolution_.fail_empty(place, "boundary face");
    return found;
  }

  bool share_a_face(const std::vector<TetFace>& from, const std::vector<TetFace>& to,
                    const std::string& place) {
    for (const TetFace& face : from) {
      if (std::find(to.begin(), to.end(), face) == to.end()) continue;
      resolution_.fail(place + "/to", "selects face " + std::to_string(face.face) + " of tetrahedron " +
                                          std::to_string(face.tet) +
                                          ", as \"from\" does: a strand would join it with itself");
      return true;
    }
    return false;
  }

  bool check_spacing(const SceneBed& bed, const std::vector<TetFace>& from, const std::string& place) {
    double area = 0;
    for (const TetFace& face : from) area += area_of(corners_of(setup_.mesh, face));
    const double edge = std::sqrt(4 / std::sqrt(3.0) * area / double(from.size()));
    if (bed.spacing >= finest_spacing * edge) return true;
    resolution_.fail(place + "/spacing", rounded(bed.spacing) +
                                             " m, must be at least a fifth of the faces' edge, " +
                                             rounded(edge) + " m: finer than that tissue cannot resolve it");
    return false;
  }

  // ---- Ligaments

  void add_ligament(const SceneLigament& ligament, AttachmentSetup& made, const std::string& place) {
    StrandSetup strand;
    strand.from = find(ligament.from, place + "/from");
    if (ligament.ends_in_world)
      strand.anchor = ligament.to;
    else
      strand.to = find(ligament.to, place + "/to");
    strand.length = (ligament.to - ligament.from).norm() + ligament.slack;
    strand.stiffness = ligament.stiffness;
    if (ligament.strength) made.holds_until = *ligament.strength / ligament.stiffness;
    made.strands.push_back(std::move(strand));
    check_ends(made, place);
  }

  EmbeddedPoint find(const Vec3d& X, const std::string& place) {
    if (!locator_) locator_.emplace(setup_.mesh);
    const FoundPoint found = embed(*locator_, X);
    if (found.distance > rounding())
      resolution_.fail(place, "is " + rounded(found.distance) + " m outside of every tetrahedron");
    return found.point;
  }

  // ---- Both

  void check_ends(const AttachmentSetup& made, const std::string& place) {
    for (const StrandSetup& strand : made.strands) {
      if (strand.from.tet == strand.to.tet)
        return resolution_.fail(place, "a strand has both ends in tetrahedron " +
                                           std::to_string(strand.from.tet) +
                                           ", where it would pull at nothing");
      for (const Index tet : {strand.from.tet, strand.to.tet})
        if (tet >= 0 && setup_.region_of[std::size_t(tet)] == RegionModel::precomputed)
          return resolution_.fail(place, "a strand ends in tetrahedron " + std::to_string(tet) +
                                             " of a precomputed region, where nothing can pull: make it "
                                             "\"nonlinear\" or \"tensor-mass\" there");
    }
  }

  EmbeddedPoint point_in(Index tet, const Vec3d& X) const { return {tet, barycentric(setup_.mesh, tet, X)}; }
  double rounding() const {
    if (rounding_ < 0)
      rounding_ = 1e-6 * (bounding_box(setup_.mesh).max - bounding_box(setup_.mesh).min).norm();
    return rounding_;
  }
  static std::string triple_of(const Vec3d& x) {
    return "[" + rounded(x[0]) + ", " + rounded(x[1]) + ", " + rounded(x[2]) + "]";
  }

  Resolution& resolution_;
  Setup& setup_;
  std::vector<TetFace> faces_;
  std::optional<Locator> locator_;
  mutable double rounding_ = -1;  // [m]
};

}  // namespace

void SceneAttachment::resolve(const std::vector<SceneAttachment>& all, Resolution& resolution) {
  AttachmentResolver resolver(resolution);
  for (std::size_t i = 0; i < all.size(); ++i) resolver.resolve(all[i], "/attachments/" + std::to_string(i));
}

template <class Json>
Json SceneAttachment::summary(const Setup& setup, std::size_t number) const {
  const AttachmentSetup& made = setup.attachments[number];
  double area = 0, energy = 0, longest = 0;
  for (const StrandSetup& strand : made.strands) {
    area += strand.area;
    energy += strand.stiffness / 2 * softening * std::pow(made.holds_until, 2);
    longest = std::max(longest, strand.length);
  }
  Json entry = {{"name", name}, {"strands", made.strands.size()}, {"area_m2", area}, {"longest_m", longest}};
  if (std::isfinite(made.holds_until)) {
    entry["holds_until_m"] = made.holds_until;
    entry["torn_at_m"] = softening * made.holds_until;
    entry["fracture_energy_J"] = energy;
  }
  return entry;
}
template nlohmann::ordered_json SceneAttachment::summary(const Setup&, std::size_t) const;

template <class Json>
void SceneAttachment::print(const Json& attachment, std::ostream& out) {
  out << "attachment " << attachment["name"].template get<std::string>() << ": " << attachment["strands"]
      << (attachment["strands"] == 1 ? " strand" : " strands") << " of up to "
      << rounded(attachment["longest_m"]) << " m";
  if (attachment["area_m2"] > 0) out << " on " << rounded(attachment["area_m2"]) << " m²";
  if (attachment.contains("torn_at_m"))
    out << ", gives way from " << rounded(attachment["holds_until_m"]) << " m on, tears at "
        << rounded(attachment["torn_at_m"]) << " m, " << rounded(attachment["fracture_energy_J"])
        << " J in all";
  else
    out << ", does not tear";
}
template void SceneAttachment::print(const nlohmann::ordered_json&, std::ostream&);

}  // namespace lobe
