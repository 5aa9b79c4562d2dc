#include "lobe/setup/check_setup.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "lobe/error.h"
#include "lobe/fem/law_fault.h"
#include "lobe/fem/transverse_isotropy.h"
#include "lobe/setup/exclusions.h"

namespace lobe {
namespace {

class Checker {
 public:
  explicit Checker(const Setup& setup) : setup_(setup) {}

  void expect(bool holds, const std::string& message) {
    if (!holds) faults_.push_back({"setup", message});
  }

  bool is_vertex(Index v) const { return v >= 0 && v < setup_.mesh.vertex_count(); }

  void check_mesh();
  void check_materials();
  void check_fibres();
  void check_boundary();
  void check_tools();
  void check_carriers();
  void check_exclusions(Options used);

  void finish() {
    if (!faults_.empty()) throw InputError(std::move(faults_));
  }

 private:
  const Setup& setup_;
  std::vector<Fault> faults_;
};

void Checker::check_mesh() {
  const TetMesh& mesh = setup_.mesh;
  const auto tets = std::size_t(mesh.tet_count());
  expect(tets > 0, "the mesh has no tetrahedron");
  expect(setup_.material_of.size() == tets && setup_.region_of.size() == tets && mesh.labels.size() == tets,
         "materials, regions and labels must have one entry per tetrahedron");
  expect(mesh.bodies.of.size() == (mesh.bodies.any() ? tets : 0) &&
             std::all_of(mesh.bodies.of.begin(), mesh.bodies.of.end(),
                         [&](std::uint8_t body) { return body < mesh.bodies.names.size(); }),
         "bodies must have one entry per tetrahedron, the place of a name, or none without names");
  expect(setup_.shares.empty() || setup_.shares.size() == tets,
         "shares of volume must have one entry per tetrahedron, or none at all");
  expect(std::all_of(setup_.shares.begin(), setup_.shares.end(), [](double x) { return x > 0 && x <= 1; }),
         "a share of volume must be above 0 and at most 1");
  expect(mesh.points.allFinite(), "a vertex position is not finite");
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const auto v = mesh.tets.col(t);
    const bool in_range = is_vertex(v[0]) && is_vertex(v[1]) && is_vertex(v[2]) && is_vertex(v[3]);
    if (in_range && signed_volume(tet_points(mesh, t)) > 0) continue;
    expect(false, "tetrahedron " + std::to_string(t) +
                      (in_range ? " is flat or inverted" : " names no vertex of the mesh") +
                      ": call prepare() on the mesh");
    break;
  }
}

void Checker::check_materials() {
  for (const Elastic& e : setup_.materials) {
    expect(std::isfinite(e.lambda) && std::isfinite(e.mu) && std::isfinite(e.density) && e.mu > 0 &&
               (e.fibre.any() || 3 * e.lambda + 2 * e.mu > 0) && e.density > 0,
           "a material needs finite mu > 0, 3 lambda + 2 mu > 0 and density > 0");
    expect(e.nodal_pressure >= 0 && e.nodal_pressure <= 1, "nodal_pressure must be in [0, 1]");
    expect(law_fault(e).empty(), law_fault(e));
    const std::string fault = viscosity_fault(e);
    expect(fault.empty(), fault);
    expect(e.nodal_pressure == 0 || e.lambda >= 0, "nodal_pressure needs lambda of at least 0: set it to 0");
  }
  expect(std::all_of(setup_.material_of.begin(), setup_.material_of.end(),
                     [&](std::uint16_t m) { return m < setup_.materials.size(); }),
         "a material number is out of range");
  const auto not_negative = [](double x) { return std::isfinite(x) && x >= 0; };
  expect(not_negative(setup_.volume_penalty), "volume_penalty must be finite and not negative");
  expect(setup_.guard_below >= 0 && setup_.guard_below < 1, "guard_below must be in [0, 1)");
  expect(not_negative(setup_.damping), "damping must be finite and not negative");
  expect(not_negative(setup_.ramp) && not_negative(setup_.load_ramp),
         "ramps must be finite and not negative");
  expect(not_negative(setup_.implicit_step), "implicit_step must be finite and not negative");
  expect(setup_.spectral_radius >= 0 && setup_.spectral_radius <= 1, "spectral_radius must be in [0, 1]");
  expect(setup_.safety > 0 && setup_.safety <= 2, "safety must be in (0, 2]");
  expect(setup_.selective_mass >= 1 && setup_.selective_mass <= highest_mass_degree,
         "selective_mass must be in [1, 16]");
  expect(setup_.cut_step >= 0 && setup_.cut_step <= 1, "cut_step must be in [0, 1]");
  expect(not_negative(setup_.cut_frequency), "cut_frequency must be finite and not negative");
  for (const Elastic& e : setup_.materials)
    expect(not_negative(e.fracture_energy), "fracture_energy must be finite and not negative");
  expect(not_negative(setup_.lattice_cell), "lattice_cell must be finite and not negative");
  expect(not_negative(setup_.sleep), "sleep must be finite and not negative");
  expect(setup_.gravity.allFinite(), "gravity is not finite");
}

void Checker::check_fibres() {
  for (const Elastic& e : setup_.materials) {
    if (!e.fibre.any()) continue;
    expect(is_positive_definite(e),
           "a material with fibres is not positive definite (transverse_isotropy.h)");
  }
  const Mat3X<double>& fibres = setup_.mesh.fibres;
  const std::size_t count = setup_.material_of.size();
  expect(fibres.cols() == 0 || std::size_t(fibres.cols()) == count,
         "fibres must have one column per tetrahedron, or none");
  for (std::size_t t = 0; t < count && setup_.material_of[t] < setup_.materials.size(); ++t) {
    const Elastic& elastic = setup_.materials[setup_.material_of[t]];
    if (!elastic.has_direction()) continue;
    const bool is_there = t < std::size_t(fibres.cols());
    if (is_there && std::abs(fibres.col(Eigen::Index(t)).norm() - 1) < 1e-6) {
      if (spans_plane(elastic, fibres.col(Eigen::Index(t)))) continue;
      return expect(false, "tetrahedron " + std::to_string(t) +
                               " has its direction along fibre_plane, which is to be another vector of the "
                               "plane of both families");
    }
    return expect(false, "tetrahedron " + std::to_string(t) +
                             " is of a material with fibres, but its direction is " +
                             (is_there ? "no unit vector" : "missing: set mesh.fibres"));
  }
}

void Checker::check_boundary() {
  const auto all = [](const auto& list, auto&& holds) {
    return std::all_of(list.begin(), list.end(), holds);
  };
  expect(all(setup_.prescribed,
             [&](const PrescribedVertex& p) {
               return is_vertex(p.vertex) && p.displacement.allFinite() &&
                      (p.axes[0] || p.axes[1] || p.axes[2]);
             }),
         "a prescribed vertex is out of range, its displacement not finite, or none of its components "
         "prescribed");
  expect(all(setup_.partly_held,
             [&](const PartlyHeldVertex& p) {
               return is_vertex(p.vertex) && p.share > 0 && p.share < 1 && p.displacement.allFinite() &&
                      p.axes != Axes{};
             }),
         "a partly held vertex is out of range, its share not between 0 and 1, its displacement not finite, "
         "or none of its components drawn");
  expect(all(setup_.vertex_loads,
             [&](const VertexLoad& l) { return is_vertex(l.vertex) && l.force.allFinite(); }),
         "a loaded vertex is out of range, or its force not finite");
  expect(all(setup_.face_loads,
             [&](const FaceLoad& l) {
               return is_tet(l.tet, setup_) && l.face >= 0 && l.face < 4 && l.traction.allFinite();
             }),
         "a loaded face is out of range, or its traction not finite");
  expect(all(setup_.pressures,
             [&](const FacePressure& p) {
               return is_tet(p.tet, setup_) && p.face >= 0 && p.face < 4 && std::isfinite(p.pressure);
             }),
         "a face under pressure is out of range, or its pressure not finite");
  expect(all(setup_.pressures,
             [&](const FacePressure& p) { return !is_tet(p.tet, setup_) || can_be_pulled(p.tet, setup_); }),
         "a face under pressure is in a precomputed region, which bears no load that turns with it");
}

void Checker::check_tools() {
  const Expect told = [this](bool is_met, const std::string& fault) { expect(is_met, fault); };
  for_each_tool(static_cast<const ToolSetups&>(setup_), [&](const auto& tool) { tool.check(told); });
  setup_.contact.check(told);
  for_each_kind(static_cast<const ForceSetups&>(setup_),
                [&]<class Item>(const std::vector<Item>& all) { Item::check_all(all, setup_, told); });
}

void Checker::check_carriers() {
  std::set<int> bodies;
  for (const CarrierSetup& carrier : setup_.carriers) {
    const bool is_body = carrier.body >= 0 && std::size_t(carrier.body) < setup_.mesh.bodies.names.size();
    expect(is_body, "there is no body " + std::to_string(carrier.body) + " that could carry something");
    expect(bodies.insert(carrier.body).second,
           "body " + std::to_string(carrier.body) + " carries something twice");
    expect(!carrier.fed.empty() &&
               std::all_of(carrier.fed.begin(), carrier.fed.end(), [&](Index v) { return is_vertex(v); }),
           "a body that carries something needs vertices of the mesh at which it comes in");
  }
}

void Checker::check_exclusions(Options used) {
  const auto here = [](Option) { return std::vector<std::string>{"setup"}; };
  const auto add = [&](std::vector<Fault> faults) {
    std::move(faults.begin(), faults.end(), std::back_inserter(faults_));
  };
  add(find_exclusions(used | options_of(setup_), here));
  for (const Elastic& e : setup_.materials) add(find_material_exclusions(e.law, e.fibre.any(), "setup"));
}

}  // namespace

void check_setup(const Setup& setup, const Options& wanted) {
  Checker checker(setup);
  checker.check_mesh();
  checker.check_materials();
  checker.check_fibres();
  checker.check_boundary();
  checker.check_tools();
  checker.check_carriers();
  checker.check_exclusions(wanted);
  checker.finish();
}

}  // namespace lobe
