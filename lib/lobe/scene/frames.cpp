#include "lobe/scene/frames.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/error.h"

namespace lobe {

Frames frames_of(const Time& time) {
  const double count = std::max(1.0, std::round(time.duration / time.frame));
  if (!(time.duration > 0 && time.frame > 0 && count <= std::numeric_limits<int>::max()))
    throw InputError("/time", "needs a duration and a frame above 0, of at most 2147483647 frames");
  return {static_cast<int>(count), time.duration / count};
}

}  // namespace lobe
