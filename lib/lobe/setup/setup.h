// A setup is a scene resolved on one mesh: plain arrays per tetrahedron and vertex. A World is built from it.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/fem/body.h"
#include "lobe/setup/contact_setup.h"
#include "lobe/setup/tool_setups.h"

namespace lobe {

struct FaceLoad {  // dead load on one boundary face, in rest area
  Index tet = 0;
  int face = 0;                    // opposite to this corner
  Vec3d traction = Vec3d::Zero();  // [Pa]
  // The load of each corner of the face, in thirds of the whole, in the order of face_corners. If a blade has
  // left only a part of the face: three times that part's share of the area, times the barycentric
  // coordinates of its middle.
  Vec3d weights = Vec3d::Ones();
  static constexpr auto fields =
      std::tuple(&FaceLoad::tet, &FaceLoad::face, &FaceLoad::traction, &FaceLoad::weights);
};

struct VertexLoad {
  Index vertex = 0;
  Vec3d force = Vec3d::Zero();  // [N]
  bool operator==(const VertexLoad&) const = default;
  static constexpr auto fields = std::tuple(&VertexLoad::vertex, &VertexLoad::force);
};

using Axes = std::array<bool, 3>;  // which of the components x, y, z
inline constexpr Axes all_axes{true, true, true};

struct PrescribedVertex {
  Index vertex = 0;
  Vec3d displacement = Vec3d::Zero();  // [m], zero where the vertex is fixed
  Axes axes = all_axes;  // the components that are prescribed; the vertex slides along the others
  static constexpr auto fields =
      std::tuple(&PrescribedVertex::vertex, &PrescribedVertex::displacement, &PrescribedVertex::axes);
};

inline constexpr int highest_mass_degree = 16;  // of selective mass scaling

enum class LoosePieces : std::uint8_t { fall, vanish, stay };  // what becomes of pieces that nothing holds

enum class Integrator : std::uint8_t {
  central_difference,  // explicit, as many steps as stability needs
  generalised_alpha    // implicit, steps of a given size; World<double> only
};
inline const char* name(Integrator i) { return i == Integrator::generalised_alpha ? "implicit" : "explicit"; }

struct Setup : Body, ToolSetups {
  std::vector<PrescribedVertex> prescribed;
  std::vector<FaceLoad> face_loads;
  std::vector<VertexLoad> vertex_loads;
  Vec3d gravity = Vec3d::Zero();
  Evaluator evaluator = Evaluator::direct;
  LoosePieces loose_pieces = LoosePieces::fall;
  double damping = 0;  // [1/s]
  double safety =
      0.9;  // of the time step, as a share of the limit; above 1 the step control must save the run
  // Share of the uncut body's time step that blades leave: mass is added where they have cut (mass_floor.h);
  // 0 adds none. Explicit integrator only.
  double cut_step = 0.75;
  double cut_frequency =
      0;                    // the highest that they leave [rad/s]; 0: by cut_step, where the first blade cuts
  double mass_scaling = 0;  // mass added to lengthen the time step, as a share of the body's (mass_scaling.h)
  int selective_mass = 1;   // degree of the inverse mass (selective_mass.h); 1: masses are lumped
  Integrator integrator = Integrator::central_difference;
  double implicit_step = 0;      // [s], at most this; 0: one step per call of advance()
  double spectral_radius = 0.8;  // of generalised-α at high frequencies, 1: no numerical damping
  double ramp = 0.1;             // prescribed displacements are reached over this time [s]
  double load_ramp = 0;          // dead loads grow to their full size over this time [s]
  double sleep = 0;  // by how much displacements may differ where parts at rest sleep [m]; 0: none does
  double lattice_cell = 0;  // edge of the cells of reduced regions [m]; 0: chosen by their size
  bool expandable = false;  // pre-computed regions may be non-linear for a while (command Expand)
  ContactSetup contact;
  std::filesystem::path
      condensed_cache;  // folder that keeps condensed regions (condensed_cache.h); none: it does not

  // What decides how a world moves, for fingerprint(): no names, nothing of where results are kept.
  static constexpr auto fields = std::tuple_cat(
      Body::fields,
      std::tuple(&Setup::prescribed, &Setup::face_loads, &Setup::vertex_loads, &Setup::gravity,
                 &Setup::evaluator, &Setup::loose_pieces, &Setup::damping, &Setup::safety, &Setup::cut_step,
                 &Setup::cut_frequency, &Setup::mass_scaling, &Setup::selective_mass, &Setup::integrator,
                 &Setup::implicit_step, &Setup::spectral_radius, &Setup::ramp, &Setup::load_ramp,
                 &Setup::sleep, &Setup::lattice_cell, &Setup::expandable, &Setup::contact),
      ToolSetups::fields);
};

}  // namespace lobe
