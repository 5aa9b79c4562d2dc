#include "lobe/forces/attachments.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>

#include "joined_meshes.h"
#include "lobe/error.h"
#include "lobe/mesh/outer_faces.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const Elastic tough{11540, 7692, 1000};  // E = 20 kPa, ν = 0.3
constexpr double gap = 1e-3;             // of the two blocks [m]
constexpr double bed_area = 4e-4;        // [m²]
constexpr double bed_stiffness = 1e6;    // [Pa/m]
constexpr double bed_energy = 20;        // [J/m²]

Mat3<double> corners_of(const TetMesh& mesh, const TetFace& face) {
  Mat3<double> x;
  for (int k = 0; k < 3; ++k) x.col(k) = mesh.points.col(mesh.tets(face_corners[face.face][k], face.tet));
  return x;
}

double area_of(const Mat3<double>& x) { return (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm() / 2; }

// A strand per triangle between two blocks, 20 mm wide, one above the other.
AttachmentSetup bed_of(const Setup& setup, double stiffness = bed_stiffness, double energy = bed_energy) {
  AttachmentSetup bed;
  bed.name = "bed";
  bed.holds_until = std::sqrt(2 * energy / (stiffness * bed.softening));
  const Locator locator(setup.mesh);
  for (const TetFace& face : outer_faces(setup.mesh)) {
    const Mat3<double> x = corners_of(setup.mesh, face);
    if (!(x.row(2).array() - 0.01).isZero(1e-9)) continue;
    StrandSetup strand;
    const Vec3d centre = x.rowwise().mean();
    strand.from = {face.tet, barycentric(setup.mesh, face.tet, centre)};
    strand.to = embed(locator, centre + Vec3d(0, 0, gap)).point;
    strand.length = gap;
    strand.area = area_of(x);
    strand.stiffness = stiffness * strand.area;
    bed.strands.push_back(strand);
  }
  return bed;
}

// The lower block is held at its bottom.
Setup tied_blocks(int n = 3, double stiffness = bed_stiffness) {
  TetMesh above = box_mesh({0.02, 0.02, 0.01}, n, n, 2);
  above.points.row(2).array() += 0.01 + gap;
  Setup setup = setup_of(joined(box_mesh({0.02, 0.02, 0.01}, n, n, 2), above));
  setup.materials = {tough};
  setup.damping = 20;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v});
  setup.attachments = {bed_of(setup, stiffness)};
  return setup;
}

// A hand that lifts the top of the upper block by this in a second.
Setup lifted(Setup setup, double by) {
  GraspSetup hand;
  hand.name = "hand";
  const double top = setup.mesh.points.row(2).maxCoeff();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) > top - 1e-9) hand.vertices.push_back(v);
  hand.path = {{0, {0, 0, 0}}, {1, {0, 0, by}}};
  setup.grasps = {hand};
  return setup;
}

// Displacements that raise the upper block as a whole.
template <class Real>
Mat3X<Real> raised(const Setup& setup, const Vec3d& by) {
  Mat3X<Real> u = Mat3X<Real>::Zero(3, setup.mesh.vertex_count());
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) > 0.01 + gap / 2) u.col(v) = by.cast<Real>();
  return u;
}

template <class Real>
Mat3X<double> bed_forces(World<Real>& world) {
  Mat3X<Real> f = Mat3X<Real>::Zero(3, world.body().motion.u.padded().cols());
  if (auto* attachments = term_of<Attachments>(world.body().terms))
    attachments->add_forces(world.body().here(), f);
  return f.template cast<double>();
}

AttachmentFigures figures_of(World<double>& world) {
  const std::vector<AttachmentFigures> all = attachment_figures(world);
  REQUIRE(all.size() == 1);
  return all[0];
}

