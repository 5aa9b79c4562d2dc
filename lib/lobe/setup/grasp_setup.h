// A grasp: it holds vertices, and moves them along a path (tool/grasp.h).
#pragma once

#include <algorithm>

#include "lobe/setup/tool_path.h"

namespace lobe {

struct GraspSetup {
  static constexpr const char* type = "grasp";
  std::string name;
  // Vertices of the mesh, or copies that earlier cuts make. Those that do not exist when it takes hold are
  // left out.
  std::vector<Index> vertices;
  std::vector<PathPoint> path;  // offsets
  bool release = false;
  // Held share of each vertex, above 0 and up to 1 (PartlyHeldVertex); none: all wholly.
  std::vector<double> shares = {};
  bool any_partly() const {
    return std::any_of(shares.begin(), shares.end(), [](double share) { return share < 1; });
  }
  void check(const Expect& expect) const {
    check_path(*this, expect);
    expect(std::all_of(vertices.begin(), vertices.end(), [](Index v) { return v >= 0; }),
           type_and_name(*this) + " names a vertex below 0");
    expect(shares.empty() || shares.size() == vertices.size(),
           type_and_name(*this) + " needs a share for each vertex, or none");
    expect(std::all_of(shares.begin(), shares.end(), [](double share) { return share > 0 && share <= 1; }),
           type_and_name(*this) + " has a share that is not above 0 and up to 1");
  }
  static constexpr auto fields =
      std::tuple(&GraspSetup::vertices, &GraspSetup::path, &GraspSetup::release, &GraspSetup::shares);
};

}  // namespace lobe
