// What happens to a body at one moment and place, for people and for programs that react to it: with a sound,
// a light, a mark.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>

#include "lobe/types.h"

namespace lobe {

struct Event {
  enum class Kind : std::uint8_t {
    torn,       // tissue, or what attaches it, gave way under a force; size: the area that came apart [m²]
    broken,     // a thread broke; size: the tension at which it did [N]
    burnt,      // a cautery burnt tissue, which smokes; size: its volume at rest [m³]
    clipped,    // a clip has closed; size: how far apart its legs found the tissue's faces [m]
    bleeding,   // a body that carries blood is open where it is fed; size: the area of its open faces [m²]
    leak,       // a body that carries bile is open where it is fed; size as for bleeding
    punctured,  // a needle's tip went through the surface into tissue; size: its force along it [N]
    exited,     // a needle's tip came out of tissue; size as for punctured, 0 where it was open already
    drawn_out   // the end of a thread was drawn out of a bite, by a needle; size: none
  };
  Kind kind = Kind::torn;
  double time = 0;                  // [s]
  std::optional<Vec3d> place = {};  // place [m]; none: it is not known
  double size = 0;                  // size in the unit of the kind; 0: it has none
  std::string text = {};            // one line for people; empty: it only goes on
  bool is_valid() const {
    return std::isfinite(time) && (!place || place->allFinite()) && std::isfinite(size) && size >= 0;
  }
  static constexpr auto fields =
      std::tuple(&Event::kind, &Event::time, &Event::place, &Event::size, &Event::text);
};
inline constexpr const char* event_names[] = {"torn", "broken",    "burnt",  "clipped",  "bleeding",
                                              "leak", "punctured", "exited", "drawn_out"};
inline const char* name(Event::Kind kind) { return event_names[int(kind)]; }

}  // namespace lobe