std::string tie_refusal(World<double>& world, const Command& command) {
  try {
    world.apply(command);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Mat3X<double> wavy_displacements(Index vertices) {
  Mat3X<double> u = 1e-3 * Mat3X<double>::Ones(3, vertices);
  for (Index i = 0; i < u.size(); ++i) u(i) += 4e-4 * std::sin(double(7 * i % 101));
  return u;
}

}  // namespace

TEST_CASE("a bed pulls with its stiffness times its area, and softens by its law") {
  const Setup setup = tied_blocks();
  const AttachmentSetup& bed = setup.attachments[0];
  const double holds = bed.holds_until;
  CHECK(holds == near(3.6515e-3, 1e-4));
  const auto pull_at = [&](double elongation) {
    World<double> world = world_at(setup, raised<double>(setup, {0, 0, elongation}));
    const Mat3X<double> f = bed_forces(world);
    CHECK(f.rowwise().sum().norm() < 1e-12);  // momentum
    double up = 0;
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (setup.mesh.points(2, v) < 0.01 + gap / 2) up += f(2, v);
    return up;
  };
  const double largest = bed_stiffness * bed_area * holds;
  CHECK(pull_at(-5e-4) == 0);
  CHECK(pull_at(1e-3) == near(bed_stiffness * bed_area * 1e-3, 1e-12));
  CHECK(pull_at(holds) == near(largest, 1e-12));
  CHECK(pull_at(2 * holds) == near(largest / 2, 1e-12));
  CHECK(pull_at(3.01 * holds) == 0);
}

TEST_CASE("forces of an attachment are minus the slope of its energy, and turn nothing") {
  const Setup setup = tied_blocks(2);
  const auto energy_at = [&](const Mat3X<double>& u) {
    const Energies with = world_at(setup, u).energies();
    return with.applied;
  };
  const Mat3X<double> u =
      raised<double>(setup, {1e-3, 2e-3, 1e-3}) + wavy_displacements(setup.mesh.vertex_count());
  World<double> world = world_at(setup, u);
  const Mat3X<double> f = bed_forces(world);
  REQUIRE(f.norm() > 0);
  constexpr double h = 1e-7;  // [m]
  for (Index i = 0; i < u.size(); i += 7) {
    Mat3X<double> plus = u, minus = u;
    plus(i) += h;
    minus(i) -= h;
    CHECK(f(i) == near(-(energy_at(plus) - energy_at(minus)) / (2 * h), 1e-5, f.norm()));
  }
  Vec3d torque = Vec3d::Zero();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    torque += Vec3d(setup.mesh.points.col(v) + u.col(v)).cross(Vec3d(f.col(v)));
  CHECK(torque.norm() < 1e-12 * f.norm());
  World<float> single = world_at<float>(setup, u.cast<float>());
  CHECK((bed_forces(single) - f).norm() < 1e-5 * f.norm());
}

TEST_CASE("a bed that is torn off releases its area times its fracture energy") {
  World<double> world(lifted(tied_blocks(), 0.05));
  const AttachmentFigures before = figures_of(world);
  CHECK(before.name == "bed");
  CHECK(before.area == near(bed_area, 1e-12));
  double area = 0, height = 0;
  Index events = 0;
  std::string last;
  const auto now_left = [&] { return figures_of(world).strands; };
  for (int i = 0; i < 50; ++i) {
    const Report report = world.advance(0.02);
    REQUIRE(report.ok);
    for (const Event& event : report.events) {
      CHECK(event.kind == Event::Kind::torn);
      area += event.size;
      REQUIRE(event.place);
      height = event.place->z();
      if (events == 0 && now_left() > 0) CHECK(event.text == "attachment \"bed\" begins to tear");
      last = event.text;
      ++events;
    }
    const AttachmentFigures now = figures_of(world);
    CHECK(now.torn.energy == near(bed_energy * now.torn.area, 1e-12, bed_energy * bed_area));
    CHECK(now.torn.area + now.area == near(bed_area, 1e-12));
    CHECK(now.released >= now.torn.energy);
  }
  const AttachmentFigures after = figures_of(world);
  CHECK(after.strands == 0);
  CHECK(after.torn.count == before.strands);
  CHECK(after.released == near(bed_energy * bed_area, 1e-12));
  CHECK(after.cut.count == 0);
  CHECK(events > 0);
  CHECK(area == near(bed_area, 1e-12));
  CHECK(height > 0.01);
  CHECK(height < 0.05);
  CHECK(last == "attachment \"bed\" has torn off: 400 mm²");
  CHECK(bed_forces(world).isZero(0));
  CHECK(std::isfinite(world.energies().total()));
  CHECK(fault_of(world).empty());
}

TEST_CASE("the work of a hand that tears a bed is in the energies and in what was released") {
  Setup setup = lifted(tied_blocks(), 0.03);
  setup.damping = 0;
  World<double> world(setup);
  double work = 0;
  const double start = world.energies().total();
  for (int i = 0; i < 200; ++i) {
    const Report report = world.advance(0.005);
    REQUIRE(report.ok);
    work += world.tools().lists().grasps[0].force.z() * 0.03 * 0.005;
  }
  const AttachmentFigures figures = figures_of(world);
  CHECK(figures.torn.count > 0);
  CHECK(world.energies().total() - start + figures.released == near(work, 0.005));
}

namespace {

// A strip whose lower face is bonded to the world up to x = 0, with a free arm beyond.
struct Strip {
  static constexpr double thickness = 1e-3, energy = 5;       // [m], [J/m²]
  static constexpr double young = 200 * energy / thickness;   // so that it is stretched by 1 % at most [Pa]
  static constexpr int bonded = 22, arm = 30;                 // in thicknesses
  static constexpr double bending = 4.3 * young * 1e-9 / 12;  // of one layer of tetrahedra, roughly [N m]
  static constexpr double length = arm * thickness;           // of the arm [m]
};

Setup bonded_strip() {
  constexpr double h = Strip::thickness;
  TetMesh mesh = box_mesh({h * (Strip::bonded + Strip::arm), h, h}, Strip::bonded + Strip::arm, 1, 1);
  mesh.points.row(0).array() -= h * Strip::bonded;
  Setup setup = setup_of(mesh);
  setup.materials = {{0, Strip::young / 2, 1000}};
  setup.damping = 5;
  AttachmentSetup bed;
  bed.name = "bed";
  bed.holds_until = 0.1 * h;
  const double stiffness = 2 * Strip::energy / (bed.softening * bed.holds_until * bed.holds_until);
  for (const TetFace& face : outer_faces(mesh)) {
    const Mat3<double> x = corners_of(mesh, face);
    if (!x.row(2).isZero(0) || x.row(0).maxCoeff() > 1e-9) continue;
    StrandSetup strand;
    strand.anchor = x.rowwise().mean();
    strand.from = {face.tet, barycentric(mesh, face.tet, strand.anchor)};
    strand.area = area_of(x);
    strand.stiffness = stiffness * strand.area;
    bed.strands.push_back(strand);
  }
  setup.attachments = {bed};
  return setup;
}

// The arm's end, which may turn, is led up to where the arm stands at an angle to the bed: an elastica of
// the bending length ℓ, as long as the arm. Then it moves on as what is peeled makes the arm longer.
Setup peeled_strip(double angle) {
  Setup setup = bonded_strip();
  GraspSetup hand;
  hand.name = "hand";
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > Strip::length - 1e-9 && setup.mesh.points(2, v) == 0)
      hand.vertices.push_back(v);
  constexpr double turning = 0.1, peeling = 0.24, peeled = 12 * Strip::thickness;  // [s], [s], [m]
  constexpr int parts = 40;
  const double l = std::sqrt(Strip::bending * (1 - std::cos(angle)) / Strip::energy);
  const auto end_at = [&](double a) -> Vec3d {
    const Vec3d along(std::cos(a), 0, std::sin(a)), across(std::sin(a), 0, -std::cos(a));
    return 2 * l * std::sin(a / 2) * across + (Strip::length - 2 * l * (1 - std::cos(a / 2))) * along;
  };
  for (int i = 0; i <= parts; ++i) {
    const double t = double(i) / parts;
    hand.path.push_back({turning * t, end_at(angle * t * t * (3 - 2 * t)) - end_at(0)});
  }
  hand.path.push_back({turning + peeling,
                       hand.path.back().position + peeled * Vec3d(std::cos(angle) - 1, 0, std::sin(angle))});
  setup.grasps = {hand};
  return setup;
}

}  // namespace

