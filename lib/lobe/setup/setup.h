// A setup is a scene resolved on one mesh: plain arrays per tetrahedron and vertex. A World is built from it.
#pragma once

#include <array>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/fem/body.h"
#include "lobe/setup/contact_setup.h"
#include "lobe/setup/force_setups.h"
#include "lobe/setup/tool_setups.h"

namespace lobe {

struct FaceLoad {  // a dead load on one boundary face, by its rest area
  Index tet = 0;
  int face = 0;                    // the corner opposite to the face
  Vec3d traction = Vec3d::Zero();  // [Pa]
  // Corner k of the face, in the order of face_corners, gets weights[k] · traction · A/3, with A the area of
  // the whole face at rest. If a blade has left only a part of the face, they are three times that part's
  // share of A, times the barycentric coordinates of its centroid.
  Vec3d weights = Vec3d::Ones();
  static constexpr auto fields =
      std::tuple(&FaceLoad::tet, &FaceLoad::face, &FaceLoad::traction, &FaceLoad::weights);
};

struct FacePressure {  // pressure on one boundary face, along the normal that it has as it moves
  Index tet = 0;
  int face = 0;         // the corner opposite to the face
  double pressure = 0;  // [Pa], positive where it pushes into the body
  static constexpr auto fields = std::tuple(&FacePressure::tet, &FacePressure::face, &FacePressure::pressure);
};

struct VertexLoad {
  Index vertex = 0;
  Vec3d force = Vec3d::Zero();  // [N]
  bool operator==(const VertexLoad&) const = default;
  static constexpr auto fields = std::tuple(&VertexLoad::vertex, &VertexLoad::force);
};

using Axes = std::array<bool, 3>;  // flags of the components x, y, z
inline constexpr Axes all_axes{true, true, true};

struct PrescribedVertex {
  Index vertex = 0;
  Vec3d displacement = Vec3d::Zero();  // [m], zero where the vertex is fixed
  Axes axes = all_axes;  // the components that are prescribed; the vertex slides along the others
  static constexpr auto fields =
      std::tuple(&PrescribedVertex::vertex, &PrescribedVertex::displacement, &PrescribedVertex::axes);
};

// A vertex that is held by a share φ: a spring draws it to where it is prescribed (body/hold_springs.h).
struct PartlyHeldVertex {
  Index vertex = 0;
  double share = 0;                    // φ, above 0 and below 1
  Vec3d displacement = Vec3d::Zero();  // [m]
  Axes axes = all_axes;                // the components that are drawn
  static constexpr auto fields = std::tuple(&PartlyHeldVertex::vertex, &PartlyHeldVertex::share,
                                            &PartlyHeldVertex::displacement, &PartlyHeldVertex::axes);
};

inline constexpr int highest_mass_degree = 16;  // greatest degree of selective mass scaling

enum class LoosePieces : std::uint8_t { fall, vanish, stay };  // what becomes of pieces that nothing holds

enum class Integrator : std::uint8_t {
  central_difference,  // explicit, as many steps as stability needs
  generalised_alpha    // implicit, steps of a given size; World<double> only
};
inline const char* name(Integrator i) { return i == Integrator::generalised_alpha ? "implicit" : "explicit"; }

// Body has the mesh, its materials and the region of each tetrahedron.
struct Setup : Body, ToolSetups, ForceSetups {
  std::vector<PrescribedVertex> prescribed;
  std::vector<PartlyHeldVertex> partly_held;
  std::vector<FaceLoad> face_loads;
  std::vector<VertexLoad> vertex_loads;
  std::vector<FacePressure> pressures;
  Vec3d gravity = Vec3d::Zero();  // [m/s²]
  LoosePieces loose_pieces = LoosePieces::fall;
  double damping = 0;  // γ, proportional to mass [1/s]
  // Steps are this share of the stable step 2/ω_max, above 0 and up to 2. Above 1 they are unstable, and only
  // the repetition of failed frames limits the damage.
  double safety = 0.9;
  // The share of the uncut body's stable step that blades should leave. Mass is added where they have
  // divided tetrahedra (mass_floor.h); 0 adds none. Explicit integrator only.
  double cut_step = 0.75;
  // The highest frequency of a vertex at a cut, ω* [rad/s]; 0: that of the uncut body over cut_step.
  double cut_frequency = 0;
  int selective_mass = 1;  // s of theory (7.8), 1…16: the stable step grows with it; 1: masses are lumped
  Integrator integrator = Integrator::central_difference;
  double implicit_step = 0;      // longest step [s]; 0: one step per call of advance()
  double spectral_radius = 0.8;  // spectral radius of generalised-α at high frequencies, 1: no damping
  double ramp = 0.1;             // time in which prescribed displacements are reached [s]
  double load_ramp = 0;          // time in which all loads but weight grow linearly [s]
  double sleep = 0;              // change of displacements that sleep may cause [m]; 0: nothing sleeps
  bool own_steps = false;        // whether parts take steps of their own lengths (time/own_steps.h)
  double lattice_cell = 0;       // edge of the cells of reduced regions [m]; 0: chosen by their size
  bool expandable = false;       // pre-computed regions may be non-linear for a while (command Expand)
  ContactSetup contact;
  std::vector<CarrierSetup> carriers;

  // The members that decide how a world moves, for fingerprint(): no names.
  static constexpr auto fields = std::tuple_cat(
      Body::fields,
      std::tuple(&Setup::prescribed, &Setup::partly_held, &Setup::face_loads, &Setup::vertex_loads,
                 &Setup::pressures, &Setup::gravity, &Setup::loose_pieces, &Setup::damping, &Setup::safety,
                 &Setup::cut_step, &Setup::cut_frequency, &Setup::selective_mass, &Setup::integrator,
                 &Setup::implicit_step, &Setup::spectral_radius, &Setup::ramp, &Setup::load_ramp,
                 &Setup::sleep, &Setup::own_steps, &Setup::lattice_cell, &Setup::expandable, &Setup::contact),
      ForceSetups::fields, std::tuple(&Setup::carriers), ToolSetups::fields);
};

}  // namespace lobe
