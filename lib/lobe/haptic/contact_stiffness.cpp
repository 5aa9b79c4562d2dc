#include "lobe/haptic/contact_stiffness.h"

#include <utility>

namespace lobe {

Mat3<double> secant_correction(const Mat3<double>& K, const Vec3d& way, const Vec3d& force_change,
                               double noise) {
  const double square = way.squaredNorm();
  if (square == 0) return Mat3<double>::Zero();
  const Vec3d rest = -force_change - K * way;
  const Mat3<double> whole = (rest * way.transpose() + way * rest.transpose()) / square -
                             rest.dot(way) / (square * square) * way * way.transpose();
  return square / (square + noise * noise) * whole;
}

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
  K_ = of_patch_ = correction_ = Mat3<double>::Zero();
}

void ContactStiffness::take_result() {
  if (work_.load(std::memory_order_acquire) != Work::done) return;
  work_.store(Work::none, std::memory_order_relaxed);
  if (std::exchange(is_outdated_, false)) return;
  of_patch_ = condensed_;
  if (std::exchange(is_bound_, false)) correction_.setZero();  // which was of the bound
}

// Until the first patch is condensed what is known is the bound.
void ContactStiffness::gather(const Model& model, std::span<const Index> contact,
                              const std::function<Vec3d(Index)>& displacement, double duration) {
  const auto around = model.elements.topology.around(contact.front());
  const double speed = around.empty() ? 0 : shear_speed(model.elements, around.front());
  patch_.gather(model, contact, displacement, {.reach = speed * duration});
  const Mat3<double> blocked = patch_.blocked();
  highest_ = highest_eigenvalue(blocked);
  const bool is_other = !has_patch_ || structure_ != model.revisions.structure;
  if (is_other) of_patch_ = blocked;
  if (is_other) correction_.setZero();
  is_bound_ = is_bound_ || is_other;
  structure_ = model.revisions.structure;
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

void ContactStiffness::after_frame(const Model& model, std::span<const Index> contact,
                                   const std::function<Vec3d(Index)>& displacement, const Vec3d& position,
                                   const Vec3d& force, double duration) {
  take_result();
  since_patch_ += duration;
  if (contact.empty()) return forget();
  const bool is_due = !has_patch_ || structure_ != model.revisions.structure ||
                      contact.size() != contact_size_ || since_patch_ >= settings_.every;
  if (is_due && work_.load(std::memory_order_acquire) == Work::none) {
    contact_size_ = contact.size();
    gather(model, contact, displacement, duration);
  }
  if (has_last_)
    correction_ += secant_correction(of_patch_ + correction_, position - last_position_, force - last_force_,
                                     settings_.noise);
  K_ = is_bound_ ? clamped(of_patch_ + correction_, highest_)
                 : clamped_to(of_patch_ + correction_, of_patch_, settings_.softest, settings_.stiffest);
  correction_ = K_ - of_patch_;
  last_position_ = position;
  last_force_ = force;
  has_last_ = true;
}

}  // namespace lobe
