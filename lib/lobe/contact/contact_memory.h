// What contact remembers from step to step: an anchor of each point of a triangle that touches, and at what
// depths contact is held.
#pragma once

#include <utility>

#include "lobe/contact/held_depths.h"

namespace lobe {

struct Anchor {
  Index tet = -1;
  std::uint32_t code = 0;    // FaceOwner of the triangle
  int divisions = 1;         // parts of each of its edges: it has divisions² points
  int number = 0;            // number of the point
  Vec3d at = Vec3d::Zero();  // place of the anchor of friction [m]
  Index face_tet = -1;       // FaceOwner of the face that it has come through, where a body touches itself
  std::uint32_t face_code = 0;
  Index in = -1;  // the tetrahedron behind that triangle

  bool is_valid() const { return at.allFinite(); }
  static constexpr auto fields = std::tuple(&Anchor::tet, &Anchor::code, &Anchor::divisions, &Anchor::number,
                                            &Anchor::at, &Anchor::face_tet, &Anchor::face_code, &Anchor::in);
};

struct Remembered {
  std::vector<Anchor> anchors;  // anchors by triangle of the surface, and by point of each
  std::vector<HeldDepths::OfTriangle> held;
  static constexpr auto fields = std::tuple(&Remembered::anchors, &Remembered::held);
};

// Finds those of points that are asked for in their order.
class AnchorReader {
 public:
  explicit AnchorReader(const std::vector<Anchor>& anchors) : all_(anchors) {}

  // Null: the point has none.
  const Anchor* find(const FaceOwner& triangle, int divisions, int number) {
    while (next_ < all_.size() && is_before(all_[next_], triangle, divisions, number)) ++next_;
    if (next_ == all_.size()) return nullptr;
    const Anchor& own = all_[next_];
    const bool is_it = own.tet == triangle.tet && own.code == triangle.code && own.divisions == divisions &&
                       own.number == number;
    return is_it ? &own : nullptr;
  }

 private:
  static bool is_before(const Anchor& own, const FaceOwner& triangle, int divisions, int number) {
    if (own.tet != triangle.tet) return own.tet < triangle.tet;
    if (own.code != triangle.code) return own.code < triangle.code;
    if (own.divisions != divisions) return own.divisions < divisions;
    return own.number < number;
  }

  const std::vector<Anchor>& all_;
  std::size_t next_ = 0;
};

// Each evaluation of forces finds what a step would leave behind: begin_forces(), add() for each point that
// touches, held().add() and held().end(). It holds from end_step() on.
class ContactMemory {
 public:
  AnchorReader anchors() const { return AnchorReader(anchors_); }
  const std::vector<Anchor>& all_anchors() const { return anchors_; }
  HeldDepths& held() { return held_; }
  const HeldDepths& held() const { return held_; }

  void begin_forces() {
    next_.clear();
    held_.begin();
  }
  void add(const Anchor& anchor) { next_.push_back(anchor); }
  Anchor& add() { return next_.emplace_back(); }
  void end_step() {
    anchors_.swap(next_);
    held_.end_step();
  }

  Remembered remembered() const { return {anchors_, held_.kept()}; }
  void set(const Remembered& own) {
    anchors_ = own.anchors;
    held_.set(own.held);
  }
  void keep() { kept_ = remembered(); }  // when steps begin
  void take_back() { set(kept_); }

 private:
  std::vector<Anchor> anchors_, next_;  // anchors now, and after the step that is under way
  HeldDepths held_;
  Remembered kept_;
};

}  // namespace lobe
