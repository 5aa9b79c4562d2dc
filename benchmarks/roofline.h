// What bounds a kernel: the multiplications and additions of its formulas, and what this machine can do at
// most.
#pragma once

namespace lobe::bench {

// Operations per tetrahedron, counted by evaluating the formulas of one element with numbers that count; and
// per edge.
double flops_svk();
double flops_svk_volume();
double flops_tensor_mass_edge();

// Of one thread, the best of some tries.
double stream_bytes_per_second();  // read from 64 MB, beyond what the caches hold of it
template <class Real>
double peak_flops_per_second();  // a multiplication beside every addition, in the widest registers there are
extern template double peak_flops_per_second<float>();
extern template double peak_flops_per_second<double>();

}  // namespace lobe::bench
