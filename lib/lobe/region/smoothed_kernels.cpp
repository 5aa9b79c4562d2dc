// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/region/smoothed_kernels.h"

#include "lobe/fem/law.h"
#include "lobe/region/domain_lanes.h"

namespace lobe::LOBE_KERNELS {
namespace {

// Vectors of the vertices of a block of domains. They are added block by block, vertex by vertex, so that the
// order of the sums, and so their bits, does not depend on the width of registers.
template <class T>
class DomainVectors {
 public:
  using Real = typename T::value_type;
  using Vectors = PaddedVectors<T>;
  static constexpr int width = SmoothedBlock<Real>::width;

  void set(Index vertex, int first, const Vec3<T>& vectors) {
    Vectors::store(vectors, vectors_[vertex] + 4 * first);
  }
  void add_to(Real* sums, const SmoothedArrays<Real>& patch, Index block) const {
    const auto* numbers = patch.numbers + patch.blocks[block].first + block;
    for (Index j = 0; j < patch.blocks[block].vertices; ++j) add_row(sums, numbers[j], vectors_[j]);
  }

 private:
  static void add_row(Real* sums, const NumberRow<Real>& numbers, const Real* vectors) {
    using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;
    unrolled<width>([&](int lane) {
      Four sum, vector;
      Real* place = sums + 4 * numbers[lane];
      constexpr int count = Vectors::count;
      std::memcpy(&sum, place, sizeof sum);
      std::memcpy(&vector, vectors + lane / count * 4 * count + Vectors::offset(lane % count), sizeof vector);
      sum += vector;
      std::memcpy(place, &sum, sizeof sum);
    });
  }

  alignas(64) Real vectors_[256][4 * width];  // one byte numbers a vertex
};

// The kernels are flattened (LOBE_FLATTEN): all formulas inline, however often they are used elsewhere. Clang
// does this with what they call themselves, and not with what that calls.
template <class Real, Terms terms, Strain strain = Strain::finite>
LOBE_FLATTEN void add_forces_of(const SmoothedArrays<Real>& patch, Real* sums) {
  using T = Pack<Real>;
  using Lanes = DomainLanes<T>;
  DomainVectors<T> forces;
  for (Index b = 0; b < patch.block_count; ++b) {
    for (int first = 0; first < SmoothedBlock<Real>::width; first += Lanes::count) {
      const Law<T> law = law_of_domains<T>(patch, terms, b, first);
      const Lanes e(patch, b, first);
      Mat3<T> minus_VP;
      if constexpr (strain == Strain::small)
        minus_VP = linear_stress(law.times(-e.V), e.H);
      else
        minus_VP = law_stress(law.times(-e.V), e.H);
      Vec3<T> of_first = Vec3<T>::Constant(T(0));
      for (Index j = 1; j < e.vertices; ++j) {
        const Vec3<T> f = minus_VP.lazyProduct(e.gradient(j));
        of_first -= f;
        forces.set(j, first, f);
      }
      forces.set(0, first, of_first);
    }
    forces.add_to(sums, patch, b);
  }
}

template <class Real>
LOBE_FLATTEN void find_gradients(const SmoothedArrays<Real>& patch, DomainGradients<Real>* H,
                                 Real* volume_strains) {
  using Lanes = DomainLanes<Pack<Real>>;
  constexpr int width = SmoothedBlock<Real>::width;
  for (Index b = 0; b < patch.block_count; ++b)
    for (int first = 0; first < width; first += Lanes::count) {
      const Lanes e(patch, b, first);
      for (int i = 0; i < 9; ++i) e.H(i % 3, i / 3).copy_to(&H[b].entries[i][first]);
      const Pack<Real> strain = e.V * strain_trace(e.H);
      strain.copy_to(volume_strains + b * width + first);
    }
}

template <StiffnessPart part, class T>
Vec3<T> entries_of(const Mat3<T>& K) {
  if constexpr (part == StiffnessPart::diagonal) return K.diagonal();
  return {K(0, 1), K(0, 2), K(1, 2)};
}

template <class Real, Terms terms, StiffnessPart part>
LOBE_FLATTEN void add_stiffness_of(const SmoothedArrays<Real>& patch, Real* sums) {
  using T = Pack<Real>;
  using Lanes = DomainLanes<T>;
  DomainVectors<T> entries;
  for (Index b = 0; b < patch.block_count; ++b) {
    for (int first = 0; first < SmoothedBlock<Real>::width; first += Lanes::count) {
      const Law<T> law = law_of_domains<T>(patch, terms, b, first);
      const Lanes e(patch, b, first);
      Vec3<T> gradient = e.first_gradient();
      for (Index j = 0; j < e.vertices; ++j) {
        if (j > 0) gradient = e.gradient(j);
        const Mat3<T> K = law_diagonal_block(law, e.H, gradient);
        entries.set(j, first, entries_of<part, T>(K) * e.V);
      }
    }
    entries.add_to(sums, patch, b);
  }
}

// Whether a kernel for these terms evaluates the law: what the law does not have gets the modulus 0.
constexpr bool evaluates(const Terms& terms, const Terms& of_law) {
  return terms.solid == of_law.solid && terms.fibre >= of_law.fibre && terms.pressure >= of_law.pressure;
}

template <class Real>
void add_linear_forces(const SmoothedArrays<Real>& patch, Real* f) {
  constexpr Terms with_fibre{.fibre = true};
  if (patch.law.terms.fibre) return add_forces_of<Real, with_fibre, Strain::small>(patch, f);
  add_forces_of<Real, Terms{}, Strain::small>(patch, f);
}

template <class Real, std::size_t i = 0>
void add_forces(const SmoothedArrays<Real>& patch, PaddedVector<Real>* f) {
  if (patch.strain == Strain::small) return add_linear_forces(patch, &f->xyz0[0]);
  if constexpr (i + 1 < std::size(smoothed_terms))
    if (!evaluates(smoothed_terms[i], patch.law.terms)) return add_forces<Real, i + 1>(patch, f);
  add_forces_of<Real, smoothed_terms[i]>(patch, &f->xyz0[0]);
}

template <class Real, std::size_t i = 1>
void add_stiffness(const SmoothedArrays<Real>& patch, StiffnessPart part, PaddedVector<Real>* K) {
  if constexpr (i + 1 < std::size(smoothed_terms))
    if (!evaluates(smoothed_terms[i], patch.law.terms)) return add_stiffness<Real, i + 1>(patch, part, K);
  constexpr Terms terms = smoothed_terms[i];
  if (part == StiffnessPart::diagonal)
    return add_stiffness_of<Real, terms, StiffnessPart::diagonal>(patch, &K->xyz0[0]);
  add_stiffness_of<Real, terms, StiffnessPart::off_diagonal>(patch, &K->xyz0[0]);
}

}  // namespace

extern const SmoothedKernels<float> smoothed_single_kernels{add_forces<float>, find_gradients<float>,
                                                            add_stiffness<float>};
extern const SmoothedKernels<double> smoothed_double_kernels{add_forces<double>, find_gradients<double>,
                                                             add_stiffness<double>};

}  // namespace lobe::LOBE_KERNELS
