#include "lobe/setup/clip_setup.h"

#include <algorithm>
#include <cmath>

namespace lobe {

std::string ClipShape::fault() const {
  for (const double size : {length, opening, gap, width, stiffness})
    if (!(size > 0) || !std::isfinite(size))
      return "needs a length, an opening, a gap, a width and a stiffness above 0, and finite";
  return gap < opening ? "" : "needs a gap that is smaller than its opening";
}

void ClipSetup::check(const Expect& expect) const {
  const std::string whose = "clip \"" + name + "\" ", fault = shape.fault();
  expect(fault.empty(), whose + fault);
  expect(std::isfinite(since), whose + "was closed at no time");
  expect(!pairs.empty() && std::all_of(pairs.begin(), pairs.end(),
                                       [](const Pair& pair) {
                                         return pair.from.is_valid() && pair.to.is_valid() &&
                                                std::isfinite(pair.apart) && pair.apart > 0;
                                       }),
         whose + "needs pairs of points of the tissue, some way apart");
}

void ClipSetup::check_all(const std::vector<ClipSetup>& all, const Body& body, const Expect& expect) {
  const auto is_there = [&](Index tet) { return is_tet(tet, body); };
  for (const ClipSetup& clip : all) {
    clip.check(expect);
    expect(std::all_of(clip.pairs.begin(), clip.pairs.end(),
                       [&](const Pair& pair) { return is_there(pair.from.tet) && is_there(pair.to.tet); }) &&
               std::all_of(clip.squeezed.begin(), clip.squeezed.end(), is_there),
           "clip \"" + clip.name + "\" names a tetrahedron that there is not");
  }
}

}  // namespace lobe