TEST_CASE("a strip is peeled off with the force G b / (1 - cos angle)") {
  for (const double degrees : {60.0, 90.0, 120.0}) {
    CAPTURE(degrees);
    World<double> world(peeled_strip(degrees * std::numbers::pi / 180));
    Vec3d sum = Vec3d::Zero();
    int frames = 0;
    for (int i = 0; i < 170; ++i) {
      REQUIRE(world.advance(0.002).ok);
      const double torn = figures_of(world).torn.area / (Strip::thickness * Strip::thickness);
      if (torn < 3 || torn > 9) continue;
      sum += world.tools().lists().grasps[0].force;
      ++frames;
    }
    REQUIRE(frames > 30);
    const Vec3d mean = sum / frames;
    const double angle = std::atan2(mean.z(), mean.x());  // of the force
    const double expected = Strip::thickness * Strip::energy / (1 - std::cos(angle));
    MESSAGE("force at ", angle * 180 / std::numbers::pi, " degrees, ", mean.norm() / expected,
            " of what is expected");
    CHECK(std::abs(angle * 180 / std::numbers::pi - degrees) < 6);
    CHECK(mean.norm() == near(expected, 0.03));
  }
}

TEST_CASE("a world goes on with the same bits from the middle of a peel") {
  Setup setup = lifted(tied_blocks(2), 0.05);
  SUBCASE("of a bed between two bodies") {}
  SUBCASE("of a bed that ends in the world") {
    for (StrandSetup& strand : setup.attachments[0].strands) {
      strand.anchor =
          setup.mesh.points(Eigen::all, setup.mesh.tets.col(strand.from.tet)) * strand.from.weights;
      strand.from = std::exchange(strand.to, {});
    }
  }
  World<float> world(setup);
  for (int i = 0; i < 8; ++i) REQUIRE(world.advance(0.02).ok);
  const AttachmentFigures middle = attachment_figures(world).at(0);
  CHECK(middle.released > 0);
  CHECK(middle.strands > 0);
  const std::string saved = checkpoint_bytes(world.save());
  World<float> other(setup);
  other.restore(parse_checkpoint<float>("bytes", saved));
  for (int i = 0; i < 24; ++i) {
    const Report a = world.advance(0.02), b = other.advance(0.02);
    CHECK(a.events.size() == b.events.size());
    CHECK(same_bits(world, other));
  }
  const AttachmentFigures a = attachment_figures(world).at(0), b = attachment_figures(other).at(0);
  CHECK(a.strands == b.strands);
  CHECK(a.released == b.released);
  CHECK(a.torn.count > 0);
}

