#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "lobe/sim/rebuild.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Those around a vertex that the first of them reaches by faces that contain it.
std::size_t reached_around(const Topology& topology, Index v) {
  std::set<Index> reached{topology.around(v)[0]};
  std::vector<Index> front(reached.begin(), reached.end());
  while (!front.empty()) {
    const Index t = front.back();
    front.pop_back();
    for (int face = 0; face < 4; ++face) {
      const Index other = topology.neighbour(t, face);
      if (other >= 0 && topology.tets()(face, t) != v && reached.insert(other).second) front.push_back(other);
    }
  }
  return reached.size();
}

// Every boundary edge belongs to an even number of boundary faces, each vertex of it to one fan of
// tetrahedra.
void check_topology(const Topology& topology) {
  std::map<std::pair<Index, Index>, int> edges;
  for (Index code : topology.boundary_faces()) {
    REQUIRE(topology.alive(code / 4));
    const Eigen::Vector3i f = topology.face(code);
    for (int i = 0; i < 3; ++i) edges[std::minmax(f[i], f[(i + 1) % 3])]++;
  }
  for (const auto& [edge, count] : edges) CHECK(count % 2 == 0);
  Index corners = 0;
  for (Index v = 0; v < topology.vertex_count(); ++v) {
    if (topology.around(v).empty()) continue;
    corners += Index(topology.around(v).size());
    CHECK(reached_around(topology, v) == topology.around(v).size());
  }
  CHECK(corners == 4 * topology.alive_count());
}

template <class Real>
void remove_everything(Setup setup, double tolerance, int batch) {
  const Index tets = setup.mesh.tet_count();
  setup.gravity = {0, 0, -9.81};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  World<Real> world(setup);
  State<Real> state = world.state();
  state.u = random_displacement<Real>(setup.mesh.vertex_count(), 1e-3);
  state.v = random_displacement<Real>(setup.mesh.vertex_count(), 1e-2);
  world.set_state(state);
  std::vector<Index> order(tets);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(11));
  Index removed = 0;
  for (Index i = 0; i < tets; i += batch) {
    const std::vector<Index> now(order.begin() + i, order.begin() + std::min(tets, i + batch));
    removed += world.remove_tets(now);
    CHECK(compare_with_rebuilt(world).largest() <= tolerance);
    check_topology(world.elements().topology);
  }
  CHECK(removed == tets);
  CHECK(world.elements().topology.alive_count() == 0);
  CHECK(world.elements().topology.boundary_faces().empty());
  CHECK(world.forces().norm() == 0);
  CHECK(*std::max_element(world.body().inertia.mass().begin(), world.body().inertia.mass().end()) == 0);
  const Report report = world.advance(0.1);
  CHECK(report.ok);
}

using PieceSets = std::set<std::set<Index>>;

// The pieces that were part of a larger one before.
PieceSets parts_of(const std::vector<std::vector<Index>>& before,
                   const std::vector<std::vector<Index>>& after) {
  std::map<Index, int> piece_of, count;
  for (std::size_t p = 0; p < before.size(); ++p)
    for (Index t : before[p]) piece_of[t] = int(p);
  for (const auto& piece : after) ++count[piece_of.at(piece[0])];
  PieceSets parts;
  for (const auto& piece : after)
    if (count[piece_of.at(piece[0])] > 1) parts.emplace(piece.begin(), piece.end());
  return parts;
}

// The rules for loose pieces and for those that will turn, as they read, over all pieces after every cut.
class LooseByTheRule {
 public:
  explicit LooseByTheRule(World<double>& world) : body_of_(world.elements().region_of.size(), -1) {
    judge(world);
  }

  // Tetrahedra of pieces that have come loose since.
  const std::set<Index>& judge(World<double>& world) {
    const auto pieces = world.elements().topology.pieces();
    std::map<int, std::size_t> largest;
    for (const auto& piece : pieces)
      largest[body_of_[piece[0]]] = std::max(largest[body_of_[piece[0]]], piece.size());
    for (const auto& piece : pieces) {
      const int body = body_of_[piece[0]];
      const bool held = std::any_of(piece.begin(), piece.end(), [&](Index t) {
        const Eigen::Vector4i corners = world.elements().topology.corners(t);
        return std::any_of(corners.begin(), corners.end(), [&](Index v) { return world.held().holds(v); });
      });
      const bool stays = body < 0 || held || (!was_held_[body] && piece.size() == largest[body]);
      if (!stays) loose_.insert(piece.begin(), piece.end());
      if (held && !is_fixed(world, piece)) turning_.insert(piece.begin(), piece.end());
      for (Index t : piece) body_of_[t] = int(was_held_.size());
      was_held_.push_back(stays && (body < 0 ? held : was_held_[body]));
    }
    return loose_;
  }
  // Tetrahedra of pieces that have hung by one vertex, or by several in a line.
  const std::set<Index>& turning() const { return turning_; }

