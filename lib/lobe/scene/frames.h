// How often advance() is called while a scene plays, and for how long each time.
#pragma once

#include "lobe/scene/scene.h"

namespace lobe {

struct Frames {
  int count = 1;
  double length = 0;  // [s]
};

// Divides the whole duration into equal frames. They are as long as the scene asks for, or a little different
// so that their number is whole. Loop over this number. The time of a world is a sum of rounded frames, and
// may stop just short of the duration.
//
//   const lobe::Frames frames = lobe::frames_of(scene.time);
//   for (int i = 0; i < frames.count; ++i) world.advance(frames.length);
Frames frames_of(const Time& time);

}  // namespace lobe