TEST_CASE("the setup of the present body has the strands that are left, as damaged as they are") {
  World<double> world(lifted(tied_blocks(2), 0.05));
  for (int i = 0; i < 8; ++i) REQUIRE(world.advance(0.02).ok);
  CompactMesh compacted;
  const Setup now = world.current_setup(compacted);
  REQUIRE(now.attachments.size() == 1);
  double reached = 0;
  for (const StrandSetup& strand : now.attachments[0].strands) reached = std::max(reached, strand.reached);
  CHECK(reached > now.attachments[0].holds_until);
  World<double> again(now);
  CHECK(figures_of(again).strands == figures_of(world).strands);
}

TEST_CASE("a cautery burns the strands that it meets, and a scalpel cuts them") {
  Setup setup = tied_blocks();
  setup.attachments[0].holds_until = unlimited;
  SUBCASE("a cautery") {
    CauterySetup cautery;
    cautery.radius = 4e-4;  // it fits between the blocks
    cautery.path = {{0, {0.0111, -0.01, 0.0105}}, {1, {0.0111, 0.03, 0.0105}}};
    setup.cauteries = {cautery};
  }
  SUBCASE("a scalpel") {
    ScalpelSetup scalpel;
    scalpel.path = {{0, {0.005, -0.01, 0.0105}}, {1, {0.005, 0.03, 0.0105}}};
    scalpel.heels = {{0.015, -0.01, 0.0105}, {0.015, 0.03, 0.0105}};
    setup.scalpels = {scalpel};
  }
  const bool is_cautery = !setup.cauteries.empty();
  Index met = 0;
  for (const StrandSetup& strand : setup.attachments[0].strands) {
    const Mat34<double> corners = tet_points(setup.mesh, strand.from.tet);
    const double x = (corners * strand.from.weights).x();
    met += is_cautery ? std::abs(x - 0.0111) < 4e-4 : x > 0.005 && x < 0.015;
  }
  CHECK(met == (is_cautery ? 3 : 6));
  World<double> world(setup);
  const Index before = figures_of(world).strands;
  Index removed = 0;
  for (int i = 0; i < 50; ++i) {
    const Report report = world.advance(0.02);
    REQUIRE(report.ok);
    removed += report.tets_removed;
  }
  const AttachmentFigures after = figures_of(world);
  CHECK(removed == 0);
  CHECK(after.cut.count == met);
  CHECK(after.torn.count == 0);
  CHECK(after.strands + after.cut.count == before);
}

