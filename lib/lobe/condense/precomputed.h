// The pre-computed region (theory, section 14) is linear and condensed to its interface. A step multiplies a
// dense matrix with the displacements u_B of the interface,
//   f_B = −S u_B + (loads of the interior, condensed),
// whatever the number of tetrahedra. The interior is in equilibrium and follows the interface; its
// displacements are computed only on request. Cuts, tetrahedra that enter or leave, and grasped vertices keep
// all of it exact (condensation.h). With a frame, u_B are the displacements from the rigid motion that fits
// the interface best, and every held vertex belongs to the interface.
#pragma once

#include <future>
#include <memory>

#include "lobe/condense/condensed_region.h"
#include "lobe/condense/rigid_frame.h"
#include "lobe/numerics/symmetric_product.h"
#include "lobe/region/smoothed_edges.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

template <class Real>
class PrecomputedRegion {
 public:
  explicit PrecomputedRegion(CondensingLog log = CondensingLog(), SparseFactorMaker make_factor = make_ldlt,
                             InstructionSet set = chosen_instruction_set())
      : log_(std::move(log)), make_factor_(std::move(make_factor)), stiffness_(set) {}

  // Follows an edit of the mesh or the regions. `edit.vertices` also names vertices that were grasped or
  // released.
  // - Loads on components of the interior are taken out of the two arrays (3 × #vertices [N]): they act
  //   through the interface.
  // - Returns tetrahedra that have become a mechanism and must leave the region.
  // - Throws InputError if the region cannot be condensed. This happens only if tetrahedra enter it.
  // - While the region is expanded it follows lazily: it is outdated until it is relinearised.
  // - If edits have become inexact, the region is condensed at once. This waits for what another thread
  //   condenses.
  std::vector<Index> follow(const Elements& elements, const HeldVertices& held, const RegionEdit& edit,
                            Mat3X<Real>& external, Mat3X<Real>& dead);
  bool is_outdated() const { return is_outdated_; }
  // While it is expanded it has no part in the motion: its tetrahedra are non-linear (expanded.h).
  void set_expanded(bool is_expanded) { is_expanded_ = is_expanded; }
  bool is_expanded() const { return is_expanded_; }
  // Throws InputError if the region of these elements would have too large an interface.
  static void refuse_large(const Elements& elements, const HeldVertices& held);

  // Each edit makes the next ones cost more, until the region is condensed from scratch. Another thread does
  // this, from a copy of the present region. Edits go on meanwhile, and are repeated on the result.
  bool needs_condensing() const {
    return tet_count_ > 0 && !is_condensing() && condensed_->touched() > most_touched_;
  }
  bool is_condensing() const { return recondensed_.valid(); }
  void begin_condensing(const Elements& elements) { begin_condensing(elements, linearisation_); }
  // Begins to condense the region linearised about these displacements: 3 × #vertices [m].
  void begin_relinearising(const Elements& elements, const Mat3X<double>& about) {
    begin_condensing(elements, Linearisation{about});
  }
  // Waits for the other thread and uses its result. Condensing from scratch changes nothing but rounding.
  // False if there is no result, because the tangent at the new state is not positive definite, or the region
  // followed lazily meanwhile. Nothing changes then.
  bool end_condensing(const Elements& elements);

  bool has_changed() const { return has_changed_; }  // the last edit that was followed changed it
  // The displacements about which it is linearised, 3 × #vertices [m]; none: rest.
  const Mat3X<double>& about() const { return linearisation_.about; }
  const std::vector<Index>& shared() const { return shared_; }  // vertices of other regions as well
  // The displacement error of the interior because it has no inertia, √Σ m |u|² [√kg m], at this mean
  // acceleration of the interface [m/s²]. The masses are those of find_carried().
  double inertia_error(const Vec3d& acceleration) const;

  const CondensingLog& condensing() const { return log_; }  // log of the start
  Index tet_count() const { return tet_count_; }
  bool has(Index tet) const { return tet < static_cast<Index>(member_.size()) && member_[tet]; }
  Index interface_size() const { return static_cast<Index>(components_.size()); }  // components
  bool is_interior(Index vertex) const {
    return vertex < static_cast<Index>(roles_.cols()) && (roles_.col(vertex).array() == Role::interior).any();
  }

  // Finds carried(): the mass of the interior that a vertex of the interface carries [kg]. All together carry
  // as much as it takes to move the interface as a whole (theory, section 14). Call it after an edit, and
  // when end_condensing() has used a result.
  void find_carried(const Elements& elements);
  double carried(Index vertex) const {
    const bool is_known = !is_expanded_ && tet_count_ > 0 && vertex < static_cast<Index>(carried_.size());
    return is_known ? carried_[std::size_t(vertex)] : 0;
  }
  // After masses and loads of these vertices were computed from tetrahedra: moves masses of the interior to
  // the interface, and takes over its loads. Returns those of the vertices that belong to the region. Masses
  // are per vertex [kg], loads 3 × #vertices [N].
  std::vector<Index> take_over(const Elements& elements, const std::vector<Index>& vertices,
                               std::vector<double>& mass, Mat3X<Real>& external, Mat3X<Real>& dead) const;