 private:
  static bool is_fixed(const World<double>& world, const std::vector<Index>& piece) {
    std::set<Index> held;
    for (Index t : piece)
      for (Index v : world.elements().topology.corners(t))
        if (world.held().holds(v)) held.insert(v);
    Mat3X<double> X(3, Index(held.size()));
    Index k = 0;
    for (Index v : held) X.col(k++) = world.elements().points.col(v);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(X.colwise() - X.rowwise().mean());
    return svd.singularValues().size() > 1 && svd.singularValues()[1] > 1e-6 * svd.singularValues()[0];
  }

  std::vector<int> body_of_;
  std::vector<bool> was_held_;
  std::set<Index> loose_, turning_;
};

}  // namespace

TEST_CASE(
    "what comes loose is found from the cut as by the rule over all pieces, and nothing turns but what may") {
  const TetMesh mesh = irregular_box(4);
  for (bool held : {true, false})
    for (std::size_t batch : {1, 9}) {
      Setup setup = setup_of(mesh, RegionModel::tensor_mass);
      if (held)
        for (Index v = 0; v < mesh.vertex_count(); v += 25) setup.prescribed.push_back({v, Vec3d::Zero()});
      World<double> world(setup);
      LooseByTheRule rule(world);
      std::vector<Index> order(std::size_t(mesh.tet_count()));
      std::iota(order.begin(), order.end(), 0);
      std::shuffle(order.begin(), order.end(), std::mt19937(3));
      std::size_t loose_count = 0, turned_count = 0;
      for (std::size_t i = 0; i < order.size(); i += batch) {
        world.remove_tets({order.begin() + long(i), order.begin() + long(std::min(order.size(), i + batch))});
        const std::set<Index>& loose = rule.judge(world);
        loose_count = loose.size();
        for (Index t = 0; t < mesh.tet_count(); ++t)
          if (world.elements().topology.alive(t)) {
            const bool is_nonlinear = world.elements().region_of[t] == RegionModel::nonlinear;
            if (loose.count(t) > 0) CHECK(is_nonlinear);
            if (is_nonlinear && loose.count(t) == 0) {
              CHECK(rule.turning().count(t) > 0);
              ++turned_count;
            }
          }
      }
      CHECK(loose_count > 0);
      CHECK((turned_count > 0) == held);
    }
}

