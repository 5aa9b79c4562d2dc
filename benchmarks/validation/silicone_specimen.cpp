#include "benchmarks/validation/silicone_specimen.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace lobe::validation::silicone {
namespace {

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream text(line);
  for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
  return fields;
}

}  // namespace

std::map<std::string, double> measured(const std::string& file, const std::string& column) {
  std::ifstream table(LOBE_MEASUREMENTS "/" + file);
  std::map<std::string, double> found;
  std::string line;
  std::getline(table, line);
  const std::vector<std::string> names = fields_of(line);
  const auto at = std::size_t(std::find(names.begin(), names.end(), column) - names.begin());
  while (std::getline(table, line)) {
    const std::vector<std::string> fields = fields_of(line);
    if (at < fields.size()) found[fields[0]] = std::stod(fields[at]);
  }
  if (found.size() != 4) throw std::runtime_error("data/measurements/" + file + " has not its four cases");
  return found;
}

Vec3d at_marker(const TetMesh& mesh, const Mat3X<double>& u) {
  Index below = -1, above = -1;
  const auto z = [&](Index v) { return mesh.points(2, v); };
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (std::abs(mesh.points(0, v) - length) > 1e-9 || mesh.points(1, v) > 1e-9) continue;
    if (z(v) <= marker_height && (below < 0 || z(v) > z(below))) below = v;
    if (z(v) > marker_height && (above < 0 || z(v) < z(above))) above = v;
  }
  const double part = (marker_height - z(below)) / (z(above) - z(below));
  return (1 - part) * u.col(below) + part * u.col(above);
}

}  // namespace lobe::validation::silicone
