// A scalpel: it cuts along what its edge sweeps (tool/scalpel.h).
#pragma once

#include <algorithm>

#include "lobe/setup/tool_path.h"

namespace lobe {

inline constexpr double least_snap = 0.02, most_snap = 0.3;

struct ScalpelSetup {
  static constexpr const char* type = "scalpel";
  std::string name;
  double snap = 0.1;            // share of its shortest edge: a vertex that is nearer to the cut lies on it
  std::vector<PathPoint> path;  // positions of the tip
  std::vector<Vec3d> heels;     // other end of the cutting edge in each row of the path [m]
  bool along_faces = false;     // whether it opens faces that the mesh has, and divides no tetrahedron
  void check(const Expect& expect) const {
    check_path(*this, expect);
    expect(heels.size() == path.size(), type_and_name(*this) + " needs a heel in each row of its path");
    expect(snap >= least_snap && snap <= most_snap, type_and_name(*this) + ": snap must be in [0.02, 0.3]");
    for (std::size_t i = 0; i < std::min(heels.size(), path.size()); ++i)
      expect(heels[i].allFinite() && heels[i] != path[i].position,
             type_and_name(*this) + ": row " + std::to_string(i) +
                 " has a blade without length, or one that is not finite");
  }
  static constexpr auto fields =
      std::tuple(&ScalpelSetup::snap, &ScalpelSetup::path, &ScalpelSetup::heels, &ScalpelSetup::along_faces);
};

}  // namespace lobe
