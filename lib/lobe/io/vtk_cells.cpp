#include "lobe/io/vtk_cells.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "lobe/error.h"
#include "lobe/io/numeric.h"
#include "lobe/text.h"

namespace lobe::io {
namespace {

constexpr double vtk_triangle = 5, vtk_tetra = 10, vtk_quadratic_triangle = 22, vtk_quadratic_tetra = 24;

// Names of VTK's cell types.
std::string kind_of(double type) {
  static const std::map<double, std::string> kinds = {{1, "vertex"},
                                                      {2, "set of vertices"},
                                                      {3, "line"},
                                                      {4, "polyline"},
                                                      {5, "triangle"},
                                                      {6, "triangle strip"},
                                                      {7, "polygon"},
                                                      {8, "pixel"},
                                                      {9, "quadrangle"},
                                                      {11, "voxel"},
                                                      {12, "hexahedron"},
                                                      {13, "wedge"},
                                                      {14, "pyramid"},
                                                      {21, "three-node line"},
                                                      {22, "six-node triangle"},
                                                      {25, "twenty-node hexahedron"},
                                                      {42, "polyhedron"},
                                                      {71, "tetrahedron of higher order"}};
  const auto known = kinds.find(type);
  return known == kinds.end() ? "cell of type " + exact(type) : known->second;
}

[[noreturn]] void fail(const std::string& place, std::size_t cell, const std::string& message) {
  throw InputError(place + ": cell " + std::to_string(cell), message);
}

std::vector<Index> vertices_of(const VtkCells& cells, std::size_t cell, std::size_t begin, std::size_t count,
                               const std::string& place, const RawMesh& raw) {
  const auto vertices = static_cast<std::int64_t>(raw.coordinates.size() / 3);
  std::vector<Index> found;
  for (std::size_t k = begin; k < begin + count; ++k) {
    const auto vertex = whole_number(cells.connectivity[k], 0, vertices - 1);
    if (!vertex)
      fail(place, cell,
           "names vertex " + exact(cells.connectivity[k]) + ", expected 0 … " + std::to_string(vertices - 1));
    found.push_back(static_cast<Index>(*vertex));
  }
  return found;
}

// Calls visit(cell, begin, end) for each cell, with its place in the connectivity.
template <class Visit>
void for_each_cell(const VtkCells& cells, const std::string& place, const Visit& visit) {
  if (cells.ends.size() != cells.types.size())
    throw InputError(place, std::to_string(cells.types.size()) + " cell types for " +
                                std::to_string(cells.ends.size()) + " cells; expected one per cell");
  std::int64_t begin = 0;
  for (std::size_t cell = 0; cell < cells.ends.size(); ++cell) {
    const auto end =
        whole_number(cells.ends[cell], begin, static_cast<std::int64_t>(cells.connectivity.size()));
    if (!end)
      fail(place, cell,
           "its offset is " + exact(cells.ends[cell]) + ", expected " + std::to_string(begin) + " … " +
               std::to_string(cells.connectivity.size()) + "; offsets must increase");
    visit(cell, begin, *end);
    begin = *end;
  }
}

void add_strip(const std::vector<std::int64_t>& strip, Polygons& polygons) {
  for (std::size_t k = 0; k + 2 < strip.size(); ++k) {
    const std::size_t odd = k % 2;
    polygons.corners.push_back({strip[k], strip[k + 1 + odd], strip[k + 2 - odd]});
  }
}

}  // namespace

void add_points(const std::vector<double>& coordinates, Polygons& polygons) {
  for (std::size_t i = 0; i + 2 < coordinates.size(); i += 3)
    polygons.points.emplace_back(coordinates[i], coordinates[i + 1], coordinates[i + 2]);
}

void add_polygons(const VtkCells& cells, const std::string& place, Polygons& polygons) {
  constexpr double triangle = 5, strip = 6, polygon = 7, pixel = 8, quadrangle = 9, six_node_triangle = 22;
  for_each_cell(cells, place, [&](std::size_t cell, std::int64_t begin, std::int64_t end) {
    const double type = cells.types[cell];
    if (type != triangle && type != strip && type != polygon && type != pixel && type != quadrangle &&
        type != six_node_triangle)
      return;
    std::vector<std::int64_t> corners;
    for (std::int64_t k = begin; k < end; ++k) {
      const auto vertex = whole_number(cells.connectivity[std::size_t(k)], 0, max_index);
      if (!vertex) fail(place, cell, "names a vertex that is not a whole number from 0");
      corners.push_back(*vertex);
    }
    if (type == strip) return add_strip(corners, polygons);
    if (type == pixel && corners.size() == 4) std::swap(corners[2], corners[3]);
    if (type == six_node_triangle && corners.size() == 6) corners.resize(3);
    polygons.corners.push_back(std::move(corners));
  });
}

TakenCells take_cells(const VtkCells& cells, const std::string& place, RawMesh& raw) {
  TakenCells taken;
  for_each_cell(cells, place, [&](std::size_t cell, std::int64_t begin, std::int64_t end) {
    const double type = cells.types[cell];
    if ((type == vtk_triangle && end - begin == 3) || (type == vtk_quadratic_triangle && end - begin == 6)) {
      taken.triangles.push_back(cell);
      taken.begins.push_back(std::size_t(begin));
      return;
    }
    const std::int64_t nodes = type == vtk_tetra ? 4 : type == vtk_quadratic_tetra ? 10 : 0;
    if (nodes == 0) {
      ++raw.ignored[kind_of(type)];
      return;
    }
    if (end - begin != nodes)
      fail(place, cell,
           "is a tetrahedron of " + std::to_string(end - begin) + " vertices, expected " +
               std::to_string(nodes));
    const std::vector<Index> vertices =
        vertices_of(cells, cell, std::size_t(begin), std::size_t(nodes), place, raw);
    nodes == 4 ? (void)raw.corners.insert(raw.corners.end(), vertices.begin(), vertices.end())
               : add_ten_node(vertices, raw);
    taken.tets.push_back(cell);
  });
  return taken;
}

namespace {

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

// What tells cells apart, and names no parts of a body.
bool is_identifier(const CellArray& array) {
  static constexpr std::string_view names[] = {"globalids",      "globalelementid", "vtkoriginalcellids",
                                               "vtkghosttype",   "vtkghostlevels",  "pedigreeids",
                                               "originalcellid", "cellids",         "elementid",
                                               "cell_id",        "cellid",          "element_id"};
  const std::string name = lower_case(array.name);
  if (std::find(std::begin(names), std::end(names), name) != std::end(names)) return true;
  const std::set<double> different(array.values.begin(), array.values.end());
  return array.values.size() > 100 && different.size() == array.values.size();
}

// "1, 65"
std::string values_of(const std::vector<double>& values, const std::vector<std::size_t>& tets) {
  std::set<double> different;
  for (const std::size_t cell : tets) different.insert(values[cell]);
  std::string text;
  for (const double value : different) {
    if (text.size() > 40) return text + ", …";
    text += (text.empty() ? "" : ", ") + exact(value);
  }
  return text;
}

// Names under which labels are looked for, the first that is present wins.
constexpr const char* label_names[] = {"label", "gmsh:physical", "medit:ref", "CellEntityIds"};

// What other programs call them, in small letters. Of several arrays the one with such a name is taken.
constexpr std::string_view names_elsewhere[] = {
    "label",       "labels",    "label_id", "material",      "materials",        "materialid",
    "material_id", "regionid",  "region",   "modelregionid", "gmsh:geometrical", "attribute",
    "attributes",  "subdomain", "part",     "partid",        "part_id"};

using CellArrays = std::vector<const CellArray*>;

bool has_usual_name(const CellArray& array) {
  return std::ranges::find(names_elsewhere, lower_case(array.name)) != std::end(names_elsewhere);
}

CellArrays with_usual_names(const CellArrays& arrays) {
  CellArrays found;
  std::ranges::copy_if(arrays, std::back_inserter(found),
                       [](const auto* array) { return has_usual_name(*array); });
  return found;
}

// Whether floating-point numbers are labels: whole ones, and where the name does not say so, numbers of parts
// rather than densities or moduli.
bool may_be_labels(const CellArray& array, const std::vector<std::size_t>& tets) {
  constexpr double most_parts = 255;
  std::set<double> different;
  for (const std::size_t cell : tets) {
    if (!whole_number(array.values[cell], -max_index, max_index)) return false;
    different.insert(array.values[cell]);
  }
  if (has_usual_name(array)) return !different.empty();
  return different.size() > 1 && *different.begin() >= 0 && *different.rbegin() <= most_parts;
}

const CellArray& array_named(std::string_view name, const std::vector<CellArray>& arrays,
                             const std::string& place) {
  std::string list;
  for (const CellArray& array : arrays) {
    if (array.name == name) return array;
    list += (list.empty() ? "" : ", ") + array.name;
  }
  throw InputError(place, "has no cell array \"" + std::string(name) + "\" of single numbers" +
                              (list.empty() ? "" : ", but " + list));
}

std::string in_words(const CellArrays& arrays, const std::vector<std::size_t>& tets) {
  std::string list;
  for (const CellArray* array : arrays)
    list += (list.empty() ? "\"" : ", \"") + array->name + "\" (" + values_of(array->values, tets) + ")";
  return list;
}

// The array that has the labels, or null. Arrays of whole numbers go before those of floating-point ones, and
// one that has a usual name before others.
const CellArray* array_of_labels(const std::vector<CellArray>& arrays, const std::vector<std::size_t>& tets,
                                 std::vector<std::string>& notes) {
  for (const char* name : label_names)
    for (const CellArray& array : arrays)
      if (array.name == name) return &array;
  CellArrays whole, floating;
  for (const CellArray& array : arrays) {
    if (is_identifier(array)) continue;
    if (array.is_whole)
      whole.push_back(&array);
    else if (may_be_labels(array, tets))
      floating.push_back(&array);
  }
  CellArrays usual = with_usual_names(whole);
  if (usual.empty()) usual = with_usual_names(floating);
  const CellArrays& choice = usual.size() == 1 ? usual : whole.empty() ? floating : whole;
  if (choice.empty()) return nullptr;
  if (choice.size() > 1) {
    notes.push_back("labels are all 0: it has several cell arrays of whole numbers, " +
                    in_words(choice, tets) + "; lobe convert --labels ARRAY takes one of them");
    return nullptr;
  }
  CellArrays others;
  for (const CellArray* array : whole)
    if (array != choice[0]) others.push_back(array);
  notes.push_back("labels are those of the cell array " + in_words(choice, tets) +
                  (choice[0]->is_whole ? "" : ", whole numbers that are stored as floating-point ones") +
                  (others.empty() ? ""
                                  : ", not those of " + in_words(others, tets) +
                                        "; lobe convert --labels ARRAY takes another"));
  return choice[0];
}

// Triangles of another label than 0 are in the group of that number.
void take_groups(const CellArray* labels, const VtkCells& cells, const TakenCells& taken,
                 const std::string& place, RawMesh& raw) {
  for (std::size_t k = 0; k < taken.triangles.size(); ++k) {
    const std::size_t cell = taken.triangles[k];
    const auto group = labels ? whole_number(labels->values[cell], -max_index, max_index) : std::nullopt;
    if (group.value_or(0) == 0) {
      ++raw.ignored[kind_of(cells.types[cell])];
      continue;
    }
    const std::vector<Index> corners = vertices_of(cells, cell, taken.begins[k], 3, place, raw);
    raw.surfaces[static_cast<int>(*group)].triangles.push_back({corners[0], corners[1], corners[2]});
  }
}

}  // namespace

std::string take_labels(const std::vector<CellArray>& arrays, const VtkCells& cells, const TakenCells& taken,
                        const std::string& place, std::string_view wanted, RawMesh& raw) {
  const CellArray* labels =
      wanted.empty() ? array_of_labels(arrays, taken.tets, raw.notes) : &array_named(wanted, arrays, place);
  if (labels) raw.labels = labels_of(labels->values, taken.tets, place + ": " + labels->name);
  take_groups(labels, cells, taken, place, raw);
  return labels ? labels->name : "";
}

}  // namespace lobe::io
