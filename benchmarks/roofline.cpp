#include "benchmarks/roofline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "benchmarks/timing.h"
#include "lobe/fem/shape.h"
#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"

namespace lobe::bench {
namespace {

// A number that counts what is done with it.
struct Counted {
  Counted(double v = 0) : value(v) {}
  double value;
  inline static long operations = 0;
  Counted& operator+=(Counted b) { return *this = *this + b; }
  Counted& operator-=(Counted b) { return *this = *this - b; }
  Counted& operator*=(Counted b) { return *this = *this * b; }
  friend Counted operator+(Counted a, Counted b) { return ++operations, Counted(a.value + b.value); }
  friend Counted operator-(Counted a, Counted b) { return ++operations, Counted(a.value - b.value); }
  friend Counted operator*(Counted a, Counted b) { return ++operations, Counted(a.value * b.value); }
  friend Counted operator-(Counted a) { return Counted(-a.value); }
  friend Counted abs(Counted a) { return Counted(std::abs(a.value)); }
};

}  // namespace
}  // namespace lobe::bench

namespace Eigen {
template <>
struct NumTraits<lobe::bench::Counted> : GenericNumTraits<lobe::bench::Counted> {
  using Real = lobe::bench::Counted;
  using NonInteger = Real;
  using Literal = Real;
  using Nested = Real;
};
}  // namespace Eigen

namespace lobe::bench {
namespace {

constexpr int sums_at_corners = 12;

double flops_of_element(bool volume_term) {
  Mat34<Counted> u;
  Mat3<Counted> alpha;
  u.setConstant(1);
  alpha.setConstant(1);
  Counted::operations = 0;
  const Mat3<Counted> H = displacement_gradient(u, alpha);
  Mat3<Counted> P = svk_stress<Counted>(H, 1, 1);
  if (volume_term) P += volume_stress<Counted>(H, 1);
  corner_forces<Counted>(P, alpha);
  return double(Counted::operations) + sums_at_corners;
}

template <class Body>
double least_seconds(Body&& body) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 10; ++i) {
    const Stopwatch watch(true);
    body();
    least = std::min(least, watch.seconds());
  }
  return least;
}

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__)
#define LOBE_WIDEST [[gnu::target_clones("avx512f", "avx2", "default")]]
#else
#define LOBE_WIDEST
#endif

// Sums of independent lanes, as many as the caches' and the adders' latencies ask for.
LOBE_WIDEST double sum_of(const float* values, std::size_t count) {
  constexpr int lanes = 128;
  float sums[lanes] = {};
  for (std::size_t i = 0; i < count; i += lanes)
    for (int lane = 0; lane < lanes; ++lane) sums[lane] += values[i + lane];
  double sum = 0;
  for (float s : sums) sum += double(s);
  return sum;
}

// Four chains of each, which is what the latency of an operation asks for.
constexpr int rounds = 1000000, chains = 4;

template <class Real>
[[gnu::always_inline]] inline double multiply_and_add(Real factor, Real term) {
  using Register [[gnu::vector_size(64)]] = Real;
  Register a[chains] = {}, b[chains] = {};
  for (int round = 0; round < rounds; ++round)
    for (int i = 0; i < chains; ++i) {
      a[i] *= factor;
      b[i] += term;
    }
  double sum = 0;
  for (int i = 0; i < chains; ++i) sum += double(a[i][0] + b[i][0]);
  return sum;
}
LOBE_WIDEST double multiply_and_add_of(float factor, float term) { return multiply_and_add(factor, term); }
LOBE_WIDEST double multiply_and_add_of(double factor, double term) { return multiply_and_add(factor, term); }

}  // namespace

double flops_svk() { return flops_of_element(false); }
double flops_svk_volume() { return flops_of_element(true); }

double flops_tensor_mass_edge() {
  Vec3<Counted> d;
  Mat3<Counted> K;
  d.setConstant(1);
  K.setConstant(1);
  Counted::operations = 0;
  Eigen::Matrix<Counted, 3, 2> forces;
  const Vec3<Counted> difference = d - d;
  forces << K.lazyProduct(difference), K.transpose().lazyProduct(difference);
  return double(Counted::operations + forces.size());  // which are added at the ends
}

double stream_bytes_per_second() {
  const std::vector<float> values((64u << 20) / sizeof(float), 1.0f);
  [[maybe_unused]] volatile double sum = 0;
  return double(values.size() * sizeof(float)) /
         least_seconds([&] { sum = sum_of(values.data(), values.size()); });
}

template <class Real>
double peak_flops_per_second() {
  volatile Real factor = Real(0.999), term = Real(0.001);
  [[maybe_unused]] volatile double sum = 0;
  return 2.0 * rounds * chains * double(64 / sizeof(Real)) /
         least_seconds([&] { sum = multiply_and_add_of(factor, term); });
}
template double peak_flops_per_second<float>();
template double peak_flops_per_second<double>();

}  // namespace lobe::bench
