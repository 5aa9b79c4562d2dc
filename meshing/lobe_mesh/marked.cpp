// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <algorithm>

#include "lobe/error.h"
#include "lobe/io/surface_io.h"
#include "lobe_mesh/diagnose.h"

namespace lobe::meshing {
namespace {

// One number per triangle: 1 if the finding concerns it, else 0.
std::vector<int> marks_of(const Finding& finding, const Surface& surface) {
  std::vector<int> marks(surface.triangle_count(), 0);
  for (const Index t : finding.triangles) marks[t] = 1;
  std::vector<bool> bad(surface.point_count(), false);
  for (const Index v : finding.points) bad[v] = true;
  for (Index t = 0; t < surface.triangle_count(); ++t) {
    for (const Index v : surface.triangles.col(t)) marks[t] |= bad[v];
  }
  return marks;
}

}  // namespace

void write_marked(const std::filesystem::path& file, const Surface& surface, const Diagnosis& diagnosis) {
  std::vector<DataArray> arrays;
  Eigen::MatrixXd faults = Eigen::MatrixXd::Zero(1, surface.triangle_count());
  for (const Finding* finding : diagnosis.findings()) {
    if (finding->count == 0) continue;
    const std::vector<int> marks = marks_of(*finding, surface);
    const Eigen::MatrixXd row =
        Eigen::Map<const Eigen::RowVectorXi>(marks.data(), surface.triangle_count()).cast<double>();
    faults += row;
    arrays.push_back({finding->name, row, DataArray::Type::int32});
  }
  arrays.push_back({"faults", faults, DataArray::Type::int32});
  write_surface(file, surface.points, surface.triangles, arrays);
}

}  // namespace lobe::meshing
