// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/region/smoothed_kernels.h"

#include "lobe/fem/law.h"
#include "lobe/region/compiled_terms.h"
#include "lobe/region/domain_lanes.h"
#include "lobe/region/viscous_lanes.h"

namespace lobe::LOBE_KERNELS {
namespace {

// Adds vectors of the vertices of a block of domains to sums: half a block after the other, vertex by vertex,
// the first at the end, so that the order of the sums, and so their bits, does not depend on the width of
// registers. Registers of half a block add at once; others keep their vectors until the block ends.
template <class T>
class DomainVectors {
 public:
  using Real = typename T::value_type;
  using Vectors = PaddedVectors<T>;
  static constexpr int width = SmoothedBlock<Real>::width, half = width / 2, count = Vectors::count;
  static constexpr bool is_direct = count == half;

  DomainVectors(const SmoothedArrays<Real>& patch, Real* sums) : patch_(patch), sums_(sums) {}

  [[gnu::always_inline]] void add(Index block, Index vertex, int first, const Vec3<T>& vectors) {
    if constexpr (is_direct) {
      alignas(64) Real row[4 * count];
      Vectors::store(vectors, row);
      add_half(numbers(block)[vertex], first, row);
    } else {
      Vectors::store(vectors, kept_[vertex] + 4 * first);
    }
  }
  [[gnu::always_inline]] void end(Index block) {
    if constexpr (!is_direct) {
      const Index vertices = patch_.blocks[block].vertices;
      for (int first = 0; first < width; first += half) {
        for (Index j = 1; j < vertices; ++j) add_half(numbers(block)[j], first, kept_[j] + from(first));
        add_half(numbers(block)[0], first, kept_[0] + from(first));
      }
    }
  }

 private:
  // Where the register of a lane begins in a row.
  static constexpr int from(int lane) { return lane / count * 4 * count; }

  const NumberRow<Real>* numbers(Index block) const {
    return patch_.numbers + patch_.blocks[block].first + block;
  }
  [[gnu::always_inline]] void add_half(const NumberRow<Real>& numbers, int first, const Real* row) const {
    using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;
    const int lane_of_register = first % count;
    unrolled<half>([&](int i) {
      Four sum, vector;
      Real* place = sums_ + 4 * numbers[first + i];
      std::memcpy(&sum, place, sizeof sum);
      std::memcpy(&vector, row + from(i) + Vectors::offset((lane_of_register + i) % count), sizeof vector);
      sum += vector;
      std::memcpy(place, &sum, sizeof sum);
    });
  }

