// The models that `lobe bench accuracy` compares: one setup, played with different regions.
#pragma once

#include <string>
#include <vector>

#include "lobe/setup/setup.h"

namespace lobe::bench {

inline constexpr int mass_degree = 12;  // the highest of selective masses that a watch chooses

struct Model {
  std::string name;
  Setup setup;
  double linear_fraction = 0;  // of the volume
  bool is_corrected = false;   // where an estimate of its error exceeds 2 %
};

// All non-linear, with the scene's own volume penalty: what every error is measured against.
Setup reference_setup(Setup setup);

// tensor_mass        everywhere
// svk                everywhere, without volume penalty
// svk_volume         everywhere, with the scene's volume penalty, if it has one
// reduced            on a lattice everywhere, full around tools, with the scene's volume penalty
// reduced_corrected  the same, and full where a ReducedWatch asks for it
// selective_mass_corrected  non-linear everywhere, with selective masses whose degree a MassWatch chooses
// hybrid_scene       the scene's own regions, if any is linear
// hybrid_strain_50   the half of the volume with the least smoothed strain of a linear trial solution is
//                    tensor-mass
// hybrid_strain_80   four fifths of it
// hybrid_gradient_50 the half with the least smoothed displacement gradient, that is strain and rotation
// hybrid_held_50     the half nearest to the held vertices, as one would guess
// What cannot be had is left out with a warning.
std::vector<Model> make_models(const Setup& setup, std::vector<std::string>& warnings);

// With the displacements of the gesture's end as boundary conditions: grasps are at their last offset.
Setup at_the_end(Setup setup);

// One linear static solution with the loads of the gesture's end: [m]
// Throws InputError if the body is not held.
Mat3X<double> linear_trial(const Setup& setup);

enum class Measure { strain, gradient };  // ½(∇u + ∇uᵀ), ∇u
// Its norm per tetrahedron, averaged to the vertices and back by volume, twice.
std::vector<double> smoothed_norm(const TetMesh& mesh, const Mat3X<double>& u, Measure measure);

// Makes the tetrahedra with the least score tensor-mass, up to a fraction of the volume, the others
// non-linear. Returns the fraction that was reached.
double make_linear(Setup& setup, const std::vector<double>& score, double fraction);

}  // namespace lobe::bench