TEST_CASE("tissue that a cautery burns is an event, with its volume and its place") {
  Setup setup = tied_blocks();
  setup.attachments.clear();
  CauterySetup cautery;
  cautery.radius = 1e-3;
  cautery.path = {{0, {0.003, 0.004, 0.002}}, {0.1, {0.003, 0.004, 0.002}}};
  setup.cauteries = {cautery};
  World<double> world(setup);
  const Report report = world.advance(0.02);
  REQUIRE(report.tets_removed > 0);
  REQUIRE(report.events.size() == 1);
  const Event& event = report.events[0];
  double volume = 0;
  Vec3d centre = Vec3d::Zero();
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    if (world.elements().topology.alive(t)) continue;
    const double of_tet = signed_volume(tet_points(setup.mesh, t));
    volume += of_tet;
    centre += of_tet * barycentre(setup.mesh, t);
  }
  CHECK(event.kind == Event::Kind::burnt);
  CHECK(event.size == near(volume, 1e-12));
  REQUIRE(event.place);
  CHECK((*event.place - centre / volume).norm() < 1e-12);
  CHECK(event.text.empty());
}

TEST_CASE("strands go with the tissue of their ends, and stay on their side of a cut") {
  SUBCASE("tetrahedra that are removed") {
    World<double> world(tied_blocks());
    const Index before = figures_of(world).strands;
    CompactMesh compacted;
    const Index tet = world.current_setup(compacted).attachments[0].strands[0].from.tet;
    world.remove_tets({tet});
    const AttachmentFigures after = figures_of(world);
    CHECK(after.strands < before);
    CHECK(after.strands + after.cut.count == before);
    CHECK(world.advance(0.01).ok);
    CHECK(fault_of(world).empty());
  }
  SUBCASE("tetrahedra that a blade divides") {
    Setup setup = tied_blocks();
    ScalpelSetup scalpel;
    scalpel.path = {{0, {0.0093, -0.01, -0.002}}, {0.1, {0.0093, 0.03, -0.002}}};
    scalpel.heels = {{0.0093, -0.01, 0.0101}, {0.0093, 0.03, 0.0101}};
    setup.scalpels = {scalpel};
    World<double> world(setup);
    Index copied = 0;
    for (int i = 0; i < 10; ++i) copied += world.advance(0.01).tets_copied;
    REQUIRE(copied > 0);
    for (const auto& term : world.body().terms) {
      const auto* attachments = dynamic_cast<const Attachments<double>*>(term.get());
      if (!attachments) continue;
      const std::vector<AttachmentSetup> now = attachments->as_setup();
      for (const StrandSetup& strand : now.at(0).strands)
        CHECK(distance_to_material(rest_position(strand.from, world.elements()), strand.from.tet,
                                   world.elements(), world.grains()) < 1e-9);
    }
    CHECK(figures_of(world).strands > 0);
    CHECK(fault_of(world).empty());
  }
}

