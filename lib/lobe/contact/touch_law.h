// The law of a tool that touches at a point (tool_contact.h), for numbers and for packs of them alike.
#pragma once

#include "lobe/contact/distance_formulas.h"

namespace lobe {

struct TouchLaw {
  double deepest = 0;   // as of ContactLaw [m]
  double damping = 0;   // δ [s]
  double friction = 0;  // μ
  double opens = 0;     // of jaws [m/s]
  bool has_jaws = false;
  bool is_unit = true;  // the length of ∇φ is 1

  // p [Pa] by the stiffness κ [Pa/m], the depth d, what is held h and the speed of approach [m/s].
  template <class T>
  T pressure(double stiffness, const T& depth, const T& held, const T& approach) const {
    const T sum = depth + held;
    const T bounded = pick(is_less(sum, T(0)), T(0), pick(is_less(T(deepest), sum), T(deepest), sum));
    const T elastic = T(stiffness) * bounded;
    if (damping == 0) return elastic;
    const T damped = elastic + T(damping * stiffness) * approach;
    return pick(is_less(T(0), damped), damped, T(0));
  }

  // ξ: the tangential part of the way from the anchor, which follows where friction cannot hold it [m].
  template <class T>
  Vec3<T> slip(double stiffness, const Vec3<T>& way, const Vec3<T>& gradient, const T& pressure) const {
    using std::sqrt;
    const T along = is_unit ? dot(gradient, way) : T(dot(gradient, way) / dot(gradient, gradient));
    const Vec3<T> slip = way - gradient * along;
    const T square = T(stiffness * stiffness / 4) * dot(slip, slip), most = T(friction) * pressure;
    const auto slides = is_less(T(most * most), square);
    return slip * pick(slides, T(most / sqrt(pick(slides, square, T(1)))), T(1));
  }
};

}  // namespace lobe
