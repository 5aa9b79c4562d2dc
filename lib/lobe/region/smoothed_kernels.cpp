// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/region/smoothed_kernels.h"

#include "lobe/numerics/simd.h"

namespace lobe::LOBE_KERNELS {
namespace {

// The data of as many domains of a block as one register holds.
template <class T>  // a pack
class DomainLanes {
 public:
  using Real = typename T::value_type;
  static constexpr int count = static_cast<int>(T::size());

  DomainLanes(const SmoothedArrays<Real>& patch, Index block, int first)
      : V(&patch.blocks[block].V[first]),
        vertices(patch.blocks[block].vertices),
        rows_(patch.gradients + patch.blocks[block].first),
        numbers_(patch.numbers + patch.blocks[block].first + block),
        first_(first) {
    H = Mat3<T>::Constant(T(0));
    const Real* u = &patch.u->xyz0[0];
    const Vec3<T> origin = PaddedVectors<T>::load(u, &numbers_[0][first]);
    for (Index j = 1; j < vertices; ++j) {
      const Vec3<T> d = PaddedVectors<T>::load(u, &numbers_[j][first]) - origin, b = gradient(j);
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) H(r, c) += d[r] * b[c];
    }
  }

  Vec3<T> gradient(Index vertex) const {  // of any but the first
    Vec3<T> b;
    for (int i = 0; i < 3; ++i) b[i].copy_from(&rows_[vertex - 1].b[i][first_]);
    return b;
  }
  Vec3<T> first_gradient() const {
    Vec3<T> sum = Vec3<T>::Constant(T(0));
    for (Index j = 1; j < vertices; ++j) sum -= gradient(j);
    return sum;
  }
  Index number(Index vertex, int lane) const { return numbers_[vertex][first_ + lane]; }

  T V;
  Index vertices;  // the most of a lane
  Mat3<T> H;       // ∇u

 private:
  const GradientRow<Real>* rows_;
  const NumberRow<Real>* numbers_;
  int first_;
};

// Vectors of the vertices of some domains. They are added domain by domain, so that the order of the sums,
// and so their bits, does not depend on the width.
template <class T>
class DomainVectors {
 public:
  using Real = typename T::value_type;
  using Vectors = PaddedVectors<T>;

  void set(Index vertex, const Vec3<T>& vectors) { Vectors::store(vectors, vectors_[vertex]); }
  void add_to(Real* sums, const DomainLanes<T>& domains) const {
    using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;
    for (int lane = 0; lane < Vectors::count; ++lane)
      for (Index j = 0; j < domains.vertices; ++j) {
        Four sum, vector;
        Real* place = sums + 4 * domains.number(j, lane);
        std::memcpy(&sum, place, sizeof sum);
        std::memcpy(&vector, vectors_[j] + Vectors::offset(lane), sizeof vector);
        sum += vector;
        std::memcpy(place, &sum, sizeof sum);
      }
  }

 private:
  alignas(64) Real vectors_[256][4 * Vectors::count];  // one byte numbers a vertex
};

// The law of each lane at the pressure of its nodes, with its fibre.
template <Terms terms, class Real, class T = Pack<Real>>
Law<T> law_of(const SmoothedArrays<Real>& patch, Index block, int first) {
  Law<T> law = patch.law.template as<T>();
  if constexpr (terms.pressure) {
    law.pressure = T(0);
    if (patch.node_rows) {
      const auto& nodes = patch.node_rows[block].nodes;
      law.pressure = (T([&](auto lane) { return patch.pressure[nodes[0][first + lane]]; }) +
                      T([&](auto lane) { return patch.pressure[nodes[1][first + lane]]; })) *
                     Real(0.5f);
    }
  }
  if constexpr (terms.fibre)
    for (int i = 0; i < 3; ++i) law.direction[i].copy_from(&patch.fibre_blocks[block].direction[i][first]);
  return law;
}

// The kernels are flattened (LOBE_FLATTEN): all formulas inline, however often they are used elsewhere.
template <class Real, Terms terms>
LOBE_FLATTEN void add_forces_of(const SmoothedArrays<Real>& patch, Real* sums) {
  using T = Pack<Real>;
  using Lanes = DomainLanes<T>;
  DomainVectors<T> forces;
  for (Index b = 0; b < patch.block_count; ++b)
    for (int first = 0; first < SmoothedBlock<Real>::width; first += Lanes::count) {
      Law<T> law = law_of<terms>(patch, b, first);
      const Lanes e(patch, b, first);
      law.terms = terms;
      const Mat3<T> VP = law_stress(law.times(e.V), e.H);
      Vec3<T> of_first = Vec3<T>::Constant(T(0));
      for (Index j = 1; j < e.vertices; ++j) {
        const Vec3<T> f = VP.lazyProduct(e.gradient(j));
        of_first += f;
        forces.set(j, -f);
      }
      forces.set(0, of_first);
      forces.add_to(sums, e);
    }
}

template <class Real>
LOBE_FLATTEN void volume_strains(const SmoothedArrays<Real>& patch, Real* rows) {
  using Lanes = DomainLanes<Pack<Real>>;
  constexpr int width = SmoothedBlock<Real>::width;
  for (Index b = 0; b < patch.block_count; ++b)
    for (int first = 0; first < width; first += Lanes::count) {
      const Lanes e(patch, b, first);
      const Pack<Real> strain = e.V * strain_trace(e.H);
      strain.copy_to(rows + b * width + first);
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
  for (Index b = 0; b < patch.block_count; ++b)
    for (int first = 0; first < SmoothedBlock<Real>::width; first += Lanes::count) {
      Law<T> law = law_of<terms>(patch, b, first);
      const Lanes e(patch, b, first);
      law.terms = terms;
      Vec3<T> gradient = e.first_gradient();
      for (Index j = 0; j < e.vertices; ++j) {
        if (j > 0) gradient = e.gradient(j);
        const Mat3<T> K = law_diagonal_block(law, e.H, gradient);
        entries.set(j, entries_of<part, T>(K) * e.V);
      }
      entries.add_to(sums, e);
    }
}

// Whether a kernel for these terms evaluates the law: what the law does not have gets the modulus 0.
constexpr bool evaluates(const Terms& terms, const Terms& of_law) {
  return terms.neo_hookean == of_law.neo_hookean && terms.fibre >= of_law.fibre &&
         terms.pressure >= of_law.pressure;
}

template <class Real, std::size_t i = 0>
void add_forces(const SmoothedArrays<Real>& patch, PaddedVector<Real>* f) {
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

extern const SmoothedKernels<float> smoothed_single_kernels{add_forces<float>, volume_strains<float>,
                                                            add_stiffness<float>};
extern const SmoothedKernels<double> smoothed_double_kernels{add_forces<double>, volume_strains<double>,
                                                             add_stiffness<double>};

}  // namespace lobe::LOBE_KERNELS
