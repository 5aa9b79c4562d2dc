// Regions of materials with a Prony series: every law, both elements and both precisions against the formulas
// of one element, and closed forms of a vibration.
#include "lobe/region/viscosity.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "fibre_support.h"
#include "lobe/fem/svk.h"
#include "lobe/region/corotational.h"
#include "lobe/region/nonlinear.h"
#include "lobe/sort_unique.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

RegionEdit all_of(const Setup& setup) {
  RegionEdit edit;
  edit.entered.resize(std::size_t(setup.mesh.tet_count()));
  std::iota(edit.entered.begin(), edit.entered.end(), 0);
  edit.vertices.resize(std::size_t(setup.mesh.vertex_count()));
  std::iota(edit.vertices.begin(), edit.vertices.end(), 0);
  return edit;
}

// A region in which steps are taken by hand.
template <class Region, class Real>
class SteppedRegion {
 public:
  explicit SteppedRegion(const Setup& setup, InstructionSet set = chosen_instruction_set())
      : elements_(setup), region_(set) {
    region_.follow(elements_, all_of(setup));
    relax(Mat3X<Real>::Zero(3, setup.mesh.vertex_count()));
  }
  void relax(const Mat3X<Real>& u) {
    region_.visit_viscous([&](auto& patches) { patches.relax(elements_, u, true); });
  }
  void set_step(const ViscousStep& step) {
    region_.visit_viscous([&](auto& patches) { patches.viscosity().set_step(step); });
  }
  Mat3X<Real> forces(const Mat3X<Real>& u, const ViscousStep& step) {
    set_step(step);
    Mat3X<Real> f = Mat3X<Real>::Zero(3, u.cols());
    Parallel one_thread;
    region_.add_forces(u, f, one_thread);
    return f;
  }
  double energy(const Mat3X<Real>& u) {
    set_step({});
    return region_.energy(u);
  }
  DiagonalStiffness stiffness(const Mat3X<Real>& u) {
    DiagonalStiffness K = DiagonalStiffness::Zero(6, u.cols());
    Parallel one_thread;
    region_.add_diagonal_stiffness(u, K, one_thread);
    return K;
  }
  const Elements& elements() const { return elements_; }

 private:
  Elements elements_;
  Region region_;
};

// The forces of branches alone, tetrahedron by tetrahedron or domain by domain, by fem/prony.h.
class ReferenceBranches {
 public:
  explicit ReferenceBranches(const Elements& elements) : elements_(elements), domains_(elements) {
    A_.resize(std::size_t(elements.topology.tet_count() + domains_.count()));
    for (auto& of_item : A_) of_item.fill(Mat3<double>::Zero());
  }
  Mat3X<double> forces(const Mat3X<double>& u, const ViscousStep& step) {
    Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
    for (Index t = 0; t < elements_.topology.tet_count(); ++t) {
      const Elastic& elastic = elements_.elastic_of(t);
      if (elastic.is_smoothed()) continue;
      const Shape s = elements_.shape_of(t);
      const Eigen::Vector4i corners = elements_.topology.corners(t);
      const Mat34<double> at_corners = u(Eigen::all, corners);
      const Mat3<double> P =
          stress(elastic, displacement_gradient<double>(at_corners, s.gradients.rightCols<3>()), A_[t], step);
      for (int c = 0; c < 4; ++c) f.col(corners[c]) -= s.volume * P * s.gradients.col(c);
    }
    for (Index d = 0; d < domains_.count(); ++d) {
      const SmoothedEdge& edge = domains_[d];
      if (!(edge.volume > 0)) continue;
      const Mat3<double> P = stress(elements_.materials[edge.material], displacement_gradient(edge, u),
                                    A_[std::size_t(elements_.topology.tet_count() + d)], step);
      const Mat3X<double> of_domain = vertex_forces(edge, P);
      for (std::size_t j = 0; j < edge.vertices.size(); ++j)
        f.col(edge.vertices[j]) += of_domain.col(Eigen::Index(j));
    }
    return f;
  }

 private:
  using Strains = std::array<Mat3<double>, most_prony_terms>;
  static Mat3<double> stress(const Elastic& elastic, const Mat3<double>& H, Strains& A,
                             const ViscousStep& step) {
    const Mat3<double> E = green_strain(H);
    Mat3<double> S = Mat3<double>::Zero();
    const auto series = elastic.prony_series();
    for (std::size_t i = 0; i < series.size(); ++i) {
      ViscousBranch<double> branch = viscous_branch(series, i, elastic.lambda, elastic.mu, 2 * step.before);
      S += viscous_stress(E, A[i], branch);
      branch.half = std::exp(-(step.before + step.after) / (2 * series[i].time));
      if (step.follows) A[i] = followed_strain(E, A[i], branch);
    }
    return S + H * S;
  }

