#include "lobe/forces/needle_passage.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace lobe {

bool NeedlePassage::is_valid() const {
  bool valid = (tip == Tip::free || at.is_valid()) && level.allFinite() && force.allFinite();
  for (const NeedleHold& hold : holds) valid = valid && hold.is_valid();
  for (const EmbeddedPoint& bite : passed) valid = valid && bite.is_valid();
  return valid && (is_tip_inside() || holds.empty() || holds.back().kind == NeedleHold::Kind::exit) &&
         (!is_tip_inside() || (!holds.empty() && holds.back().kind != NeedleHold::Kind::exit));
}

// ---- Lengths

void NeedlePassage::share_length(const NeedleShape& shape, std::vector<double>& lengths) const {
  const double length = shape.length();
  lengths.assign(holds.size(), 0);
  const auto place = [&](std::size_t i) { return std::clamp(holds[i].s, 0.0, length); };
  for (std::size_t i = 0; i < holds.size(); ++i) {
    const bool is_first = i == 0 || holds[i - 1].kind == NeedleHold::Kind::exit;
    const bool is_last = holds[i].kind == NeedleHold::Kind::exit;
    if (is_first && holds[i].kind != NeedleHold::Kind::entry) lengths[i] += length - place(i);
    if (is_last) continue;
    if (i + 1 == holds.size()) {
      lengths[i] += place(i);
      continue;
    }
    const double half = std::max(0.0, place(i) - place(i + 1)) / 2;
    lengths[i] += half;
    lengths[i + 1] += half;
  }
}

double NeedlePassage::length_inside(const NeedleShape& shape) const {
  std::vector<double> lengths;
  share_length(shape, lengths);
  double sum = 0;
  for (const double own : lengths) sum += own;
  return sum;
}

// ---- The tip

void NeedlePassage::touch(const EmbeddedPoint& point, const Eigen::Vector4d& outwards) {
  tip = tip == Tip::inside ? Tip::leaving : Tip::pushing;
  at = point;
  level = outwards;
  force.setZero();
}

void NeedlePassage::come_off() {
  tip = tip == Tip::leaving ? Tip::inside : Tip::free;
  force.setZero();
}

void NeedlePassage::puncture() {
  if (!touches()) return;
  const bool enters = tip == Tip::pushing;
  holds.push_back({at, enters ? NeedleHold::Kind::entry : NeedleHold::Kind::exit});
  holds.back().force = force;
  force.setZero();
  tip = enters ? Tip::inside : Tip::free;
}

void NeedlePassage::go_to(const EmbeddedPoint& point, double spacing, std::size_t most) {
  at = point;
  if (holds.size() < most && holds.back().s >= spacing) holds.push_back({point, NeedleHold::Kind::inside});
}

void NeedlePassage::come_out() {
  holds.push_back({at, NeedleHold::Kind::exit});
  tip = Tip::free;
}

void NeedlePassage::clear() {
  holds.clear();
  passed.clear();
  tip = Tip::free;
  force.setZero();
}

// ---- After a step

// A hold that has passed stands before all others.
void NeedlePassage::pass_end(const NeedleShape& shape) {
  std::size_t count = 0;
  while (count < holds.size() && holds[count].s > shape.length()) ++count;
  if (count == holds.size() && is_tip_inside()) --count;  // the tip has not gone further than the end
  for (std::size_t i = 0; i < count; ++i)
    if (holds[i].kind != NeedleHold::Kind::inside) passed.push_back(holds[i].point);
  holds.erase(holds.begin(), holds.begin() + std::ptrdiff_t(count));
}

// A tip that touches the surface comes off it first.
void NeedlePassage::draw_back() {
  while (!holds.empty() && holds.back().s < 0 && !touches()) {
    const NeedleHold last = holds.back();
    holds.pop_back();
    if (last.kind == NeedleHold::Kind::exit) {
      tip = Tip::inside;
      at = last.point;
      if (holds.empty()) tip = Tip::free;  // all that was before it has gone
    } else if (last.kind == NeedleHold::Kind::entry || holds.empty()) {
      tip = Tip::free;
    } else {
      at = last.point;
    }
  }
}

// Each part of the needle that was in tissue begins at the first of its holds that are left, and ends at the
// last, where its own have gone.
void NeedlePassage::close_gaps(const std::vector<char>& is_gone, bool tip_is_gone) {
  std::vector<NeedleHold> left;
  for (std::size_t begin = 0; begin < holds.size();) {
    std::size_t end = begin;
    while (end < holds.size() && holds[end].kind != NeedleHold::Kind::exit) ++end;
    const bool has_exit = end < holds.size();
    if (has_exit) ++end;
    const std::size_t first = left.size();
    for (std::size_t i = begin; i < end; ++i)
      if (!is_gone[i]) left.push_back(holds[i]);
    const bool ends_at_tip = !has_exit && is_tip_inside() && !tip_is_gone;
    if (left.size() > first) {
      if (is_gone[begin]) left[first].kind = NeedleHold::Kind::entry;
      const std::size_t count = left.size() - first;
      if (!ends_at_tip && left.back().kind != NeedleHold::Kind::exit) {
        if (count > 1)
          left.back().kind = NeedleHold::Kind::exit;
        else
          left.pop_back();  // a point alone holds nothing
      }
    } else if (ends_at_tip) {
      left.push_back({at, NeedleHold::Kind::entry});
    }
    begin = end;
  }
  holds = std::move(left);
  if (tip_is_gone) {
    tip = Tip::free;
    force.setZero();
  }
}

// ---- Where the tip meets the surface

std::optional<NeedleMeeting> meeting(const Vec3d& from, const Vec3d& to, const Mat3<double>& triangle,
                                     const Mat3<double>& triangle_to, bool inwards, double slack) {
  const double sign = inwards ? 1 : -1;
  // How far the tip is before the triangle's plane.
  const auto before = [&](const Vec3d& tip, const Mat3<double>& at) {
    const Vec3d normal = (at.col(1) - at.col(0)).cross(at.col(2) - at.col(0)).normalized();
    return sign * normal.dot(tip - at.col(0));
  };
  const double at_first = before(from, triangle), at_last = before(to, triangle_to);
  if (!(at_first >= -slack && at_last < 0 && at_last < at_first)) return {};
  NeedleMeeting found;
  found.share = std::clamp(at_first / (at_first - at_last), 0.0, 1.0);
  const Vec3d tip = from + found.share * (to - from);
  const Mat3<double> at = triangle + found.share * (triangle_to - triangle);
  const Vec3d normal = (at.col(1) - at.col(0)).cross(at.col(2) - at.col(0));
  for (int i = 0; i < 3; ++i) {
    const Vec3d a = at.col((i + 1) % 3), b = at.col((i + 2) % 3);
    found.weights[i] = (b - a).cross(tip - a).dot(normal) / normal.squaredNorm();
  }
  constexpr double rounding = 1e-6;  // what goes between two triangles meets one of them at least
  if (!(found.weights.minCoeff() >= -rounding)) return {};
  found.weights = found.weights.cwiseMax(0);
  found.weights /= found.weights.sum();
  return found;
}

}  // namespace lobe
