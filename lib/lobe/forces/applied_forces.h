// External forces on vertices, and springs from vertices to moving points, set while a world runs (SetForces,
// SetSprings, MoveSprings of sim/command.h).
//   f = f_v + k (p − x_v),  W = −f_v · u_v + k |p − x_v|²/2
#pragma once

#include "lobe/forces/force_term.h"
#include "lobe/setup/setup.h"

namespace lobe {

struct Spring {
  Index vertex = 0;
  double stiffness = 0;         // k [N/m], > 0
  Vec3d point = Vec3d::Zero();  // p [m]
  bool operator==(const Spring&) const = default;
  static constexpr auto fields = std::tuple(&Spring::vertex, &Spring::stiffness, &Spring::point);
};

template <class Real>
class AppliedForces : public ForceTerm<Real> {
 public:
  using At = typename ForceTerm<Real>::At;

  // Replaces all forces, or all springs. Throws InputError for a vertex that does not exist and for values
  // that are not finite.
  void set(const std::vector<VertexLoad>& forces, Index vertices);
  void set(const std::vector<Spring>& springs, Index vertices);
  // Sets where the points are at the end of the next frame, 3 × #springs [m]. They move there at constant
  // speed.
  void move(const Mat3X<double>& points);
  const std::vector<VertexLoad>& forces() const { return forces_; }

  static constexpr const char* term_name = "applied forces";
  std::string name() const override { return term_name; }
  void add_forces(const At& at, Mat3X<Real>& f) override;
  void add_diagonal_stiffness(const At& at, DiagonalStiffness& K) override;
  double energy(const At& at) override;
  std::vector<Index> acts_on(const Model& model) const override;
  void begin_frame(double time, double duration) override;
  void follow(const Topology& topology, const MeshEdit& edit) override;
  std::string save() const override;
  void load(const std::string& saved, Index vertices) override;

 private:
  // The point of a spring at a time in this frame [m].
  Vec3d point_at(std::size_t spring, double time) const;

  std::vector<VertexLoad> forces_;
  std::vector<Spring> springs_;      // points at the start of the frame
  Mat3X<double> moves_;              // moves of the points in this frame, 3 × #springs [m]; none: they rest
  Mat3X<double> targets_;            // targets of the next frame [m]; none: they stay
  double begin_ = 0, duration_ = 0;  // times of the frame [s]
};

extern template class AppliedForces<float>;
extern template class AppliedForces<double>;

}  // namespace lobe
