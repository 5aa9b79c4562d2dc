#include "lobe/setup/tool_setups.h"

#include <algorithm>
#include <cmath>

namespace lobe {
namespace {

template <class ToolSetup>
std::string called(const ToolSetup& tool) {
  return std::string(ToolSetup::type) + " \"" + tool.name + "\"";
}

template <class ToolSetup>
void check_path(const ToolSetup& tool, const Expect& expect) {
  expect(!tool.path.empty(), called(tool) + " has no path");
  expect(is_path(tool.path),
         called(tool) +
             ": the times of its path must increase, all its values be finite, quaternions of length 1");
}

}  // namespace

bool is_path(const std::vector<PathPoint>& path) {
  for (std::size_t i = 0; i < path.size(); ++i)
    if (!std::isfinite(path[i].time) || !path[i].position.allFinite() || !std::isfinite(path[i].opening) ||
        path[i].opening < 0 || !(std::abs(path[i].orientation.norm() - 1) < 1e-6) ||
        (i > 0 && !(path[i].time > path[i - 1].time)))
      return false;
  return true;
}

void GraspSetup::check(const Expect& expect) const {
  check_path(*this, expect);
  expect(std::all_of(vertices.begin(), vertices.end(), [](Index v) { return v >= 0; }),
         called(*this) + " names a vertex below 0");
  expect(shares.empty() || shares.size() == vertices.size(),
         called(*this) + " needs a share for each vertex, or none");
  expect(std::all_of(shares.begin(), shares.end(), [](double share) { return share > 0 && share <= 1; }),
         called(*this) + " has a share that is not above 0 and up to 1");
}

bool GraspSetup::any_partly() const {
  return std::any_of(shares.begin(), shares.end(), [](double share) { return share < 1; });
}

void CauterySetup::check(const Expect& expect) const {
  check_path(*this, expect);
  expect(std::isfinite(radius) && radius > 0, called(*this) + " needs a radius above 0");
  expect(hook.allFinite(), called(*this) + " needs a finite hook");
  expect(core >= 0 && core < radius, called(*this) + " needs a core of at least 0 m that is thinner than it");
}

void ScalpelSetup::check(const Expect& expect) const {
  check_path(*this, expect);
  expect(heels.size() == path.size(), called(*this) + " needs a heel in each row of its path");
  expect(snap >= least_snap && snap <= most_snap, called(*this) + ": snap must be in [0.02, 0.3]");
  for (std::size_t i = 0; i < std::min(heels.size(), path.size()); ++i)
    expect(heels[i].allFinite() && heels[i] != path[i].position,
           called(*this) + ": row " + std::to_string(i) +
               " has a blade without length, or one that is not finite");
}

void ProbeSetup::check(const Expect& expect) const {
  check_path(*this, expect);
  shape.check(expect, called(*this));
  expect(std::isfinite(friction) && friction >= 0,
         called(*this) + " needs a friction of at least 0, and finite");
}

void ClipApplierSetup::check(const Expect& expect) const {
  check_path(*this, expect);
  const std::string fault = clip.fault();
  expect(fault.empty(), called(*this) + " " + fault);
}

}  // namespace lobe
