#include "lobe/tool/growing_path.h"

#include <utility>

namespace lobe {

GrowingPath::GrowingPath(Rows rows) : recent_(std::move(rows)) { settle(); }

std::size_t GrowingPath::size() const {
  std::size_t size = recent_.size();
  for (const auto& rows : past_) size += rows->size();
  return size;
}

GrowingPath::Rows GrowingPath::all() const {
  Rows all;
  all.reserve(size());
  for (const auto& rows : past_) all.insert(all.end(), rows->begin(), rows->end());
  all.insert(all.end(), recent_.begin(), recent_.end());
  return all;
}

// Rows that are shared never change: the last of them are copied before more follow.
void GrowingPath::reopen() {
  if (!recent_.empty() || past_.empty()) return;
  recent_ = *past_.back();
  past_.pop_back();
}

void GrowingPath::push_back(const PathPoint& row) {
  reopen();
  recent_.push_back(row);
  if (recent_.size() < 2 * few) return;
  const auto kept = recent_.end() - few;
  past_.push_back(std::make_shared<const Rows>(recent_.begin(), kept));
  recent_.erase(recent_.begin(), kept);
}

void GrowingPath::forget_after(double time) {
  while (!empty() && back().time > time + just_before) {
    reopen();
    recent_.pop_back();
  }
}

void GrowingPath::settle() {
  if (recent_.empty()) return;
  past_.push_back(std::make_shared<const Rows>(std::move(recent_)));
  recent_.clear();
}

std::size_t GrowingPath::unshared_bytes() const {
  return past_.size() * sizeof(past_[0]) + recent_.size() * sizeof(PathPoint);
}

}  // namespace lobe
