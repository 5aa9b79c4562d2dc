// A scene as plain structs: what the JSON of docs/scene.md says, in SI units, defaults included.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lobe/fem/transverse_isotropy.h"
#include "lobe/scene/scene_forces.h"
#include "lobe/setup/setup.h"
#include "lobe/types.h"

namespace lobe {

// ---- What the scene is made of. `pointer` is the JSON pointer of the entry, for messages ("" if built in
// code).
struct FibreDirection {
  Vec3d direction;
};
struct FibreArray {};  // "fibre", a cell array of the mesh file
struct FibreHarmonic {
  Selector from, to;  // vertices
};
struct FibreAround {
  Vec3d point, axis;
};
using FibreField = std::variant<FibreDirection, FibreArray, FibreHarmonic, FibreAround>;

// One of several bodies: a mesh of its own, which is scaled, then turned about its origin, then moved.
struct SceneBody {
  std::string name;
  std::filesystem::path mesh;  // absolute, or relative to the scene file
  double mesh_scale = 1;
  Vec3d position = Vec3d::Zero();           // [m]
  Eigen::Vector4d orientation{0, 0, 0, 1};  // unit quaternion x, y, z, w
  Carries carries = Carries::nothing;       // what enters it where it is held
};

struct Material {
  std::string name = "tissue";
  std::optional<Selector> where;         // the first material without one is the default
  double lame_lambda = 4e4;              // [Pa]
  double lame_mu = 1e4;                  // [Pa]
  double density = 1000;                 // [kg/m³]
  double fracture_energy = 0;            // work of a scalpel per area that it opens [J/m²]
  std::optional<double> nodal_pressure;  // share of λ whose pressure is averaged at nodes, 0…1
  MaterialLaw law = MaterialLaw::svk;
  std::array<double, 2> further{};      // constants of the law (law_rows)
  double fibre_angle = 0;               // angle of both families of fibres to the direction [degrees]
  std::array<double, 3> fibre_plane{};  // a vector of their plane
  std::array<PronyTerm, most_prony_terms> viscosity{};  // terms of a Prony series, the first ones
  std::optional<ElementType> element;  // element; without one, and without nodal_pressure: default_element.h
  std::optional<TransverseConstants> transverse;  // constants with fibres, in place of both Lamé coefficients
  std::optional<FibreField> fibre;                // field of fibres, for those constants or for such a law
  std::string pointer;
};

// The moduli of a material. Where it names no element and no nodal pressure, those of Elastic.
inline Elastic elastic_of(const Material& m) {
  Elastic elastic{m.lame_lambda, m.lame_mu, m.density, m.nodal_pressure.value_or(0), m.law};
  elastic.fracture_energy = m.fracture_energy;
  elastic.element = m.element.value_or(ElementType::tetrahedron);
  elastic.further = m.further;
  elastic.fibre_angle = m.fibre_angle * std::numbers::pi / 180;
  elastic.fibre_plane = m.fibre_plane;
  elastic.viscosity = m.viscosity;
  if (m.transverse) set_transverse(*m.transverse, elastic);
  return elastic;
}

struct Region {
  std::string name;
  RegionModel model = RegionModel::nonlinear;
  RegionFrame frame = RegionFrame::fixed;  // frame of pre-computed regions, the same in all of them
  double cell = 0;  // edge of the cells of reduced regions, the same in all of them [m]; 0: lobe chooses
  std::optional<Selector> where;
  std::string pointer;
  double tolerance = 0;  // error above which reduced regions are corrected, the same in all; 0: none is
};

// A gesture for which regions are chosen: a displacement of vertices [m], or a force on them [N].
struct SceneGesture {
  std::string name;
  Selector where;
  bool is_force = false;
  Vec3d value = Vec3d::Zero();
  std::string pointer;
};

struct AutoRegions {
  double tolerance = 0.02;             // relative L2 error of the displacement, for each gesture
  bool precomputed = true;             // whether linear regions may be precomputed
  bool reduced = false;                // whether all may be reduced, where the mesh is fine enough to pay
  bool correct = false;                // whether zones change their model while the scene runs
  std::vector<SceneGesture> gestures;  // none: those of the scene's grasps, else pulls at five places
};

struct Boundary {
  enum class Kind { fix, displacement, traction, force, pressure };
  Kind kind = Kind::fix;
  Vec3d value = Vec3d::Zero();        // displacement [m], traction [Pa], total force [N]
  double pressure = 0;                // [Pa], positive where it pushes into the body
  Axes axes = all_axes;               // prescribed components of a displacement
  HoldBy hold_by = HoldBy::vertices;  // part held, of a fix or displacement
  Selector where;
  std::string pointer;
};

// A cut by a scalpel: through tetrahedra where the blade goes, or along faces that the mesh has.
enum class CutSurface : bool { smooth, faces };

// What a scene says of a tool: its setup, and of some kinds more, from which the setup follows.
struct SceneGrasp : GraspSetup {
  std::optional<Selector> where;      // vertices of which it takes hold
  HoldBy hold_by = HoldBy::vertices;  // part of these that it holds
  std::vector<Index> copies;          // vertices that earlier cuts make, numbered after the mesh's
};
struct SceneScalpel : ScalpelSetup {
  std::optional<Vec3d> blade;               // vector from tip to heel, where the file says it once [m]
  CutSurface surface = CutSurface::smooth;  // what it opens
};
struct SceneProbe : ProbeSetup {          // its shape is empty while it is a mesh in a file
  std::filesystem::path shape_file = {};  // file of its shape, absolute or relative to the scene file
};
template <class Setup>
struct InScene {
  using Type = Setup;
};
template <>
struct InScene<GraspSetup> {
  using Type = SceneGrasp;
};
template <>
struct InScene<ScalpelSetup> {
  using Type = SceneScalpel;
};
template <>
struct InScene<ProbeSetup> {
  using Type = SceneProbe;
};
template <class... Setup>
std::variant<typename InScene<Setup>::Type...> one_in_scene(
    std::tuple<std::vector<Setup> ToolSetups::*...>);  // not defined

struct Tool {
  decltype(one_in_scene(ToolSetups::fields)) kind;  // one for each kind of tool (tool_kinds.h)
  std::string pointer;

