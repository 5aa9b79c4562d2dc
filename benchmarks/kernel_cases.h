// The kernels that `lobe bench kernels` times, each set up on one body beside the result expected of it.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/reference_kernel.h"

namespace lobe::bench {

inline constexpr double cube_edge = 0.1;  // [m]

// An ordered, non-linear cube of one material, one side held, of about as many tetrahedra as 6 n³ can be.
Setup cube_setup(int tets);

// The same body, its vertices and tetrahedra numbered at random.
Setup shuffled(const Setup& setup);

// An organ, non-linear, of one material, held where x is least. liver_setup(): the shipped liver.
Setup organ_setup(const TetMesh& mesh);
Setup liver_setup();

// Gives the model to all of the body, but of a pre-computed one not to what is beyond four fifths of its
// length: that has an interface.
void give(RegionModel model, Setup& setup);

// A body with every vertex moved at random by a tenth of a cell of six tetrahedra: strains are large, and
// forces do not cancel out. Displacements are representable in single precision.
struct Specimen {
  Specimen(std::string mesh_name, const Setup& body);

  std::string mesh;  // "cube", "shuffled", "liver"
  Setup setup;
  Mat3X<double> u;  // [m]
  std::vector<ReferenceTet> reference;
  // Forces by the reference kernel [N]; `linear_smoothed` and `corotational_smoothed` by the solvers.
  Mat3X<double> svk, linear, linear_smoothed, svk_volume, svk_nodal_pressure, svk_smoothed,
      svk_smoothed_volume, svk_smoothed_pressure, svk_fibre, svk_prony, svk_smoothed_prony, neo_hookean, yeoh,
      mooney_rivlin, holzapfel, corotational, corotational_smoothed;
};

// Of svk_fibre: one direction everywhere.
inline constexpr FibreModuli<double> fibre_moduli{3e3, 8e3, 5e4};
inline const Vec3d fibre_direction = Vec3d(1, 2, 2) / 3;

inline constexpr std::array<double, 2> yeoh_moduli{2e3, 1e3};  // c₂, c₃ [Pa]
inline constexpr double mooney_c01 = 2e3;                      // [Pa]
// Of holzapfel: k₁ [Pa], k₂; the angle of both families [rad] to fibre_direction; a vector of their plane.
inline constexpr std::array<double, 2> holzapfel_constants{2e4, 2};
inline constexpr double holzapfel_angle = 0.6;
inline constexpr std::array<double, 3> holzapfel_plane{0, 1, -1};
// Of svk_prony and svk_smoothed_prony: at once the solid is twice as stiff.
inline constexpr PronyTerm prony_terms[]{{0.3, 0.3, 0.02}, {0.2, 0.2, 0.5}};
inline constexpr double volume_penalty = 1e5;  // κ of svk_volume [Pa]

struct Kernel {
  std::string name;
  std::string precision;  // "single" or "double"
  int threads = 1;
  double bytes_per_tet = 0;                       // coefficients and vertex numbers that are kept
  std::function<void()> evaluate;                 // all forces once; what is timed
  std::function<Mat3X<double>()> forces;          // found by the last evaluation [N]
  std::shared_ptr<const Mat3X<double>> expected;  // [N]
  double flops_per_tet = 0;                       // 0: not counted
  double world_bytes_per_tet = 0;                 // of a whole World in memory; 0: of another kernel
};

// `reference` first, then each kernel in both precisions on each number of threads.
std::vector<Kernel> make_kernels(const std::shared_ptr<const Specimen>& specimen,
                                 const std::vector<int>& threads);

// Largest difference to the expected force, as a part of the largest expected force. Call it on fresh
// kernels only: a step moves on.
double deviation(const Kernel& kernel);
double allowed_deviation(const Kernel& kernel);  // 1e-11 in double, 1e-5 in single precision

}  // namespace lobe::bench
