// A body of a soft and a stiff part under schemes by which each part could take steps of its own. Plain code
// in double precision, which counts evaluations of tetrahedra. lobe itself takes all steps together.
#pragma once

#include <memory>
#include <vector>

#include "lobe/fem/shape.h"
#include "lobe/mesh/tet_mesh.h"
#include "lobe/time/levels.h"

namespace lobe::bench {

struct PlainTet {
  Eigen::Vector4i corners;
  Shape shape;
  double lambda = 0, mu = 0;  // [Pa]
};

// Free, of St Venant-Kirchhoff tetrahedra. The parts share vertices.
struct PlainBody {
  Mat3X<double> points;      // [m]
  std::vector<double> mass;  // per vertex [kg]
  std::vector<PlainTet> tets;
  double omega = 0;  // ω_max at rest [rad/s]
  std::vector<double>
      squares;  // per vertex: the square of its own frequency times ω_max over the highest [1/s²]
};

struct Solid {
  double young, poisson, density;  // [Pa], [-], [kg/m³]
};
// A block of 2 × 2 × 6 cells of 1 cm with vertices moved at random, whose upper two layers are stiff.
PlainBody two_part_block(const Solid& soft, const Solid& stiff, unsigned seed);

// The levels of a body's tetrahedra. A part that steps alone may have a higher frequency than its vertices
// tell. So the frequency of the tetrahedra of each level is measured, and where 2^l short steps would be
// longer than the shortest step allows, the squares of their vertices are taken to be as much higher.
std::vector<Level> safe_levels(const PlainBody& body, std::vector<double> squares);

struct PlainState {
  Mat3X<double> u, v;  // [m], [m/s]; v is half a step older than u
};

// One large step: v⁺ = keep v + push f/m, u⁺ = u + Δt v⁺, with whatever small steps it is made of.
class Scheme {
 public:
  virtual ~Scheme() = default;
  virtual double large_step() const = 0;  // [s]
  // `share` of the kick that a step begins with, and of its damping γ [1/s]: ½ where v is as old as u. The
  // velocity right after that kick goes to `kicked`. Without `moves` nothing follows the kick.
  virtual void step(const PlainBody& body, double damping, double share, bool moves, PlainState& state,
                    Mat3X<double>& kicked) = 0;
  long long evaluations = 0;  // of tetrahedra
};

// Impulses at each tetrahedron's own pace: one of level l kicks with 2^l Δt in every 2^l-th small step.
std::unique_ptr<Scheme> own_steps(std::vector<Level> levels, double small_step);

// Stabilised leapfrog-Chebyshev: the large step's acceleration is 2 (z(Δt) − u)/Δt², where z'' is that of u
// for the slow tetrahedra and that of z for the fast ones. z is found in p stages by Chebyshev's
// recurrence, with the stabilisation ν in T_p(1 + ν/p²).
std::unique_ptr<Scheme> leapfrog_chebyshev(const PlainBody& body, const std::vector<bool>& is_fast,
                                           double large_step, double safety, double stabilisation);

// The numbers T_0 … T_p at δ = 1 + ν/p², and α, so that T_p(δ − x/α)/T_p(δ) = 1 − x/2 + …
struct StageFactors {
  std::vector<double> T;
  double delta = 1, alpha = 2;
  double longest() const { return alpha * (delta + 1); }  // of (ω Δt)²
};
StageFactors stage_factors(int stages, double stabilisation);
// The fewest stages whose interval has (ω Δt)² within safety².
StageFactors fewest_stages(double omega_dt, double safety, double stabilisation);

double kinetic_energy(const PlainBody& body, const Mat3X<double>& v);  // [J]
double elastic_energy(const PlainBody& body, const Mat3X<double>& u);  // [J]
Vec3d momentum(const PlainBody& body, const Mat3X<double>& v);         // [kg m/s]
Vec3d angular_momentum(const PlainBody& body, const PlainState& state, const Mat3X<double>& v);

}  // namespace lobe::bench