TEST_CASE("an edit says what comes apart: pieces that were one, all of them but one") {
  const TetMesh mesh = irregular_box(4);
  for (std::size_t batch : {1, 7, 40}) {
    Topology topology(mesh);
    std::vector<Index> order(std::size_t(mesh.tet_count()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    int apart = 0, together = 0;
    for (std::size_t i = 0; i < order.size(); i += batch) {
      const auto before = topology.pieces();
      const MeshEdit edit = topology.remove(std::span(order).subspan(i, std::min(batch, order.size() - i)));
      const auto after = topology.pieces();
      PieceSets found;
      for (const std::vector<Index>& piece : edit.cut_off) found.emplace(piece.begin(), piece.end());
      CHECK(found.size() == edit.cut_off.size());
      if (!found.empty()) {
        std::set<Index> rest;
        topology.visit_piece(edit.next_to_removed[0], [&](Index t) { return !rest.insert(t).second; });
        CHECK(found.insert(rest).second);
      }
      CHECK(found == parts_of(before, after));
      ++(found.empty() ? together : apart);
    }
    CHECK(apart > 0);
    CHECK(together > 0);
  }
}

TEST_CASE("a body that loses the last vertex that held it falls, though it stays in one piece") {
  const TetMesh mesh = box_mesh({0.02, 0.01, 0.01}, 4, 2, 2);
  Setup setup = setup_of(mesh, RegionModel::tensor_mass);
  setup.prescribed.push_back({0, Vec3d::Zero()});
  World<double> world(setup);
  const auto around = world.elements().topology.around(0);
  world.remove_tets(std::vector<Index>(around.begin(), around.end()));
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (world.elements().topology.alive(t)) CHECK(world.elements().region_of[t] == RegionModel::nonlinear);
}

TEST_CASE("dead loads follow a cut: what is left of them acts") {
  Setup setup = setup_of(box_mesh({0.02, 0.01, 0.01}, 4, 2, 2));
  const Topology topology(setup.mesh);
  for (Index code : topology.boundary_faces()) setup.face_loads.push_back({code / 4, code % 4, {0, 0, 100}});
  for (Index v = 0; v < setup.mesh.vertex_count(); v += 2) setup.vertex_loads.push_back({v, {1, 0, 0}});
  setup.prescribed.push_back({0, Vec3d::Zero()});
  World<double> world(setup);
  for (Index t = 1; t < setup.mesh.tet_count(); t += 3) {
    world.remove_tets({t});
    CHECK(compare_with_rebuilt(world).largest() <= 1e-12);
  }
}

TEST_CASE("cut = rebuilt, tetrahedron by tetrahedron in random order down to nothing") {
  remove_everything<double>(hybrid_setup(irregular_box(2)), 1e-12, 1);
}

TEST_CASE("cut = rebuilt with nodal pressure") {
  remove_everything<double>(averaged(hybrid_setup(irregular_box(2))), 1e-12, 1);
  remove_everything<double>(averaged(hybrid_setup(irregular_box(4))), 1e-12, 23);
  remove_everything<float>(averaged(hybrid_setup(irregular_box(4))), 3e-6, 23);
}

TEST_CASE("cut = rebuilt in batches, in double and single precision, pieces falling, vanishing and staying") {
  for (LoosePieces pieces : {LoosePieces::fall, LoosePieces::vanish, LoosePieces::stay}) {
    Setup setup = hybrid_setup(irregular_box(4));
    setup.loose_pieces = pieces;
    remove_everything<double>(setup, 1e-12, 23);
    remove_everything<float>(setup, 3e-6, 23);
  }
}

TEST_CASE("a cut at rest leaves zero force") {
  const TetMesh mesh = irregular_box(3);
  World<double> world(hybrid_setup(mesh));
  std::vector<Index> some;
  for (Index t = 0; t < mesh.tet_count(); t += 5) some.push_back(t);
  world.remove_tets(some);
  CHECK(world.forces().norm() == 0);
  CHECK(world.remove_tets(some) == 0);
}

TEST_CASE("tetrahedra that would hang by an edge or a vertex alone come apart") {
  // A fan around the edge 0-1, then one more that shares only vertex 0 with the first.
  TetMesh mesh;
  mesh.points.resize(3, 7);
  mesh.points << 0, 0, 1, 0.5, -0.5, -1, -1, 0, 0, 0, 1, 1, 0, -0.5, 0, 1, 0, 0, 0, 0, -1;
  mesh.tets.resize(4, 4);
  mesh.tets << 0, 0, 0, 0, 1, 1, 1, 4, 2, 3, 4, 5, 3, 4, 5, 6;
  for (Index t = 0; t < 4; ++t)
    if (signed_volume(tet_points(mesh, t)) < 0) std::swap(mesh.tets(2, t), mesh.tets(3, t));
  mesh.labels.assign(4, 0);
  Topology edge(mesh);
  const MeshEdit by_edge = edge.remove(std::vector<Index>{1});  // 0 and 2 share the edge 0-1 only
  REQUIRE(by_edge.splits.size() == 2);
  CHECK(by_edge.splits[0].vertex == 0);
  CHECK(by_edge.splits[1].vertex == 1);
  CHECK(edge.vertex_count() == 9);
  CHECK(edge.pieces().size() == 2);
  Topology vertex(mesh);
  const MeshEdit by_vertex = vertex.remove(std::vector<Index>{1, 2});  // 0 and 3 share vertex 0 only
  REQUIRE(by_vertex.splits.size() == 1);
  CHECK(by_vertex.splits[0].vertex == 0);
  CHECK(by_vertex.splits[0].copy == 7);
  CHECK(vertex.pieces().size() == 2);
}

TEST_CASE("pieces that nothing holds fall, vanish or stay as asked") {
  const TetMesh mesh = box_mesh({0.04, 0.01, 0.01}, 8, 2, 2);
  std::vector<Index> middle;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (std::abs(barycentre(mesh, t).x() - 0.02) < 0.004) middle.push_back(t);
  const Index tip = mesh.vertex_count() - 1;
  for (LoosePieces pieces : {LoosePieces::fall, LoosePieces::vanish, LoosePieces::stay}) {
    Setup setup = setup_of(mesh, RegionModel::tensor_mass);
    setup.loose_pieces = pieces;
    setup.gravity = {0, 0, -9.81};
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
    World<double> world(setup);
    const Index removed = world.remove_tets(middle);
    const Index left = world.elements().topology.alive_count();
    CHECK(left == mesh.tet_count() - removed);
    for (int i = 0; i < 10; ++i) REQUIRE(world.advance(0.01).ok);
    const double fall = world.state().u(2, tip);
    if (pieces == LoosePieces::fall) CHECK(fall == near(-0.5 * 9.81 * 0.01, 1e-11));
    if (pieces == LoosePieces::vanish) CHECK(removed > Index(middle.size()));
    if (pieces == LoosePieces::stay) CHECK(fall == 0);
  }
}

TEST_CASE("cautery removes what the sphere touches along its path, in the deformed body") {
  const TetMesh mesh = box_mesh({0.04, 0.04, 0.04}, 8, 8, 8);
  const Topology topology(mesh);
  const Mat3X<double> moved = Vec3d(1, 0, 0).replicate(1, mesh.vertex_count());
  const Sweep sweep{{0.02, -0.1, 0.02}, {0.02, 0.1, 0.02}, 0.004};
  const std::vector<Index> touched = touched_tets(topology, mesh.points, sweep);
  CHECK(!touched.empty());
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    // Distance of the barycentre to the axis of the sweep: surely in within the radius, surely out beyond a
    // cell.
    const Vec3d b = barycentre(mesh, t);
    const double r = std::hypot(b.x() - 0.02, b.z() - 0.02);
    const bool in = std::binary_search(touched.begin(), touched.end(), t);
    if (r < 0.0039) CHECK(in);
    if (r > 0.004 + 0.005 * std::sqrt(3.0)) CHECK(!in);
  }
  CHECK(touched_tets(topology, mesh.points + moved, sweep).empty());
}

TEST_CASE("a hook burns along its wire, as far as spheres that are a radius apart reach, and as it turns") {
  constexpr double radius = 0.001;
  const Vec3d tip(0.01, 0.02, 0.03), wire(0.008, 0, 0);
  const auto tiny_at = [](const Vec3d& centre) {
    Mat34<double> x = centre.replicate(1, 4);
    for (int i = 0; i < 3; ++i) x(i, i) += 1e-7;
    return x;
  };
  const SweptVolume rests = swept_volume({tip, tip, radius}, wire, wire);
  for (const double along : {0.0, 0.0003, 0.0035, 0.0045, 0.008}) {
    CAPTURE(along);
    const Vec3d on = tip + Vec3d(along, 0, 0), aside = Vec3d(0, 0.6, 0.8) * radius;
    CHECK(rests.meets(tiny_at(on + 0.86 * aside)));  // √3/2 between two spheres
    CHECK(!rests.meets(tiny_at(on + 1.01 * aside)));
    CHECK(rests.crosses(on + 0.86 * aside, on + 3 * aside));
    CHECK(!rests.crosses(on + 1.01 * aside, on + 3 * aside));
    CHECK(rests.box.contains(on + aside));
  }
  CHECK(!rests.meets(tiny_at(tip - Vec3d(1.01 * radius, 0, 0))));
  CHECK(!rests.meets(tiny_at(tip + wire + Vec3d(1.01 * radius, 0, 0))));
  // While the wire turns from x to y its end goes along the chord.
  const SweptVolume turns = swept_volume({tip, tip, radius}, wire, {0, 0.008, 0});
  CHECK(turns.meets(tiny_at(tip + Vec3d(0.004, 0.004, 0))));
  CHECK(!turns.meets(tiny_at(tip + Vec3d(0.0055, 0.0055, 0))));
  CHECK(turns.meets(tiny_at(tip + Vec3d(0, 0.008, 0))));
}
