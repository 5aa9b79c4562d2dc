// Resolves a scene on the part of a rank: what its tetrahedra are made of, what is held and loaded there.
#pragma once

#include "lobe/scene/scene.h"
#include "lobe_petsc/part.h"

namespace lobe::petsc {

// The setup of the part, in its local numbers. Selectors select the same as on the whole mesh. Pre-computed
// regions become tensor-mass ones, which have the same equilibrium. Throws InputError on all ranks for
// selectors that select nothing on any rank, for tetrahedra without a material, and for what needs the whole
// mesh in one place: automatic regions, harmonic fibres, nodal pressure.
Setup resolve_part(const Ranks& ranks, const Scene& scene, const Part& part);

// The setup of the part, from a whole setup that all ranks have.
Setup restrict_setup(const Setup& whole, const Part& part);

}  // namespace lobe::petsc