  const Elements& elements_;
  SmoothedEdges domains_;
  std::vector<Strains> A_;
};

constexpr PronyTerm fast{0.3, 0, 0.01}, slow{0.2, 0, 0.5}, slowest{0.1, 0, 20};

// Layers of materials with one term of volume as well, none, two and three.
Setup viscous_layers(MaterialLaw law) {
  const TetMesh mesh = irregular_box(3);
  Setup setup = setup_of(mesh);
  setup.materials.assign(4, setup.materials[0]);
  setup.materials[0].viscosity = {PronyTerm{0.25, 0.4, 0.03}};
  setup.materials[2].viscosity = {fast, slow};
  setup.materials[3].viscosity = {fast, slow, slowest};
  for (Elastic& elastic : setup.materials) {
    elastic.law = law;
    if (law == MaterialLaw::yeoh) elastic.further = {2e3, 1e3};
    if (law == MaterialLaw::mooney_rivlin) elastic.further = {2e3, 0};
    if (law == MaterialLaw::holzapfel) elastic.further = {2e4, 3};
  }
  if (law == MaterialLaw::svk) setup.materials[2].fibre = {3e3, 8e3, 5e4};
  setup.mesh.fibres = random_displacement(mesh.tet_count(), 1).colwise().normalized();
  const double size = mesh.points.row(0).maxCoeff();
  for (Index t = 0; t < mesh.tet_count(); ++t)
    setup.material_of[t] = std::uint16_t(std::clamp(int(4 * barycentre(mesh, t).x() / size), 0, 3));
  setup.volume_penalty = 1e5;
  setup.guard_below = 0.5;
  return setup;
}

Setup elastic_of_same(Setup setup) {
  for (Elastic& elastic : setup.materials) elastic.viscosity = {};
  return setup;
}

constexpr ViscousStep steps[]{
    {0, 0.004, true}, {0.004, 0.01, true}, {0.01, 0, false}, {0.01, 0.02, true}, {0.02, 0, true}};

template <class Region>
void check_against_reference(const Setup& setup) {
  SteppedRegion<Region, double> viscous(setup), elastic(elastic_of_same(setup));
  ReferenceBranches branches(viscous.elements());
  unsigned seed = 1;
  for (const ViscousStep& step : steps) {
    const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 1e-3, seed++);
    const Mat3X<double> expected = elastic.forces(u, step) + branches.forces(u, step);
    CHECK((viscous.forces(u, step) - expected).norm() < 1e-11 * expected.norm());
  }
}

// A box that is sheared as one, u_x = e(t) y, and the shear stress that its forces at the top tell.
template <class Real>
class ShearedBox {
 public:
  ShearedBox(const std::array<PronyTerm, most_prony_terms>& series, ElementType element, RegionModel model)
      : setup_(make(series, element, model)), region_(setup_) {}
  double stress(double e, const ViscousStep& step) {
    const TetMesh& mesh = setup_.mesh;
    Mat3X<Real> u = Mat3X<Real>::Zero(3, mesh.vertex_count());
    for (Index v = 0; v < mesh.vertex_count(); ++v) u(0, v) = static_cast<Real>(e * mesh.points(1, v));
    const Mat3X<Real> f = region_.forces(u, step);
    double at_top = 0;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.points(1, v) > 0.0199) at_top -= double(f(0, v));
    return at_top / (0.02 * 0.02);
  }

 private:
  static Setup make(const std::array<PronyTerm, most_prony_terms>& series, ElementType element,
                    RegionModel model) {
    Setup setup = setup_of(box_mesh(Vec3d::Constant(0.02), 2, 2, 2), model);
    setup.materials[0].viscosity = series;
    setup.materials[0].element = element;
    return setup;
  }
  Setup setup_;
  SteppedRegion<NonlinearRegion<Real>, Real> region_;
};

}  // namespace

TEST_CASE("forces are those of the law and of all branches, tetrahedron by tetrahedron, domain by domain") {
  for (int law = 0; law < law_count; ++law) {
    const Setup setup = viscous_layers(MaterialLaw(law));
    CAPTURE(law_rows[law].name);
    check_against_reference<NonlinearRegion<double>>(setup);
    check_against_reference<NonlinearRegion<double>>(smoothed(setup));
    Setup without_terms = setup;
    without_terms.volume_penalty = without_terms.guard_below = 0;
    check_against_reference<NonlinearRegion<double>>(without_terms);
    Setup pressed = setup;
    pressed.materials[0].viscosity[0].bulk = 0;
    check_against_reference<NonlinearRegion<double>>(averaged(pressed));
    check_against_reference<NonlinearRegion<double>>(averaged(smoothed(pressed)));
    if (has_families(MaterialLaw(law))) continue;
    pressed.mesh.fibres.resize(3, 0);  // no kernel may read them
    for (Elastic& elastic : pressed.materials) elastic.fibre = {};
    check_against_reference<NonlinearRegion<double>>(averaged(pressed));
    check_against_reference<NonlinearRegion<double>>(averaged(smoothed(pressed)));
  }
  Setup turning = viscous_layers(MaterialLaw::neo_hookean);
  std::fill(turning.region_of.begin(), turning.region_of.end(), RegionModel::corotational);
  check_against_reference<CorotationalRegion<double>>(turning);
  check_against_reference<CorotationalRegion<double>>(smoothed(turning));
}