  const SmoothedArrays<Real>& patch_;
  Real* sums_;
  alignas(64) Real kept_[is_direct ? 1 : domain_rows][4 * width];
};

template <class T>
[[gnu::always_inline]] inline Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
[[gnu::always_inline]] inline T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// ∂(W/V)/∂J of the volume term and the guard [Pa], of v = J − 1.
template <class T>
[[gnu::always_inline]] inline T volume_slope(const Law<T>& law, const T& v) {
  T slope = law.kappa * v * abs(v);
  if (law.guard_threshold[0] > 0) {
    const T J = T(1) + v;
    if (any_of(J < law.guard_threshold)) slope += law.guard_modulus * guard(J, law.guard_threshold).slope;
  }
  return slope;
}

// Sets the forces of the tetrahedra of a block on all vertices but the first [N]. With e, p, r from the first
// vertex to the second and to neighbours of the chain, 6 J V = e · (p × r), the derivatives of which are
// cross products, and W = φ V ψ(J). J − 1 is found from the difference to the same product at rest (E, P, R):
// it is 0 there exactly.
template <class T, class Real>
LOBE_FLATTEN [[gnu::noinline]] void find_tet_forces(const SmoothedArrays<Real>& patch, Index b, int first,
                                                    Vec3<T>* f) {
  const SmoothedBlock<Real>& block = patch.blocks[b];
  const auto* numbers = patch.numbers + block.first + b;
  const ChainRow<Real>* rows = patch.chains + block.chain;
  const Real* u = &patch.u->xyz0[0];
  const Law<T> law = patch.law.template as<T>();
  const Vec3<T> origin = PaddedVectors<T>::load(u, &numbers[0][first]);
  const auto at_rest = [&](Index row) __attribute__((always_inline)) {
    return Vec3<T>(T(&rows[row].X[0][first]), T(&rows[row].X[1][first]), T(&rows[row].X[2][first]));
  };
  const auto moved = [&](Index row, const Vec3<T>& X) __attribute__((always_inline)) {
    return Vec3<T>(PaddedVectors<T>::load(u, &numbers[row + 1][first]) - origin + X);
  };
  const Vec3<T> E = at_rest(0), e = moved(0, E);
  Vec3<T> P = at_rest(1), p = moved(1, P), p_turned = cross(e, p), f_e = Vec3<T>::Constant(T(0)), f_p = f_e;
  for (Index i = 2; i < block.places + 2; ++i) {
    const Vec3<T> R = at_rest(i), r = moved(i, R), r_turned = cross(e, r), c = cross(p, r);
    const T six_V(&rows[i].six_V[first]), per_six_V(&rows[i].per_six_V[first]);  // the former times φ
    const T v = (dot(e, c) - dot(E, cross(P, R))) * per_six_V;
    const T slope = volume_slope(law, v) * (six_V * per_six_V * T(Real(-1.0 / 6)));
    f_e += c * slope;
    f[i] = f_p - r_turned * slope;
    f_p = p_turned * slope;
    P = R;
    p = r;
    p_turned = r_turned;
  }
  f[1] = f_e;
  f[block.places + 2] = f_p;
  for (Index j = block.places + 3; j < block.vertices; ++j) f[j] = Vec3<T>::Constant(T(0));
}

// Which stress the domains of a kernel have.
enum class StressOf { small_strain, law, law_and_branches };

// The kernels are flattened (LOBE_FLATTEN): all formulas inline, however often they are used elsewhere. Clang
// does this with what they call themselves, and not with what that calls.
template <class Real, Terms terms, StressOf stress = StressOf::law>
LOBE_FLATTEN void add_forces_of(const SmoothedArrays<Real>& patch, Real* sums,
                                const ViscousArrays<Real>* viscous = nullptr) {
  using T = Pack<Real>;
  using Lanes = DomainLanes<T>;
  DomainVectors<T> forces(patch, sums);
  Vec3<T> of_tets[domain_rows];
  for (Index b = 0; b < patch.block_count; ++b) {
    const bool has_tets = stress != StressOf::small_strain && patch.blocks[b].places > 0;
    for (int first = 0; first < SmoothedBlock<Real>::width; first += Lanes::count) {
      const Law<T> law = law_of_domains<T>(patch, terms, b, first);
      const Lanes e(patch, b, first);
      Mat3<T> minus_VP;
      if constexpr (stress == StressOf::small_strain) {
        minus_VP = linear_stress(law.times(-e.V), e.H);
      } else if constexpr (stress == StressOf::law) {
        minus_VP = law_stress(law.times(-e.V), e.H);
      } else {
        const Mat3<T> S = branch_stress(*viscous, b, first, green_strain(e.H));
        minus_VP = law_stress_beside<T>(law.times(-e.V), e.H, S * -e.V);
      }
      if (has_tets) find_tet_forces<T>(patch, b, first, of_tets);
      Vec3<T> of_first = Vec3<T>::Constant(T(0));
      for (Index j = 1; j < e.vertices; ++j) {
        Vec3<T> f = minus_VP.lazyProduct(e.gradient(j));
        if (has_tets) f += of_tets[j];
        of_first -= f;
        forces.add(b, j, first, f);
      }
      forces.add(b, 0, first, of_first);
    }
    forces.end(b);
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
      const Pack<Real> strain = e.V * pressure_strain(e.H, patch.law.terms.solid);
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
  DomainVectors<T> entries(patch, sums);
  for (Index b = 0; b < patch.block_count; ++b) {
    for (int first = 0; first < SmoothedBlock<Real>::width; first += Lanes::count) {
      const Law<T> law = law_of_domains<T>(patch, terms, b, first);
      const Lanes e(patch, b, first);
      for (Index i = 1; i <= e.vertices; ++i) {
        const Index j = i < e.vertices ? i : 0;
        const Mat3<T> K = law_diagonal_block(law, e.H, j > 0 ? e.gradient(j) : e.first_gradient());
        entries.add(b, j, first, entries_of<part, T>(K) * e.V);
      }
    }
    entries.end(b);
  }
}

// Whether a kernel for these terms evaluates the law: what the law does not have gets the modulus 0.
constexpr bool evaluates(const Terms& terms, const Terms& of_law) {
  return terms.solid == of_law.solid && terms.fibre >= of_law.fibre && terms.pressure >= of_law.pressure;
}

template <class Real>
void add_linear_forces(const SmoothedArrays<Real>& patch, Real* f) {
  constexpr Terms with_fibre{.fibre = true};
  if (patch.law.terms.fibre) return add_forces_of<Real, with_fibre, StressOf::small_strain>(patch, f);
  add_forces_of<Real, Terms{}, StressOf::small_strain>(patch, f);
}

template <class Real, std::size_t i = 0>
void add_forces(const SmoothedArrays<Real>& patch, PaddedVector<Real>* f) {
  if (patch.strain == Strain::small) return add_linear_forces(patch, &f->xyz0[0]);
  if constexpr (i + 1 < smoothed_terms.size())
    if (!evaluates(smoothed_terms[i], patch.law.terms)) return add_forces<Real, i + 1>(patch, f);
  add_forces_of<Real, smoothed_terms[i]>(patch, &f->xyz0[0]);
}

template <class Real, std::size_t i = 1>
void add_stiffness(const SmoothedArrays<Real>& patch, StiffnessPart part, PaddedVector<Real>* K) {
  if constexpr (i + 1 < smoothed_terms.size())
    if (!evaluates(smoothed_terms[i], patch.law.terms)) return add_stiffness<Real, i + 1>(patch, part, K);
  constexpr Terms terms = smoothed_terms[i];
  if (part == StiffnessPart::diagonal)
    return add_stiffness_of<Real, terms, StiffnessPart::diagonal>(patch, &K->xyz0[0]);
  add_stiffness_of<Real, terms, StiffnessPart::off_diagonal>(patch, &K->xyz0[0]);
}

// ---- Of materials with a Prony series

template <class Real, std::size_t i = 0>
void add_viscous_forces(const SmoothedArrays<Real>& patch, const ViscousArrays<Real>& viscous,
                        PaddedVector<Real>* f) {
  constexpr Terms terms = viscous_domain_terms[i];
  if constexpr (i + 1 < viscous_domain_terms.size())
    if (!evaluates(terms, patch.law.terms)) return add_viscous_forces<Real, i + 1>(patch, viscous, f);
  add_forces_of<Real, terms, StressOf::law_and_branches>(patch, &f->xyz0[0], &viscous);
}

template <class Real, StiffnessPart part>
LOBE_FLATTEN void add_viscous_stiffness_of(const SmoothedArrays<Real>& patch,
                                           const ViscousArrays<Real>& viscous, Real* sums) {
  using T = Pack<Real>;
  using Lanes = DomainLanes<T>;
  DomainVectors<T> entries(patch, sums);
  for (Index b = 0; b < patch.block_count; ++b) {
    for (int first = 0; first < SmoothedBlock<Real>::width; first += Lanes::count) {
      const Lanes e(patch, b, first);
      const BranchesAtOnce<T> branches(viscous, b, first);
      for (Index i = 1; i <= e.vertices; ++i) {
        const Index j = i < e.vertices ? i : 0;
        const Mat3<T> K = branches.diagonal_block(e.H, j > 0 ? e.gradient(j) : e.first_gradient());
        entries.add(b, j, first, entries_of<part, T>(K) * e.V);
      }
    }
    entries.end(b);
  }
}

template <class Real>
void add_viscous_stiffness(const SmoothedArrays<Real>& patch, const ViscousArrays<Real>& viscous,
                           StiffnessPart part, PaddedVector<Real>* K) {
  if (part == StiffnessPart::diagonal)
    return add_viscous_stiffness_of<Real, StiffnessPart::diagonal>(patch, viscous, &K->xyz0[0]);
  add_viscous_stiffness_of<Real, StiffnessPart::off_diagonal>(patch, viscous, &K->xyz0[0]);
}

}  // namespace

extern const ViscousDomainKernels<float> viscous_domain_single_kernels{add_viscous_forces<float>,
                                                                       add_viscous_stiffness<float>};
extern const ViscousDomainKernels<double> viscous_domain_double_kernels{add_viscous_forces<double>,
                                                                        add_viscous_stiffness<double>};
extern const SmoothedKernels<float> smoothed_single_kernels{add_forces<float>, find_gradients<float>,
                                                            add_stiffness<float>};
extern const SmoothedKernels<double> smoothed_double_kernels{add_forces<double>, find_gradients<double>,
                                                             add_stiffness<double>};

}  // namespace lobe::LOBE_KERNELS
