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
#include "lobe/setup/setup.h"
#include "lobe/types.h"

namespace lobe {

// ---- Selectors. A tetrahedron is selected by its barycentre, a vertex by its rest position, a boundary face
// when its three vertices are, or if a surface that the mesh's file names has it.
struct Selector;
struct SelectAll {};
struct SelectBox {
  Vec3d min, max;
};  // [m]
struct SelectSphere {
  Vec3d center;
  double radius = 0;
};  // [m]
struct SelectPlane {
  enum class Side { within, above, below };
  Vec3d point, normal;  // `above` is where the normal points
  Side side = Side::within;
  double within = 0;  // [m], for Side::within
};
struct SelectNearest {
  Vec3d point;
  int count = 1;
};  // the `count` nearest vertices (or tetrahedra)
struct SelectLabel {
  std::vector<int> labels;
  std::vector<std::string> names = {};  // that the mesh's file has for further ones, until bind_groups()
};                                      // tetrahedra; vertices of such tetrahedra
struct SelectBody {
  std::vector<std::string> names;
};  // tetrahedra of these bodies; their vertices
struct SelectSurface {
  std::vector<std::string> names;  // or numbers, of groups of triangles that the mesh's file has
  std::vector<std::array<Index, 3>> triangles = {};  // that bind_groups() finds for them
  bool is_bound = false;
};  // boundary faces; their vertices; tetrahedra that have such a face
struct SelectPatch {
  Vec3d point;       // the boundary face nearest to it is the first
  double angle = 0;  // [degrees]
};  // boundary faces that are connected with it by edges where they turn by less; their vertices
struct SelectVertices {
  std::vector<Index> vertices;
};
struct SelectTetrahedra {
  std::vector<Index> tetrahedra;
};
struct SelectAnyOf {
  std::vector<Selector> parts;
};
struct SelectAllOf {
  std::vector<Selector> parts;
};
struct SelectNot {
  std::vector<Selector> part;
};  // exactly one
struct Selector {
  std::variant<SelectAll, SelectBox, SelectSphere, SelectPlane, SelectNearest, SelectLabel, SelectVertices,
               SelectTetrahedra, SelectSurface, SelectPatch, SelectBody, SelectAnyOf, SelectAllOf, SelectNot>
      value;
};

// What of a selection is held: the vertices in it, each wholly, or each vertex by the share of its volume, or
// of its area of the surface, that lies in it (select_shares.h).
enum class HoldBy : std::uint8_t { vertices, volume, area };
inline constexpr std::array<const char*, 3> hold_by_names{"vertices", "volume", "area"};

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
  Carries carries = Carries::nothing;       // what comes in where it is held
};

struct Material {
  std::string name = "tissue";
  std::optional<Selector> where;         // the first material without one is the default
  double lame_lambda = 4e4;              // [Pa]
  double lame_mu = 1e4;                  // [Pa]
  double density = 1000;                 // [kg/m³]
  double fracture_energy = 0;            // work of a scalpel per area [J/m²]
  std::optional<double> nodal_pressure;  // share of λ whose pressure is averaged at nodes, 0…1
  MaterialLaw law = MaterialLaw::svk;
  std::array<double, 2> further{};      // constants of the law (law_rows)
  double fibre_angle = 0;               // of both families of fibres of the law to the direction [degrees]
  std::array<double, 3> fibre_plane{};  // a vector of their plane
  std::optional<ElementType> element;   // without one, and without nodal_pressure: default_element.h
  std::optional<TransverseConstants> transverse;  // with fibres, in place of both Lamé coefficients
  std::optional<FibreField> fibre;                // together with them, or with such a law
  std::string pointer;
};

// Where the material names no element and no nodal pressure, those of Elastic.
inline Elastic elastic_of(const Material& m) {
  Elastic elastic{m.lame_lambda, m.lame_mu, m.density, m.nodal_pressure.value_or(0), m.law};
  elastic.fracture_energy = m.fracture_energy;
  elastic.element = m.element.value_or(ElementType::tetrahedron);
  elastic.further = m.further;
  elastic.fibre_angle = m.fibre_angle * std::numbers::pi / 180;
  elastic.fibre_plane = m.fibre_plane;
  if (m.transverse) set_transverse(*m.transverse, elastic);
  return elastic;
}

struct Region {
  std::string name;
  RegionModel model = RegionModel::nonlinear;
  RegionFrame frame = RegionFrame::fixed;  // precomputed: the same in all such regions
  double cell = 0;  // reduced: edge of the lattice's cells, equal in all such regions [m]; 0: lobe chooses
  std::optional<Selector> where;
  std::string pointer;
  double tolerance = 0;  // reduced: estimated error that is corrected, the same in all; 0: none is
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
  double tolerance = 0.02;             // relative L2 error of the displacement, of each gesture
  bool precomputed = true;             // whether linear regions may be precomputed
  bool reduced = false;                // whether all may be reduced, where the mesh is fine enough to pay
  bool correct = false;                // whether zones change their model while the scene runs
  std::vector<SceneGesture> gestures;  // empty: those of the scene's grasps; without, pulls at five places
};

struct Boundary {
  enum class Kind { fix, displacement, traction, force, pressure };
  Kind kind = Kind::fix;
  Vec3d value = Vec3d::Zero();        // displacement [m], traction [Pa], total force [N]
  double pressure = 0;                // [Pa], positive where it pushes into the body
  Axes axes = all_axes;               // displacement: the components that are prescribed
  HoldBy hold_by = HoldBy::vertices;  // fix, displacement
  Selector where;
  std::string pointer;
};