TEST_CASE("single precision follows double, and every instruction set has the same bits") {
  for (const Setup& setup :
       {viscous_layers(MaterialLaw::svk), smoothed(viscous_layers(MaterialLaw::neo_hookean))}) {
    SteppedRegion<NonlinearRegion<double>, double> exact(setup);
    SteppedRegion<NonlinearRegion<float>, float> single(setup);
    std::vector<Mat3X<float>> found;
    unsigned seed = 1;
    for (const ViscousStep& step : steps) {
      const Mat3X<float> u = random_displacement<float>(setup.mesh.vertex_count(), 1e-3, seed++);
      found.push_back(single.forces(u, step));
      const Mat3X<double> f = exact.forces(u.cast<double>(), step);
      CHECK((found.back().cast<double>() - f).norm() < 1e-5 * f.norm());
    }
    for (InstructionSet set : available_instruction_sets()) {
      SteppedRegion<NonlinearRegion<float>, float> other(setup, set);
      for (unsigned i = 0; i < std::size(steps); ++i) {
        const Mat3X<float> u = random_displacement<float>(setup.mesh.vertex_count(), 1e-3, 1 + i);
        CHECK((other.forces(u, steps[i]).array() == found[i].array()).all());
      }
    }
  }
}

TEST_CASE("forces at once are minus the slope of the energy, and its curvature is the stiffness") {
  for (const bool is_smoothed : {false, true}) {
    Setup setup = viscous_layers(MaterialLaw::svk);
    setup.volume_penalty = setup.guard_below = 0;
    if (is_smoothed) setup = smoothed(setup);
    SteppedRegion<NonlinearRegion<double>, double> region(setup);
    const Index count = setup.mesh.vertex_count();
    region.forces(random_displacement(count, 1e-3, 1), steps[0]);
    region.forces(random_displacement(count, 1e-3, 2), steps[1]);
    Mat3X<double> u = random_displacement(count, 1e-3, 3);
    const Mat3X<double> f = region.forces(u, {});
    const DiagonalStiffness K = region.stiffness(u);
    constexpr double h = 1e-7;  // [m]
    constexpr int row_of[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (Index v = 0; v < count; v += 5)
      for (int d = 0; d < 3; ++d) {
        const double at = u(d, v);
        u(d, v) = at + h;
        const double above = region.energy(u);
        const Vec3d f_above = region.forces(u, {}).col(v);
        u(d, v) = at - h;
        const double below = region.energy(u);
        const Vec3d slope = (f_above - Vec3d(region.forces(u, {}).col(v))) / (2 * h);
        u(d, v) = at;
        CHECK(f(d, v) == near(-(above - below) / (2 * h), 1e-5, f.norm()));
        for (int i = 0; i < 3; ++i) CHECK(K(row_of[i][d], v) == near(-slope[i], 1e-6, K.col(v).norm()));
      }
  }
}

TEST_CASE("a sudden shear of a region relaxes by the series") {
  const std::array<PronyTerm, most_prony_terms> series{fast, slow, slowest};
  const ViscousModulus modulus{seed_material.mu, series};
  for (const ElementType element : {ElementType::tetrahedron, ElementType::edge_smoothed})
    for (const double h : {1e-3, 0.1, 5.0}) {
      ShearedBox<double> box(series, element, RegionModel::nonlinear);
      const double e = 1e-4;
      for (int n = 0; n < 30; ++n) {
        const double half = n == 0 ? 0 : h / 2, since = n * h - half;  // it was sheared
        CAPTURE(since);
        CHECK(box.stress(e, {half, half, n > 0}) == near(e * modulus.relaxed(since), 1e-6));
      }
    }
}

TEST_CASE_TEMPLATE("storage and loss of a region's forces are those of the series over four decades", Real,
                   float, double) {
  const std::array<PronyTerm, most_prony_terms> series{fast, slow, {}};
  const ViscousModulus modulus{seed_material.mu, std::span(series).first(2)};
  const double e = std::is_same_v<Real, float> ? 0.01 : 1e-4;
  const double tolerance = std::is_same_v<Real, float> ? 2e-3 : 1e-3;
  for (const double omega : {0.2, 2.0, 20.0, 200.0, 2000.0}) {
    CAPTURE(omega);
    const double period = 2 * std::numbers::pi / omega;
    const int steps_per_period = std::max(200, int(period / fast.time));
    const double h = period / steps_per_period;
    const int settled = (int(std::min(6 * slow.time / period, 20.0)) + 1) * steps_per_period;
    ShearedBox<Real> box(series, ElementType::tetrahedron, RegionModel::nonlinear);
    double in_phase = 0, behind = 0, lost = 0;
    for (int n = 0; n < settled + steps_per_period; ++n) {
      const double phase = omega * n * h;
      const double stress = box.stress(e * std::sin(phase), {h / 2, h / 2, true});
      if (n < settled) continue;
      in_phase += 2 * stress * std::sin(phase) / (e * steps_per_period);
      behind += 2 * stress * std::cos(phase) / (e * steps_per_period);
      lost += stress * e * omega * std::cos(phase) * h;  // [J/m³]
    }
    const double whole = modulus.relaxed(0);
    CHECK(in_phase == near(modulus.storage(omega), tolerance, whole));
    CHECK(behind == near(modulus.loss(omega), tolerance, whole));
    CHECK(lost == near(std::numbers::pi * modulus.loss(omega) * e * e, tolerance, 3 * whole * e * e));
  }
}

TEST_CASE("a body that turns far meets no viscosity") {
  for (const ElementType element : {ElementType::tetrahedron, ElementType::edge_smoothed}) {
    Setup setup = setup_of(irregular_box(2));
    setup.materials[0].viscosity = {fast, slow, slowest};
    setup.materials[0].element = element;
    SteppedRegion<NonlinearRegion<double>, double> region(setup);
    for (int n = 1; n < 30; ++n) {
      const Mat3<double> R = Eigen::AngleAxisd(0.3 * n, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
      const Mat3X<double> u = affine_displacement(setup.mesh.points, R);
      CHECK(region.forces(u, {0.005, 0.005, true}).norm() < 1e-11 * seed_material.mu * 1e-4);
    }
  }
}

TEST_CASE("what is put to rest in its strain has the slow forces, and keeps them") {
  for (const Setup& setup : {viscous_layers(MaterialLaw::svk), smoothed(viscous_layers(MaterialLaw::svk))}) {
    SteppedRegion<NonlinearRegion<double>, double> viscous(setup), elastic(elastic_of_same(setup));
    const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 1e-3);
    const Mat3X<double> expected = elastic.forces(u, {});
    CHECK((viscous.forces(u, {}) - expected).norm() > 0.1 * expected.norm());
    viscous.relax(u);
    for (int n = 0; n < 3; ++n)
      CHECK((viscous.forces(u, {0.01, 0.01, true}) - expected).norm() < 1e-11 * expected.norm());
  }
}

// Kernels go on with these lanes: what was left in them would fall to the smallest numbers, which are slow.
TEST_CASE("a lane that a tetrahedron or a domain has left has no strain of dashpots") {
  Setup setup = setup_of(irregular_box(3));
  setup.materials[0].viscosity = {fast, slow};
  for (const Setup& each : {setup, smoothed(setup)}) {
    Elements elements(each);
    NonlinearRegion<float> region;
    region.follow(elements, all_of(each));
    const auto u = random_displacement<float>(each.mesh.vertex_count(), 1e-3);
    region.visit_viscous([&](auto& patches) { patches.relax(elements, u, true); });
    const MeshEdit cut = elements.topology.remove(std::vector<Index>{0, 1, 2, 50, 51});
    elements.follow(cut);
    RegionEdit edit;
    for (const VertexSplit& split : cut.splits)
      edit.entered.insert(edit.entered.end(), split.tets.begin(), split.tets.end());
    sort_unique(edit.entered);
    edit.left = cut.removed;
    edit.left.insert(edit.left.end(), edit.entered.begin(), edit.entered.end());
    region.follow(elements, edit);
    Index lanes = 0;
    region.visit_viscous([&](auto& patches) {
      const Viscosity<float>& viscosity = patches.viscosity();
      patches.visit_patches([&](const auto& layout, const auto&) {
        for (Index p = 0; p < layout.patch_count(); ++p)
          for (Index i = layout.patch(p).items; viscosity.has(p) && i % viscosity.width != 0; ++i, ++lanes)
            CHECK(viscosity.strains(p, i) == Viscosity<float>::Strains{});
      });
    });
    CHECK(lanes > 0);
  }
}
