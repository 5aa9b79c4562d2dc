// How a needle goes through tissue: the points of the tissue that are on it, and what its tip does (theory,
// section 25). Places on a needle are distances behind its tip (setup/needle_shape.h).
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "lobe/setup/embedded_point.h"
#include "lobe/setup/needle_shape.h"

namespace lobe {

// A point of the tissue that is on a needle.
struct NeedleHold {
  enum class Kind : std::uint8_t { entry, inside, exit };
  EmbeddedPoint point;
  Kind kind = Kind::inside;
  double s = 0;  // its place on the needle [m]
  // In the last step: as in NeedleGuide::Point, and the force on the tissue [N].
  int slip = 0;
  Vec3d force = Vec3d::Zero();
  bool is_valid() const {
    return point.is_valid() && std::isfinite(s) && slip >= -1 && slip <= 1 && force.allFinite();
  }
  static constexpr auto fields = std::tuple(&NeedleHold::point, &NeedleHold::kind, &NeedleHold::s,
                                            &NeedleHold::slip, &NeedleHold::force);
};

class NeedlePassage {
 public:
  enum class Tip : std::uint8_t {
    free,     // outside
    pushing,  // on the surface, from outside
    inside,
    leaving  // on the surface, from inside
  };

  // From the end of the needle to its tip, so that s falls. A part of the needle that is in tissue begins at
  // an entry, or at the needle's end, and ends at an exit, or at the tip.
  std::vector<NeedleHold> holds;
  Tip tip = Tip::free;
  // The tissue at the tip, unless it is free.
  EmbeddedPoint at;
  // On the surface: a linear function that is level on it and grows outwards, by its values at the corners.
  Eigen::Vector4d level = Eigen::Vector4d::Zero();
  Vec3d force = Vec3d::Zero();        // on the surface that it touches, in the last step [N]
  std::vector<EmbeddedPoint> passed;  // bites that the needle's end has gone through, in their order

  bool is_in_tissue() const { return !holds.empty() || tip != Tip::free; }
  bool touches() const { return tip == Tip::pushing || tip == Tip::leaving; }
  bool is_valid() const;

  // The length of the needle that is in tissue [m].
  double length_inside(const NeedleShape& shape) const;
  // The part of it that each hold has: half of the way to the next ones, and all of it to the needle's ends.
  // Their sum is length_inside().
  void share_length(const NeedleShape& shape, std::vector<double>& lengths) const;  // one per hold [m]

  // ---- What the tip does

  void touch(const EmbeddedPoint& point, const Eigen::Vector4d& outwards);  // pushes, or is about to leave
  void come_off();  // from the surface that it touches
  void puncture();  // the surface that it touches
  // The tip is at this point of the tissue. Leaves a hold there if the last one is at least `spacing` behind
  // [m], and there are fewer than `most`.
  void go_to(const EmbeddedPoint& point, double spacing, std::size_t most);
  void come_out();  // without having touched the surface

  // ---- After a step, with the new places of the holds

  // Drops holds that the needle's end has passed. Entries and exits among them are bites.
  void pass_end(const NeedleShape& shape);
  // Drops holds that the tip was drawn back from.
  void draw_back();
  // Drops what lost(point) says has gone. What is left of the tissue on the needle begins and ends anew.
  // Returns how many holds went.
  template <class Lost>
  int forget(const Lost& lost);
  // Takes the needle out of the tissue, as if it had never been there.
  void clear();

  static constexpr auto fields =
      std::tuple(&NeedlePassage::holds, &NeedlePassage::tip, &NeedlePassage::at, &NeedlePassage::level,
                 &NeedlePassage::force, &NeedlePassage::passed);

 private:
  bool is_tip_inside() const { return tip == Tip::inside || tip == Tip::leaving; }
  void close_gaps(const std::vector<char>& is_gone, bool tip_is_gone);
};

template <class Lost>
int NeedlePassage::forget(const Lost& lost) {
  std::vector<char> is_gone;
  int count = 0;
  for (const NeedleHold& hold : holds) {
    is_gone.push_back(lost(hold.point));
    count += is_gone.back();
  }
  const bool tip_is_gone = tip != Tip::free && lost(at);
  std::erase_if(passed, lost);
  if (count > 0 || tip_is_gone) close_gaps(is_gone, tip_is_gone);
  return count;
}

// Where a point that moves meets a triangle that moves, both uniformly.
struct NeedleMeeting {
  double share = 0;               // share of the time
  Vec3d weights = Vec3d::Zero();  // barycentric, of the triangle
};
// The tip goes from `from` to `to` [m], the triangle likewise, one column per corner, counter-clockwise seen
// from outside. Meets it if the tip comes from its outer side (`inwards`) or from its inner one. A tip that
// is beyond it by less than `slack` [m] at first and goes on counts as on it.
std::optional<NeedleMeeting> meeting(const Vec3d& from, const Vec3d& to, const Mat3<double>& triangle,
                                     const Mat3<double>& triangle_to, bool inwards, double slack);

}  // namespace lobe
