// Tetrahedral meshes in and out.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

// Triangles that a file has put into a group, for a scene to select.
struct SurfaceGroup {
  int number = 0;
  std::string name;  // may be empty
  std::vector<std::array<Index, 3>> triangles;
};

struct BodyLabelName {  // a file's name of a label, in a mesh joined of several files
  std::string body;
  int label = 0;
  std::string name;
};

// Reads by extension: .vtu (ascii, inline or appended base64, raw appended; uncompressed or zlib), .vtk
// (legacy 2.0 … 5.1, ascii and binary), .msh, .msh2 (Gmsh 1, ascii; 2.2 and 4.1, ascii and binary), .mesh
// (MEDIT ascii), .node/.ele (TetGen; either name finds the other). Vertices and tetrahedra keep the order of
// the file. Of ten-node tetrahedra only the corners are taken; the vertices in the middle of their edges are
// left out. Other cells are ignored and counted. Labels are the cell data "label", else "gmsh:physical",
// "medit:ref" or "CellEntityIds", else the only array of whole numbers, even if they are stored as
// floating-point ones (VTK); the first physical group, or the entity where there are no groups (Gmsh); the
// reference (MEDIT); the region (TetGen). Triangles whose label is not 0 are a group of that number. Throws
// InputError naming file, line or section, and what was expected. Calls prepare().
struct MeshFile {
  TetMesh mesh;
  PrepareReport prepared;
  std::vector<std::string> notes;  // one line each: what was taken for labels, what was left out
  Index ignored_cells = 0;
  std::vector<SurfaceGroup> surfaces;        // by label (VTK), physical surface (Gmsh) or reference (MEDIT)
  std::map<int, std::string> label_names{};  // by physical volumes (Gmsh) or field data (VTU)
  std::vector<BodyLabelName> body_label_names{};      // the same names by body, in a mesh of several files
  std::map<std::string, Eigen::MatrixXd> point_data;  // #components × #vertices (VTU only)
  std::map<std::string, Eigen::MatrixXd> cell_data;  // #components × #tetrahedra (VTU only), without "label"
  std::vector<std::string> warnings() const;         // warnings: the notes, and what prepare() noticed
};
MeshFile read_mesh(const std::filesystem::path& file);

// One array of a VTU file: #components × #points or #cells.
struct DataArray {
  std::string name;
  Eigen::MatrixXd values;
  enum class Type { float32, float64, int32 } type = Type::float64;
};

// Writes a VTU (appended raw, little endian; ParaView, VTK and read_mesh() open it), with the labels as cell
// data "label". It is written to a temporary name and then renamed, so that the file is whole or absent.
void write_vtu(const std::filesystem::path& file, const TetMesh& mesh,
               const std::vector<DataArray>& point_data = {}, const std::vector<DataArray>& cell_data = {});

// Writes by extension, whole or absent, vertices and tetrahedra in order, labels as read_mesh() reads them:
// .vtu, .vtk (legacy 3.0), .msh (Gmsh 4.1), .msh2 (Gmsh 2.2), .mesh (MEDIT), .node and .ele (TetGen, both);
// all but the first as text, exact. Throws InputError for another extension, and for negative labels in
// Gmsh's formats.
void write_mesh(const std::filesystem::path& file, const TetMesh& mesh);
bool can_write_mesh(const std::filesystem::path& file);  // whether write_mesh() has the extension

// Writes a ParaView collection, such as DIR/series.pvd, of frames in the same folder.
void write_pvd(const std::filesystem::path& file, const std::vector<std::pair<double, std::string>>& frames);

}  // namespace lobe