struct Tool {
  std::string name;
  std::string type = GraspSetup::type;  // as tool_kinds.h has them
  std::optional<Selector> where;        // grasp: the vertices it takes hold of
  HoldBy hold_by = HoldBy::vertices;    // grasp
  std::vector<Index> copies;   // grasp: vertices that earlier cuts make, numbered after those of the mesh
  double radius = 0;           // cautery: of its spherical tip [m]
  Vec3d hook = Vec3d::Zero();  // cautery: from its tip to the end of its hook [m]; zero: it has none
  double core = 0;             // cautery: radius of the rigid wire in it [m]
  ClipShape clip;              // clip applier
  double snap = 0.1;           // scalpel: a vertex nearer to the cut than this share of its edges lies on it
  std::vector<Vec3d> heels;    // scalpel: one for each row of its path [m]
  std::optional<Vec3d> blade;  // scalpel: from tip to heel, where the file says it once [m]
  bool along_faces = false;    // scalpel: opens faces of the mesh, and divides no tetrahedron
  RigidShape shape;            // probe; of a mesh, empty where it is in a file
  std::filesystem::path shape_file;    // probe: absolute or relative to the scene file
  double friction = default_friction;  // probe: against tissue [-]
  std::vector<PathPoint> path;         // times strictly increasing; acts from the first to the last
  bool release = false;  // grasp, probe: let go after the last path point (otherwise hold on there)
  std::string pointer;
};

// A length of thread that is drawn through points of the body at rest, and its knots.
struct SceneTie {
  double at = 0;                                     // [s]
  double tighten = 0;                                // by how much the loop is drawn together [m]
  double over = 0.2;                                 // in this time [s]
  std::optional<std::array<Index, 2>> between = {};  // points of the stitch, from 0; none: first and last
};
struct SceneStitch {
  std::vector<Vec3d> through;  // [m]
  double at = 0;               // when it is sewn [s]
  std::vector<SceneTie> ties;
};
struct SceneThread {
  std::string name = "thread";
  ThreadMaterial material;
  std::vector<SceneStitch> stitches;
  std::string pointer;
};

// A bed of strands between two parts of the surface, or a ligament between two points.
struct SceneBed {
  Selector from;                               // boundary faces
  std::optional<Selector> to;                  // boundary faces; none: the world
  double within = 0;                           // how far strands reach at most [m]; 0: only where faces touch
  double spacing = 0;                          // about how far they are apart [m]; 0: one per face
  double stiffness = 0;                        // per area [Pa/m]
  std::optional<double> fracture_energy = {};  // [J/m²]; none: it never tears
};
struct SceneLigament {
  Vec3d from, to;                       // [m]
  bool ends_in_world = false;           // the second point does not move
  double stiffness = 0;                 // [N/m]
  double slack = 0;                     // by which it is longer than the way between its ends [m]
  std::optional<double> strength = {};  // its largest tension [N]; none: it never tears
};
struct SceneAttachment {
  std::string name;
  double softening = 3;  // elongation at which it has torn over that at which it begins to
  std::variant<SceneBed, SceneLigament> what;
  std::string pointer;
};

enum class Precision : std::uint8_t { single_precision, double_precision };

struct Time {
  double duration = 1;      // [s]
  double frame = 1.0 / 30;  // [s], one call of advance()
  double damping = 0;       // γ [1/s], mass-proportional
  double safety = 0.9;      // time step = safety × 2/ω_max
  double cut_step = 0.75;   // share of the uncut body's time step that scalpels should leave; 0: no mass
  int selective_mass = 1;   // degree of the inverse mass (time/selective_mass.h); 1: masses are lumped
  double ramp = 0.1;        // [s] over which prescribed displacements are reached
  double load_ramp = 0;     // [s] over which tractions and forces grow to their full size
  double sleep = 0;         // [m] by which displacements may differ where parts at rest sleep; 0: none does
  Precision precision = Precision::single_precision;
  Integrator integrator = Integrator::central_difference;
  double step = 0;               // of the implicit integrator [s]; 0: one per frame
  double spectral_radius = 0.8;  // of the implicit integrator at high frequencies, 1: no numerical damping
};

struct Output {
  double every = 1.0 / 30;       // [s] between VTU frames
  std::vector<double> pictures;  // times [s] of PNG pictures
};

struct Scene {
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

  std::string name;               // what reports call it
  std::filesystem::path file;     // where it was read from
  std::filesystem::path mesh;     // absolute, or relative to the scene file; empty where there are bodies
  double mesh_scale = 1;          // what its coordinates are multiplied by, before anything is selected
  std::vector<SceneBody> bodies;  // in place of one mesh
  std::vector<Material> materials;
  double volume_penalty = 0;                // κ [Pa]
  double guard_below = 0;                   // J₀ of fem/guard.h, 0: no guard
  std::vector<Region> regions;              // first match wins; where none matches: nonlinear
  std::optional<AutoRegions> auto_regions;  // in place of regions
  std::vector<Boundary> boundary;
  Vec3d gravity = Vec3d::Zero();  // [m/s²]
  std::vector<Tool> tools;
  std::vector<SceneThread> threads;
  std::vector<SceneAttachment> attachments;
  ContactSetup contact;
  std::vector<std::filesystem::path> obstacle_files;  // per obstacle: of its shape, as Tool::shape_file
  LoosePieces loose_pieces = LoosePieces::fall;
  std::filesystem::path skin;  // OBJ file of a finer surface to show, likewise; empty: there is none
  Time time;
  Output output;
};

}  // namespace lobe
