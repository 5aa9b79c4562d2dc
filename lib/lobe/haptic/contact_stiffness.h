// Finds the stiffness K of the local model, and the rate r at which its force changes. Frames in which the
// tool moved by d and its force changed by Δf say what K is where the tool went. The stiffness of the contact
// patch, K_p, says how that compares with other directions. K is where
//
//   Σ |K d + Δf|² + ω |K − s K_p|²,   s where Σ |s K_p d + Δf|² is least,
//
// is least, made symmetric. The sums forget: what is older counts less the further the tool has moved since.
// ω is a share of Σ |d|²/3. So one direction that is known scales the whole patch. This takes account of
// everything outside of the contact patch. What K does not explain of the last change is inertia and damping,
//   r = (Δf + K d)/duration.
// A cut of the patch begins all of this anew.
#pragma once

#include <atomic>
#include <limits>
#include <thread>

#include "lobe/haptic/contact_patch.h"

namespace lobe {

// K before any motion has said how stiff the contact is: a share of the patch, but no more than `most`
// along `normal`, and no less than the softest share.
struct ExpectedStiffness {
  double share = 1, most = std::numeric_limits<double>::infinity();  // [-], [N/m]
  Vec3d normal = Vec3d::UnitZ();

  double share_of(const Mat3<double>& patch) const {
    const double along = normal.dot(patch * normal);
    return share * along > most ? most / along : share;
  }
};

class ContactStiffness {
 public:
  struct Settings {
    double every = 0.025;  // time between two patches [s]
    double noise = 5e-5;   // shorter moves of the tool in a frame hardly count [m]
    double memory = 0.3;   // time constant with which older frames lose weight, while the tool moves [s]
    double prior = 0.1;    // weight ω of the patch, as a share of Σ |d|²/3
    // Bounds of K in each direction, over the stiffness of the patch [-]. A patch is too stiff, by up to 4 in
    // what was tried. Without bounds, a body that oscillates would look soft or hard.
    double softest = 0.1, stiffest = 1.25;
    bool has_helper = true;  // a thread condenses the patch; false: at once, for the same bits each time
  };

  explicit ContactStiffness(const Settings& settings);
  ~ContactStiffness();
  ContactStiffness(const ContactStiffness&) = delete;
  ContactStiffness& operator=(const ContactStiffness&) = delete;

  void forget();  // begins anew, for another contact
  // Call it after a frame of `duration` in which a tool felt nothing, but is about to touch `contact`: K
  // becomes what is expected.
  void before_touch(const Model& model, std::span<const Index> contact,
                    const std::function<Vec3d(Index)>& displacement, double duration,
                    const ExpectedStiffness& expected);
  // Call it where the tool feels nothing yet: the next frame says how stiff the contact is.
  void begin_at(const Vec3d& position);
  // Call it after a frame of `duration` in which a tool that touches `contact` was at `position` and felt the
  // mean force `force`. It makes a new contact patch if one is due, or if the patch was cut or the contact
  // has changed.
  void after_frame(const Model& model, std::span<const Index> contact,
                   const std::function<Vec3d(Index)>& displacement, const Vec3d& position, const Vec3d& force,
                   double duration, const ExpectedStiffness& expected = {});
  // The stiffness K [N/m], symmetric, without negative eigenvalues. In each direction it lies between
  // `softest` and `stiffest` times that of the condensed patch. Until the first patch is condensed, no
  // eigenvalue is above the highest of ContactPatch::blocked().
  const Mat3<double>& K() const { return K_; }
  // r of a tool that holds [N/s]. 0 on a loose piece: that swings, and is felt by its inertia.
  Vec3d rate() const { return is_loose_ ? Vec3d(Vec3d::Zero()) : rate_; }
  // r of a tool that only pushes, where the motion and the stiffness count along the normal alone [N/s].
  Vec3d rate_of_push(const Vec3d& normal) const;

 private:
  enum class Work : std::uint8_t { none, wanted, done, end };

  void gather(const Model& model, std::span<const Index> contact,
              const std::function<Vec3d(Index)>& displacement, double duration);
  void gather_if_due(const Model& model, std::span<const Index> contact,
                     const std::function<Vec3d(Index)>& displacement, double duration);
  void take_result();
  void notice_cut(const Model& model);
  void learn(const Vec3d& way, const Vec3d& force_change, double duration);
  Mat3<double> fitted(double expected_share) const;
  void help();

  const Settings settings_;
  ContactPatch patch_;                             // patch; the helper's while work is wanted
  Mat3<double> condensed_ = Mat3<double>::Zero();  // its result
  Mat3<double> K_ = Mat3<double>::Zero(), of_patch_ = Mat3<double>::Zero();
  Mat3<double> ways_ = Mat3<double>::Zero(), changes_ = Mat3<double>::Zero();  // Σ d dᵀ, −Σ Δf dᵀ
  Vec3d rate_ = Vec3d::Zero();
  Vec3d way_ = Vec3d::Zero();  // way of the tool from the frame before to the last one [m]
  double duration_ = 1;        // duration of that frame [s]
  double highest_ = 0, since_patch_ = 0;
  std::uint64_t structure_ = 0;
  std::uint64_t since_cut_ = 1;  // frames since a cut
  std::size_t contact_size_ = 0;
  bool has_patch_ = false, has_last_ = false, is_outdated_ = false;
  bool is_loose_ = false;  // whether the tool touches a loose piece
  bool is_cut_ = false;    // whether the patch was cut since it was gathered
  bool is_bound_ = false;  // whether of_patch_ is a bound, until there is a result
  Vec3d last_position_ = Vec3d::Zero(), last_force_ = Vec3d::Zero();
  std::atomic<Work> work_ = Work::none;
  std::thread helper_;
};

}  // namespace lobe
