#include "lobe/io/vtk_cells.h"

#include "lobe/error.h"
#include "lobe/io/numeric.h"
#include "lobe/text.h"

namespace lobe::io {
namespace {

constexpr double vtk_tetra = 10;

[[noreturn]] void fail(const std::string& place, std::size_t cell, const std::string& message) {
  throw InputError(place + ": cell " + std::to_string(cell), message);
}

void add_tetrahedron(const VtkCells& cells, std::size_t cell, std::size_t begin, const std::string& place,
                     RawMesh& raw) {
  const auto vertices = static_cast<std::int64_t>(raw.coordinates.size() / 3);
  for (std::size_t k = begin; k < begin + 4; ++k) {
    const auto vertex = whole_number(cells.connectivity[k], 0, vertices - 1);
    if (!vertex)
      fail(place, cell,
           "names vertex " + exact(cells.connectivity[k]) + ", expected 0 … " + std::to_string(vertices - 1));
    raw.corners.push_back(static_cast<Index>(*vertex));
  }
}

}  // namespace

std::vector<std::size_t> add_tetrahedra(const VtkCells& cells, const std::string& place, RawMesh& raw) {
  if (cells.ends.size() != cells.types.size())
    throw InputError(place, std::to_string(cells.types.size()) + " cell types for " +
                                std::to_string(cells.ends.size()) + " cells; expected one per cell");
  std::vector<std::size_t> tets;
  std::int64_t begin = 0;
  for (std::size_t cell = 0; cell < cells.ends.size(); ++cell) {
    const auto end =
        whole_number(cells.ends[cell], begin, static_cast<std::int64_t>(cells.connectivity.size()));
    if (!end)
      fail(place, cell,
           "its offset is " + exact(cells.ends[cell]) + ", expected " + std::to_string(begin) + " … " +
               std::to_string(cells.connectivity.size()) + "; offsets must increase");
    if (cells.types[cell] != vtk_tetra) {
      ++raw.ignored_cells;
    } else if (*end - begin != 4) {
      fail(place, cell, "is a tetrahedron of " + std::to_string(*end - begin) + " vertices, expected 4");
    } else {
      add_tetrahedron(cells, cell, static_cast<std::size_t>(begin), place, raw);
      tets.push_back(cell);
    }
    begin = *end;
  }
  return tets;
}

std::vector<int> labels_of(const std::vector<double>& values, const std::vector<std::size_t>& tets,
                           const std::string& place) {
  std::vector<int> labels;
  labels.reserve(tets.size());
  for (const std::size_t cell : tets) {
    const auto label = whole_number(values[cell], -max_index, max_index);
    if (!label)
      fail(place, cell, "its label is " + exact(values[cell]) + ", expected a whole number below 2^31");
    labels.push_back(static_cast<int>(*label));
  }
  return labels;
}

}  // namespace lobe::io
