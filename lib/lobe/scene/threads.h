// Threads of a scene, and their keys (docs/scene/boundary.md).
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "lobe/scene/key_rows.h"
#include "lobe/scene/selector.h"
#include "lobe/setup/setup.h"

namespace lobe {

struct Resolution;

// A length of thread that is drawn through points of the body at rest, and its knots.
struct SceneTie {
  double at = 0;                                     // [s]
  double tighten = 0;                                // length by which the loop is drawn together [m]
  double over = 0.2;                                 // time that this takes [s]
  std::optional<std::array<Index, 2>> between = {};  // points of the stitch, from 0; none: first and last
};
struct SceneStitch {
  std::vector<Vec3d> through;  // [m]
  double at = 0;               // time at which it is sewn [s]
  std::vector<SceneTie> ties;
};
struct SceneThread {
  std::string name = "thread";
  ThreadMaterial material;
  std::vector<SceneStitch> stitches;
  std::string pointer;

  static constexpr const char* key = "threads";
  static constexpr const char* sentence = "threads with which the body is sewn";
  static void resolve(const std::vector<SceneThread>& all, Resolution& resolution);
  template <class Json>
  Json summary(const Setup& setup, std::size_t number) const;
  template <class Json>
  static void print(const Json& summary, std::ostream& out);
  static void for_each_selector(auto&, const auto&) {}
  void for_each_point(const auto& visit) {
    for (SceneStitch& stitch : stitches)
      for (Vec3d& point : stitch.through) visit(point);
  }
};

namespace keys {

template <>
inline constexpr auto table_of<SceneTie> = Table(
    "tie", "",

    Key("at", &SceneTie::at, at_least(0).in("s").required(), "when it is tied"),
    Key("tighten", &SceneTie::tighten, at_least(0).in("m"), "length by which the loop is drawn together"),
    Key("over", &SceneTie::over, at_least(0).in("s"), "time in which it is drawn together"),
    Key("between", &SceneTie::between, any.optional(),
        "two points of the stitch, numbered from 0, that the knot joins; without it, the first and the "
        "last"));

template <>
inline constexpr auto table_of<SceneStitch> =
    Table("stitch", "",
          Key("through", &SceneStitch::through, any.in("m").items(2).required(),
              "two points of the body at rest or more, through which the thread passes in this order"),
          Key("at", &SceneStitch::at, at_least(0).in("s"),
              "when it is sewn: at the start of the first frame that begins then"),
          Key("tie", &SceneStitch::ties, any.or_one(), "a knot, or several"));

template <>
inline constexpr auto table_of<SceneThread> =
    Table("thread", "", Key("name", &SceneThread::name, any, "for reports"),
          Key("stiffness", In{&SceneThread::material, &ThreadMaterial::stiffness}, above(0).in("N"),
              "EA: tension per strain"),
          Key("friction", In{&SceneThread::material, &ThreadMaterial::friction}, at_least(0),
              "μ of the capstan law T₂ = T₁ e^(μθ), where the thread passes through tissue"),
          Key("strength", In{&SceneThread::material, &ThreadMaterial::strength}, above(0).in("N").optional(),
              "tension above which the thread breaks; without it, it does not"),
          Key("holds", In{&SceneThread::material, &ThreadMaterial::holds}, above(0).in("N").optional(),
              "force that tissue bears at a bite; without it, any. Above it the thread cuts into the tissue; "
              "at the surface it tears out"),
          Key("stitches", &SceneThread::stitches, any.items(1).required(), "lengths of this thread"));

}  // namespace keys
}  // namespace lobe