TEST_CASE("attachments that cannot be made are refused, and change nothing") {
  Setup setup = tied_blocks(2);
  const AttachmentSetup bed = std::exchange(setup.attachments, {})[0];
  World<double> world(setup);
  const Mat3X<double> alone = world.forces();
  AttachmentSetup other = bed;
  CHECK(tie_refusal(world, Detach{"bed"}) == "attachment \"bed\": there is none of this name");
  other.strands.clear();
  CHECK(tie_refusal(world, Attach{other}) == "command: attachment \"bed\" has no strand");
  other = bed;
  other.strands[0].to.tet = other.strands[0].from.tet;
  CHECK(tie_refusal(world, Attach{other}).find("has a strand with both ends in tetrahedron") !=
        std::string::npos);
  other = bed;
  other.strands[0].to.tet = 5000;
  CHECK(tie_refusal(world, Attach{other}).starts_with("tetrahedron 5000: "));
  other = bed;
  other.softening = 1;
  CHECK(tie_refusal(world, Attach{other}).find("needs a softening above 1") != std::string::npos);
  other = bed;
  other.strands[0].stiffness = std::nan("");
  CHECK(tie_refusal(world, Attach{other}).find("has a strand without a valid end") != std::string::npos);
  CHECK(attachment_figures(world).empty());

  world.apply(Attach{bed});
  CHECK(figures_of(world).area == near(bed_area, 1e-12));
  CHECK(tie_refusal(world, Attach{bed}) == "attachment \"bed\": there is one of this name already");
  CHECK((world.forces() - alone).norm() < 1e-9);
  world.set_state(
      {raised<double>(setup, {0, 0, 1e-3}), Mat3X<double>::Zero(3, setup.mesh.vertex_count()), 0, 0});
  const double stored = world.energies().applied;
  CHECK(stored == near(bed_stiffness * bed_area * 1e-6 / 2, 1e-12));
  world.apply(Detach{"bed"});
  CHECK(figures_of(world).strands == 0);
  CHECK(figures_of(world).cut.energy == near(stored, 1e-12));
  CHECK(world.energies().applied == 0);
  world.apply(Attach{bed});  // nothing was left of it
  CHECK(figures_of(world).area == near(bed_area, 1e-12));
  setup.attachments = {bed, bed};
  CHECK_THROWS_AS(World<double>{setup}, InputError);
}

TEST_CASE("a stiff bed shortens the step, and no frame is repeated") {
  Setup setup = lifted(tied_blocks(3, 3e7), 0.01);
  setup.attachments[0].holds_until = unlimited;
  setup.damping = 0;
  Setup without = setup;
  without.attachments.clear();
  World<double> world(setup), free(without);
  CHECK(world.time_step_limit() < 0.7 * free.time_step_limit());
  for (int i = 0; i < 10; ++i) {
    const Report report = world.advance(0.01);
    REQUIRE(report.ok);
    CHECK(report.reruns == 0);
  }
}
