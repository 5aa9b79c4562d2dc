#include "lobe/tool/growing_path.h"

#include <utility>

#include "lobe/file/row_packer.h"

namespace lobe {
namespace {

io::PoseNumbers numbers_of(const PathPoint& row) {
  const auto& [time, position, orientation, opening] = row;
  return {position[0],    position[1], position[2],    orientation[0], orientation[1],
          orientation[2], time,        orientation[3], opening};
}

PathPoint row_of(const io::PoseNumbers& n) {
  return {n[6], {n[0], n[1], n[2]}, {n[3], n[4], n[5], n[7]}, n[8]};
}

}  // namespace

void GrowingPath::Part::unpack_to(PathPoint* rows) const {
  io::RowPacker packer;
  io::ByteReader in("path", packed);
  for (std::size_t i = 0; i < count; ++i) rows[i] = row_of(packer.get(in));
}

GrowingPath::GrowingPath(Rows rows) {
  if (!rows.empty()) settled_ = std::make_shared<const Rows>(std::move(rows));
}

std::size_t GrowingPath::size() const { return past_rows() + recent().size(); }

const PathPoint& GrowingPath::front() const { return past_.empty() ? recent().front() : *past_.back().first; }

GrowingPath::Rows GrowingPath::all() const {
  Rows all(past_rows());
  past_.visit_backwards([&](const Part& part) {
    part.unpack_to(all.data() + (part.end - part.count));
    return true;
  });
  all.insert(all.end(), recent().begin(), recent().end());
  return all;
}

// Rows that are shared never change: those at hand are copied before more follow or some are forgotten.
void GrowingPath::reopen() {
  if (settled_) recent_ = *std::exchange(settled_, nullptr);
  if (!recent_.empty() || past_.empty()) return;
  recent_.resize(past_.back().count);
  past_.back().unpack_to(recent_.data());
  past_.pop_back();
}

void GrowingPath::pack(std::size_t count) {
  Part part{past_.empty() ? std::make_shared<const PathPoint>(recent_.front()) : past_.back().first,
            past_rows() + count,
            count,
            {}};
  io::RowPacker packer;
  for (std::size_t i = 0; i < count; ++i) packer.put(numbers_of(recent_[i]), part.packed);
  part.packed.shrink_to_fit();
  past_.push_back(std::move(part));
  recent_.erase(recent_.begin(), recent_.begin() + std::ptrdiff_t(count));
}

void GrowingPath::push_back(const PathPoint& row) {
  reopen();
  recent_.push_back(row);
  if (recent_.size() >= most) pack(recent_.size() - few);
}

void GrowingPath::forget_after(double time) {
  while (!empty() && back().time > time + just_before) {
    reopen();
    recent_.pop_back();
    if (recent_.empty()) reopen();
  }
}

// A row is the way to it from the one before, so two stay at hand.
void GrowingPath::settle() {
  constexpr std::size_t kept = 2;
  if (settled_ || recent_.empty()) return;
  if (recent_.size() > kept) pack(recent_.size() - kept);
  recent_.shrink_to_fit();
  settled_ = std::make_shared<const Rows>(std::move(recent_));
  recent_ = {};
}

}  // namespace lobe
