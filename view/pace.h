// How fast this machine is, for what is expected of meshes that are not made yet.
#pragma once

namespace lobe::view {

// Time that a tetrahedron takes for a step [s], in a scene as `lobe scene` makes them: edge-smoothed
// tetrahedra of liver with a volume term, in single precision. The least of some frames of a block of 10,000
// tetrahedra that falls; takes some tenths of a second.
double measured_pace(int threads);

}  // namespace lobe::view
