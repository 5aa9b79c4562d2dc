// What several validation cases need: bodies of one material, boundary data from a field, mean stress.
#pragma once

#include <functional>
#include <vector>

#include "lobe/setup/setup.h"

namespace lobe::validation {

using Field = std::function<Vec3d(const Vec3d& X)>;     // X [m]
using Condition = std::function<bool(const Vec3d& X)>;  // of a rest position

Setup body_of(TetMesh mesh, const Elastic& elastic, RegionModel model);

// Vertices moved at random by up to `part` of `cell` along each axis; those on the boundary only if asked.
TetMesh jittered(TetMesh mesh, double cell, double part, unsigned seed, bool boundary_too);

std::vector<Index> outer_vertices(const TetMesh& mesh);  // of the boundary surface, ascending
std::vector<Index> vertices_where(const TetMesh& mesh, const Condition& holds);

// Prescribes u(X) at vertices.
void prescribe(Setup& setup, const std::vector<Index>& vertices, const Field& u);

// The vertices on the plane X[axis] = place [m] slide in it; across, they are displaced by as much as said
// [m].
void slide(Setup& setup, int axis, double place, double displacement = 0);

// A dead load t(N) on the boundary faces whose three vertices satisfy a condition; N is the outer unit
// normal.
void load_faces(Setup& setup, const Condition& holds, const Field& traction);

// The static equilibrium [m]; throws std::runtime_error where the solver finds none.
Mat3X<double> equilibrium(const Setup& setup);
// Another solver for all that equilibrium() is asked for from now on; none: solve_static().
void solve_equilibria_by(std::function<Mat3X<double>(const Setup&)> solver);

// −∂W/∂u of a displaced body, without its loads, by the kernels that run in time: 3 × #vertices [N].
Mat3X<double> internal_forces(const Setup& setup, const Mat3X<double>& u);

// Mean first Piola-Kirchhoff stress by the outer forces that equilibrium asks for, Σ r_v ⊗ X_v / V, r = −f
// [Pa].
Mat3<double> mean_stress(const Setup& setup, const Mat3X<double>& u);

// Largest distance of a vertex, as a part of the largest displacement of b.
double relative_maximum(const Mat3X<double>& a, const Mat3X<double>& b);

}  // namespace lobe::validation
