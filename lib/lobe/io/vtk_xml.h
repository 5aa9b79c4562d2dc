// Private to io/: VTK XML files (VTK file formats, "XML file formats"): one piece, any encoding but LZ4 and
// LZMA.
#pragma once

#include <map>

#include "lobe/io/vtu_data.h"
#include "lobe/types.h"

namespace lobe::io {

// A parsed file; views into its bytes, which must outlive it.
struct VtkXml {
  VtuContext context;
  pugi::xml_document document;
  pugi::xml_node piece;
};

// `type`: "UnstructuredGrid" or "PolyData".
void parse_vtk_xml(const std::string& name, std::string_view bytes, const std::string& type, VtkXml& xml);

pugi::xml_node vtk_child(const VtkXml& xml, const pugi::xml_node& parent, const char* name);
std::vector<double> read_vtk_array(const VtkXml& xml, const pugi::xml_node& section, const char* name);
std::vector<double> read_vtk_points(const VtkXml& xml);  // x y z of each

// Throws unless an attribute of the piece, such as NumberOfCells, says so.
void check_vtk_count(const VtkXml& xml, const char* attribute, std::size_t found);

// Arrays of strings in <FieldData> that lobe writes: names of groups of triangles, and of labels, each after
// its number, such as "11 held".
inline constexpr const char *vtu_surface_names = "surface_names", *vtu_label_names = "label_names";

// All numeric arrays of "PointData" or "CellData": #components × `items` each.
using VtkData = std::map<std::string, Eigen::MatrixXd>;
VtkData read_vtk_data(const VtkXml& xml, const char* section, std::size_t items);

}  // namespace lobe::io
