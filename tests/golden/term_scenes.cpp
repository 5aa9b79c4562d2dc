#include <doctest/doctest.h>

#include "golden/boxes.h"
#include "golden/golden.h"
#include "joined_meshes.h"
#include "lobe/forces/embedded.h"
#include "lobe/forces/threads.h"
#include "lobe/mesh/joined_mesh.h"
#include "lobe/mesh/outer_faces.h"
#include "world_support.h"

namespace lobe::test {
namespace {

// What a run checks before its last frame, so that its bits are those of what its name says.
template <class Check>
auto in_the_end(Check check) {
  return [=](auto& world) {
    return [=, &world](int i) {
      if (i + 1 == frames) check(world);
    };
  };
}

EmbeddedPoint point_at(const Setup& setup, const Vec3d& X) { return embed(Locator(setup.mesh), X).point; }

// A box whose lower part is held by shares that fall from 1 at its bottom, whose upper end is cut off.
void add_holds(std::vector<GoldenRun>& runs) {
  Setup setup = box_of(RegionModel::nonlinear);
  setup.loose_pieces = LoosePieces::vanish;
  setup.prescribed.clear();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (const double x = setup.mesh.points(0, v); x < 0.003)
      setup.prescribed.push_back({v, Vec3d::Zero()});
    else if (x < 0.023)
      setup.partly_held.push_back({v, (0.023 - x) / 0.0201, Vec3d::Zero()});
  setup.scalpels.push_back({"blade",
                            0.1,
                            {{0.1, {0.036, -0.01, 0.06}}, {0.2, {0.036, -0.01, -0.01}}},
                            {{0.036, 0.06, 0.06}, {0.036, 0.06, -0.01}}});
  const Index tets = setup.mesh.tet_count();
  add_golden(runs, "partly held, a piece that vanishes", setup, frames, frame,
             in_the_end([=](auto& world) { CHECK(world.elements().topology.alive_count() < 0.9 * tets); }));
}

// A box that is sewn by a running suture of two ties, which cuts through the tissue at a bite.
void add_threads(std::vector<GoldenRun>& runs) {
  Setup setup = box_with_blade(RegionModel::nonlinear);
  setup.grasps.clear();
  StitchSetup stitch;
  stitch.name = "suture";
  stitch.material.holds = 0.4;
  for (const double x : {0.012, 0.022, 0.032})
    for (const double y : {0.018, 0.032}) stitch.bites.push_back(point_at(setup, {x, y, 0.046}));
  stitch.at = 0.02;
  stitch.ties = {{0, 1, 0.06, 0.006, 0.1}, {4, 5, 0.24, 0.02, 0.1}};
  setup.stitches = {stitch};
  add_golden(runs, "a suture that is tied and cuts through", setup, frames, frame,
             in_the_end([]<class Real>(World<Real>& world) {
               const Threads<Real>* threads = term_of<Threads>(world.body().terms);
               REQUIRE(threads);
               CHECK(threads->ledger().cut > 0);
             }));
}

// Two boxes, one above the other, tied by a strand for each triangle between them. The upper one is peeled
// off; a hook burns what is left.
void add_attachments(std::vector<GoldenRun>& runs) {
  constexpr double gap = 1e-3;
  TetMesh above = box_mesh({0.02, 0.02, 0.01}, 3, 3, 2);
  above.points.row(2).array() += 0.01 + gap;
  Setup setup = setup_of(joined(box_mesh({0.02, 0.02, 0.01}, 3, 3, 2), above));
  setup.damping = 20;
  GraspSetup grasp{"grasp", {}, {{0.04, Vec3d::Zero()}, {0.2, {0, 0, 0.0036}}}};
  AttachmentSetup bed;
  bed.name = "bed";
  bed.holds_until = 1e-3;
  for (const TetFace& face : outer_faces(setup.mesh)) {
    Mat3<double> x;
    for (int k = 0; k < 3; ++k)
      x.col(k) = setup.mesh.points.col(setup.mesh.tets(face_corners[face.face][k], face.tet));
    if ((x.row(2).array() - 0.01).abs().maxCoeff() > 1e-9) continue;
    const Vec3d centre = x.rowwise().mean();
    StrandSetup strand;
    strand.from = {face.tet, barycentric(setup.mesh, face.tet, centre)};
    strand.to = point_at(setup, centre + Vec3d(0, 0, gap));
    strand.length = gap;
    strand.area = (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm() / 2;
    strand.stiffness = 1e6 * strand.area;
    bed.strands.push_back(strand);
  }
  setup.attachments = {bed};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v});
    if (setup.mesh.points(2, v) > 0.0209 && setup.mesh.points(0, v) == 0) grasp.vertices.push_back(v);
  }
  setup.grasps = {grasp};
  CauterySetup hook{"hook", 0.001, {{0.24, {0.03, -0.005, 0.0105}}, {0.36, {0.016, -0.005, 0.0105}}}};
  hook.hook = {0, 0.03, 0};
  setup.cauteries = {hook};
  add_golden(runs, "a bed that is peeled and burnt", setup, frames, frame, in_the_end([](auto& world) {
               const AttachmentFigures of = attachment_figures(world).at(0);
               CHECK(of.strands > 0);
               CHECK(of.torn.count > 0);
               CHECK(of.cut.count > 0);
             }));
}

// A duct that is blown up, clipped and cut.
void add_clips(std::vector<GoldenRun>& runs) {
  Setup setup;
  append_body(box_mesh({0.024, 0.004, 0.004}, 12, 2, 2), "duct", setup.mesh);
  setup.materials = {{.lambda = 2e4, .mu = 1e4, .density = 1000}};
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  setup.damping = 40;
  CarrierSetup carrier{0, Carries::blood, {}};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) {
      setup.prescribed.push_back({v});
      carrier.fed.push_back(v);
    }
  setup.carriers = {carrier};
  for (const TetFace& face : outer_faces(setup.mesh)) setup.pressures.push_back({face.tet, face.face, -300});
  const double half = std::sqrt(0.5);
  const auto clip_at = [&](double time, double x) {
    return PathPoint{time, {x, 0.002, 0.002}, {0, 0, half, half}};
  };
  setup.clip_appliers = {{"clip",
                          {.length = 0.0063, .opening = 0.006, .gap = 0.0026},
                          {clip_at(0.06, 0.007), clip_at(0.12, 0.011)}}};
  setup.cauteries = {{"cautery", 0.0015, {{0.24, {0.016, -0.004, 0.002}}, {0.34, {0.016, 0.008, 0.002}}}}};
  const Index tets = setup.mesh.tet_count();
  add_golden(runs, "a duct under pressure that is clipped and cut", setup, frames, frame,
             in_the_end([=](auto& world) {
               CHECK(clip_figures(world).size() == 2);
               CHECK(world.elements().topology.alive_count() < tets);
             }));
}

}  // namespace

std::vector<GoldenRun> term_scenes() {
  std::vector<GoldenRun> runs;
  add_holds(runs);
  add_threads(runs);
  add_attachments(runs);
  add_clips(runs);
  return runs;
}

}  // namespace lobe::test