  template <class Setup>
  bool is() const {
    return std::holds_alternative<typename InScene<Setup>::Type>(kind);
  }
  template <class Setup>
  const auto& as() const {
    return std::get<typename InScene<Setup>::Type>(kind);
  }
  template <class Setup>
  auto& as() {
    return std::get<typename InScene<Setup>::Type>(kind);
  }
  std::string type() const {
    return std::visit([]<class Kind>(const Kind&) { return Kind::type; }, kind);
  }
  const std::string& name() const {
    return std::visit([](const auto& tool) -> const std::string& { return tool.name; }, kind);
  }
  // Times increase strictly. It acts from the first to the last.
  const std::vector<PathPoint>& path() const {
    return std::visit(
        [](const auto& tool) -> const auto& { return tool.path; }, kind);
  }
  std::vector<PathPoint>& path() {
    return std::visit(
        [](auto& tool) -> auto& { return tool.path; }, kind);
  }
  const Selector* where() const { return const_cast<Tool*>(this)->where(); }  // null: it has none
  Selector* where() {
    const auto find = [](auto& tool) -> Selector* {
      if constexpr (requires { tool.where; })
        if (tool.where) return &*tool.where;
      return nullptr;
    };
    return std::visit(find, kind);
  }
  std::filesystem::path* shape_file() {  // null: it has none
    const auto find = [](auto& tool) -> std::filesystem::path* {
      if constexpr (requires { tool.shape_file; }) return &tool.shape_file;
      return nullptr;
    };
    return std::visit(find, kind);
  }
};

enum class Precision : std::uint8_t { single_precision, double_precision };

struct Time {
  double duration = 1;      // [s]
  double frame = 1.0 / 30;  // [s], one call of advance()
  double damping = 0;       // γ [1/s], mass-proportional
  double safety = 0.9;      // time step = safety × 2/ω_max
  double cut_step = 0.75;   // share of the uncut body's time step that scalpels should leave; 0: no mass
  int selective_mass = 1;   // degree s of theory (7.8); 1: masses are lumped
  double ramp = 0.1;        // time in which prescribed displacements are reached [s]
  double load_ramp = 0;     // time in which tractions and forces grow to their full size [s]
  // Change of displacements that sleep may cause [m]; 0: nothing sleeps; nullopt: parts at rest sleep in
  // sessions alone (live/session_scene.h).
  std::optional<double> sleep;
  bool own_steps = false;  // whether parts take steps of their own lengths (time/own_steps.h)
  Precision precision = Precision::single_precision;
  Integrator integrator = Integrator::central_difference;
  double step = 0;               // step of the implicit integrator [s]; 0: one per frame
  double spectral_radius = 0.8;  // spectral radius of that integrator at high frequencies, 1: no damping
};

struct Output {
  double every = 1.0 / 30;       // time between VTU frames [s]
  std::vector<double> pictures;  // times of PNG pictures [s]
};

struct Scene : SceneForces {
  // Implicit dynamics are always computed in double precision.
  bool in_double() const {
    return time.precision == Precision::double_precision || time.integrator == Integrator::generalised_alpha;
  }
  // Whether lobe adapts the degree of selective masses while the scene runs. No region is linear then.
  bool corrects_masses() const { return auto_regions && auto_regions->correct && time.selective_mass > 1; }
  // The estimated error of reduced regions that lobe run corrects; none: it does not.
  std::optional<double> reduced_tolerance() const {
    if (auto_regions && auto_regions->correct) return auto_regions->tolerance;
    for (const Region& region : regions)
      if (region.model == RegionModel::reduced && region.tolerance > 0) return region.tolerance;
    return {};
  }

  std::string name;               // name in reports
  std::filesystem::path file;     // file it was read from
  std::filesystem::path mesh;     // absolute, or relative to the scene file; empty where there are bodies
  double mesh_scale = 1;          // factor of its coordinates, before anything is selected
  std::vector<SceneBody> bodies;  // bodies in place of one mesh
  std::vector<Material> materials;
  double volume_penalty = 0;                // κ [Pa]
  double guard_below = 0;                   // J₀ of fem/guard.h, 0: no guard
  std::vector<Region> regions;              // regions: the first match wins; without one: nonlinear
  std::optional<AutoRegions> auto_regions;  // automatic regions in place of `regions`
  std::vector<Boundary> boundary;
  Vec3d gravity = Vec3d::Zero();  // [m/s²]
  std::vector<Tool> tools;
  ContactSetup contact;
  std::vector<std::filesystem::path> obstacle_files;  // file of each obstacle's shape, as of a probe
  LoosePieces loose_pieces = LoosePieces::fall;
  std::filesystem::path skin;  // OBJ file of a finer surface to show, as `mesh`; empty: none
  Time time;
  Output output;
};

}  // namespace lobe