  void add_forces(const Mat3X<Real>& u,  // 3 × #vertices [m]
                  Real missing_share,    // share of the dead loads that does not act yet
                  Mat3X<Real>& f,        // 3 × #vertices [N]
                  Parallel& parallel);
  void add_stiffness_forces(const Mat3X<Real>& u, Mat3X<Real>& f,
                            Parallel& parallel);  // forces without loads, about the state at rest
  void add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K) const;

  // Computes displacements of the interior, and velocities if v is not null, from those of the interface.
  // Each costs a solution with the factor. Changes nothing while the region is expanded.
  void recover(const Elements& elements, Real missing_share, Mat3X<Real>& u, Mat3X<Real>* v) const;

  // Energies at recovered displacements:
  struct Energy {
    double elastic = 0, loads = 0;  // [J]; `loads`: energy of the loads that were taken over
  };
  Energy energy(const Elements& elements, const Mat3X<Real>& u) const;
  // The force of the region's tetrahedra on the fixed components of a vertex, 0 for other components [N].
  // add_forces() leaves it out.
  Vec3d force_on_fixed(const Elements& elements, const Mat3X<Real>& u, Index vertex) const;

 private:
  using Loads = std::array<Mat3X<double>, 2>;  // all loads; and the negative of the dead ones
  using Pose = RigidFrame::Pose;

  // The number of amplitudes a. Without a frame there is one for all loads and one for the missing dead
  // loads. With a frame each has nine: R_lk is the share along k in the frame of what acts along l in space.
  Eigen::Index amplitudes() const { return has_frame_ ? 18 : 2; }
  using Amplitudes = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 18>;
  Amplitudes amplitudes(Real missing_share, const Mat3<double>& R) const;
  Eigen::RowVectorXd load_row(const Loads& loads, Index component) const;
  void place(const Mat3X<Real>& u, Pose& pose) const;
  void add_forces_in_frame(const Mat3X<Real>& u, Real missing_share, Mat3X<Real>& f, Parallel& parallel);
  Vec3d torque_of_loads(const Amplitudes& a, Real missing_share) const;
  void recover_in_frame(const Elements& elements, Real missing_share, Mat3X<Real>& u, Mat3X<Real>* v) const;
  void prepare_frame(const Elements& elements);
  void open(const std::vector<Index>& components);
  void grow(const Elements& elements, const RegionEdit& edit);
  // Smoothing domains that an edit has changed: as they were before, and the numbers of all that are new,
  // have changed or are gone.
  struct DomainChange {
    std::vector<SmoothedEdge> before;
    std::vector<Index> changed;
  };
  std::vector<Index> concerned(const RegionEdit& edit, const DomainChange& domains) const;
  void change_members(const Elements& elements, const RegionEdit& edit);
  void begin_condensing(const Elements& elements, Linearisation linearisation);
  void extend(Linearisation& linearisation, const RegionEdit& edit) const;
  void add(const Linearisation& linearisation, const Elements& elements, Index tet, double sign,
           const std::vector<Index>& row, CondensedRegion::Change& sum) const;
  void change(const Elements& elements, const RegionEdit& edit, const DomainChange& domains,
              const std::vector<Index>& components, Mat3X<Real>& external, Mat3X<Real>& dead);
  void take_loads(const std::vector<Index>& vertices, Mat3X<Real>& external, Mat3X<Real>& dead);
  std::vector<Index> close(const Elements& elements, const std::vector<Index>& components);
  void keep_exact(const Elements& elements, const std::vector<Index>& edited);
  std::vector<Index> interface() const;
  Eigen::MatrixXd loads() const;
  void take(std::unique_ptr<CondensedRegion> condensed);
  void build(const Elements& elements);
  void prepare_step(const Elements& elements);

  CondensingLog log_;
  SparseFactorMaker make_factor_;

  std::vector<std::uint8_t> member_;  // one flag per tetrahedron
  Index tet_count_ = 0;
  Tets corners_;                // corners of the members when they were last followed
  std::vector<double> shares_;  // shares of their volumes at that time
  SmoothedEdges domains_;
  Roles roles_;  // 3 × #vertices
  Loads loads_;  // loads on the interior, 3 × #vertices [N]
  bool is_expanded_ = false;
  bool has_changed_ = false;
  bool is_outdated_ = false, recondensed_is_outdated_ = false;
  Linearisation linearisation_;
  std::unique_ptr<CondensedRegion> condensed_;
  Index most_touched_ = 0;  // number of touched components beyond which it should be condensed anew
  Index edited_ = 0;        // components edited since its error was last measured
  std::future<std::unique_ptr<CondensedRegion>> recondensed_;
  Linearisation recondensed_linearisation_;

  // What a step reads.
  std::vector<Index> components_;  // components of the interface: 3 × vertex + axis
  std::vector<Index> vertices_;    // vertices of the interface, in the order of their components
  std::vector<Index> shared_;      // vertices of other regions as well
  std::vector<double> carried_;    // carried mass, per vertex [kg]
  SymmetricProduct<Real> stiffness_;
  Eigen::MatrixXd of_loads_;  // force of each amplitude [N], #components × #amplitudes

  bool has_frame_ = false;
  RigidFrame frame_;         // frame of vertices_
  Mat3X<double> rest_;       // their positions [m]
  Eigen::VectorXd at_rest_;  // work of each amplitude's load on the interior's arms at rest [N m]
  Pose pose_;                // scratch
  Mat3X<double> forces_;
  bool has_loads_ = false;  // whether loads act on the interior
};

}  // namespace lobe
