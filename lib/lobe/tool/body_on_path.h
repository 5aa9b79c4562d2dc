// A tool that is a rigid body, on its path.
#pragma once

#include <vector>

#include "lobe/tool/growing_path.h"
#include "lobe/tool/tool_body.h"

namespace lobe {

// Adds the body with the rows of the path that matter between two times, unless it is nowhere then.
inline void append_body(ToolBody body, const GrowingPath& path, double from, double to,
                        std::vector<ToolBody>& bodies) {
  if (path.empty() || path.front().time > to - just_before || body.goes < from) return;
  const std::vector<PathPoint>& rows = path.recent();
  auto first = after(rows, from), last = after(rows, to);
  if (first != rows.begin()) --first;
  if (last != rows.end()) ++last;
  body.appears = path.front().time;
  body.path = {first, last};
  bodies.push_back(body);
}

}  // namespace lobe
