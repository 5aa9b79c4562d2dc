#include "lobe/haptic/contact_stiffness.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace lobe {
namespace {

constexpr double loose_share = 0.01;  // of the bound: below, nothing holds the patch

}  // namespace

ContactStiffness::ContactStiffness(const Settings& settings) : settings_(settings) {
  if (settings.has_helper) helper_ = std::thread([this] { help(); });
}

ContactStiffness::~ContactStiffness() {
  if (!helper_.joinable()) return;
  work_.wait(Work::wanted);
  work_ = Work::end;
  work_.notify_all();
  helper_.join();
}

void ContactStiffness::help() {
  for (Work work = work_; work != Work::end; work = work_) {
    if (work == Work::wanted) {
      condensed_ = patch_.condense();
      work_.store(Work::done, std::memory_order_release);
      work_.notify_all();
    } else {
      work_.wait(work);
    }
  }
}

void ContactStiffness::forget() {
  has_patch_ = has_last_ = false;
  is_outdated_ = true;  // what the helper may be at
  K_ = of_patch_ = ways_ = changes_ = Mat3<double>::Zero();
  rate_.setZero();
  way_.setZero();
}

void ContactStiffness::take_result() {
  if (work_.load(std::memory_order_acquire) != Work::done) return;
  work_.store(Work::none, std::memory_order_relaxed);
  if (std::exchange(is_outdated_, false)) return;
  of_patch_ = condensed_;
  is_bound_ = false;
}

// Until the first patch is condensed what is known is the bound. After a cut it is the patch before, since a
// cut makes none stiffer.
void ContactStiffness::gather(const Model& model, std::span<const Index> contact,
                              const std::function<Vec3d(Index)>& displacement, double duration) {
  const auto around = model.elements.topology.around(contact.front());
  const double speed = around.empty() ? 0 : shear_speed(model.elements, around.front());
  patch_.gather(model, contact, displacement, {.reach = speed * duration});
  const Mat3<double> blocked = patch_.blocked();
  highest_ = highest_eigenvalue(blocked);
  const bool is_other = std::exchange(is_cut_, false) || !has_patch_;
  if (is_other) {
    of_patch_ = has_patch_ && !is_bound_ ? clamped(of_patch_, highest_) : blocked;
    ways_.setZero();
    changes_.setZero();
  }
  is_bound_ = is_bound_ || !has_patch_;
  has_patch_ = true;
  since_patch_ = 0;
  is_outdated_ = false;
  if (!settings_.has_helper) {
    of_patch_ = patch_.condense();
    is_bound_ = false;
    return;
  }
  work_.store(Work::wanted, std::memory_order_release);
  work_.notify_all();
}

void ContactStiffness::learn(const Vec3d& way, const Vec3d& force_change, double duration) {
  const double square = way.squaredNorm(), noise = settings_.noise * settings_.noise;
  const double kept = std::exp(-duration / settings_.memory * square / (square + noise));
  ways_ = kept * ways_ + way * way.transpose();
  changes_ = kept * changes_ - force_change * way.transpose();
}

// The least squares of the header, with a little weight on the share of the patch that is expected: without
// motion that is what is known.
Mat3<double> ContactStiffness::fitted(double expected_share) const {
  const double noise = settings_.noise * settings_.noise;
  const double least = 1e-2 * noise * of_patch_.squaredNorm() / 3;
  const double known = (of_patch_ * ways_ * of_patch_).trace() + least;
  if (known == 0) return expected_share * of_patch_;
  const double says = (of_patch_ * changes_).trace() + expected_share * least;
  const double scale = std::clamp(says / known, settings_.softest, settings_.stiffest);
  const double weight = settings_.prior * ways_.trace() / 3 + noise;
  const Mat3<double> both = ways_ + weight * Mat3<double>::Identity();
  const Mat3<double> K = (changes_ + weight * scale * of_patch_) * both.inverse();
  return 0.5 * (K + K.transpose());
}

void ContactStiffness::gather_if_due(const Model& model, std::span<const Index> contact,
                                     const std::function<Vec3d(Index)>& displacement, double duration) {
  take_result();
  since_patch_ += duration;
  const bool is_due =
      !has_patch_ || is_cut_ || contact.size() != contact_size_ || since_patch_ >= settings_.every;
  if (!is_due || work_.load(std::memory_order_acquire) != Work::none) return;
  contact_size_ = contact.size();
  gather(model, contact, displacement, duration);
}

// What a cut takes away at once is no trend: in its frame the force has no rate and says nothing of K. Nor in
// the next one, as the mean force of the frame of the cut is neither that before it nor that after it.
void ContactStiffness::notice_cut(const Model& model) {
  ++since_cut_;
  if (std::exchange(structure_, model.revisions.structure) == model.revisions.structure) return;
  if (!has_patch_ || !patch_.is_cut(model.elements.topology)) return;
  is_cut_ = true;
  since_cut_ = 0;
  has_last_ = false;
}

void ContactStiffness::before_touch(const Model& model, std::span<const Index> contact,
                                    const std::function<Vec3d(Index)>& displacement, double duration,
                                    const ExpectedStiffness& expected) {
  notice_cut(model);
  gather_if_due(model, contact, displacement, duration);
  ways_.setZero();
  changes_.setZero();
  K_ = clamped(std::max(settings_.softest, expected.share_of(of_patch_)) * of_patch_, highest_);
  rate_.setZero();
  way_.setZero();
  has_last_ = false;
}

void ContactStiffness::begin_at(const Vec3d& position) {
  last_position_ = position;
  last_force_.setZero();
  has_last_ = true;
}

void ContactStiffness::after_frame(const Model& model, std::span<const Index> contact,
                                   const std::function<Vec3d(Index)>& displacement, const Vec3d& position,
                                   const Vec3d& force, double duration, const ExpectedStiffness& expected) {
  if (contact.empty()) {
    take_result();
    return forget();
  }
  notice_cut(model);
  gather_if_due(model, contact, displacement, duration);
  const Vec3d way = position - last_position_, force_change = force - last_force_;
  if (has_last_) learn(way, force_change, duration);
  const Mat3<double> fit = fitted(std::max(settings_.softest, expected.share_of(of_patch_)));
  K_ = is_bound_ ? clamped(fit, highest_) : clamped_to(fit, of_patch_, settings_.softest, settings_.stiffest);
  way_ = has_last_ ? way : Vec3d(Vec3d::Zero());
  duration_ = duration;
  is_loose_ = !is_bound_ && highest_eigenvalue(of_patch_) < loose_share * highest_;
  rate_ = has_last_ ? Vec3d((force_change + K_ * way) / duration) : Vec3d(Vec3d::Zero());
  last_position_ = position;
  last_force_ = force;
  has_last_ = since_cut_ > 0;
}

Vec3d ContactStiffness::rate_of_push(const Vec3d& normal) const {
  const double along = normal.dot(K_ * normal) * normal.dot(way_);
  return rate_ - (K_ * way_ - along * normal) / duration_;
}

}  // namespace lobe
