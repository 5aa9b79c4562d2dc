#include "lobe_petsc/mesh_slice.h"

#include <algorithm>
#include <bit>
#include <fstream>
#include <optional>
#include <pugixml.hpp>
#include <string>

#include "lobe/io/mesh_io.h"

namespace lobe::petsc {
namespace {

struct Array {
  std::string type;
  Index components = 1;
  std::uint64_t at = 0;  // in the file: its first value
};

// A .vtu file whose arrays have the same bytes in the file as in memory.
class RawVtu {
 public:
  // Returns nothing if the file is another kind of mesh.
  static std::optional<RawVtu> open(const std::filesystem::path& file);

  Index tets = 0, vertices = 0;
  std::optional<Array> points, corners, types, labels, fibres;

  // Columns first … first + count − 1.
  template <class Number>
  Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic> read(const Array& array, Index rows, Index first,
                                                             Index count) {
    if (array.type == "Float64") return read_as<double, Number>(array, rows, first, count);
    if (array.type == "Float32") return read_as<float, Number>(array, rows, first, count);
    if (array.type == "Int64") return read_as<std::int64_t, Number>(array, rows, first, count);
    if (array.type == "UInt8") return read_as<std::uint8_t, Number>(array, rows, first, count);
    return read_as<std::int32_t, Number>(array, rows, first, count);
  }

 private:
  template <class Stored, class Number>
  Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic> read_as(const Array& array, Index rows, Index first,
                                                                Index count) {
    Eigen::Matrix<Stored, Eigen::Dynamic, Eigen::Dynamic> values(rows, count);
    stream_.seekg(std::streamoff(array.at + std::uint64_t(first) * std::uint64_t(rows) * sizeof(Stored)));
    stream_.read(reinterpret_cast<char*>(values.data()),
                 std::streamsize(std::uint64_t(values.size()) * sizeof(Stored)));
    if (!stream_) throw InputError(name_, "ends before all of its " + array.type + " values");
    return values.template cast<Number>();
  }
  bool has_head();
  std::optional<Array> find(const pugi::xml_node& piece, const char* section, const char* name) const;

  std::string name_;
  std::ifstream stream_;
  std::uint64_t data_ = 0;        // in the file: the first byte of the appended data
  std::uint64_t size_bytes_ = 8;  // of the number before each array
};

std::optional<Array> RawVtu::find(const pugi::xml_node& piece, const char* section, const char* name) const {
  for (const pugi::xml_node node : piece.child(section).children("DataArray")) {
    if (*name != '\0' && std::string(node.attribute("Name").value()) != name) continue;
    Array array{node.attribute("type").value(), node.attribute("NumberOfComponents").as_int(1), 0};
    static const std::string known[] = {"Float64", "Float32", "Int64", "Int32", "UInt8"};
    if (std::string(node.attribute("format").value()) != "appended") return {};
    if (std::find(std::begin(known), std::end(known), array.type) == std::end(known)) return {};
    array.at = data_ + node.attribute("offset").as_ullong() + size_bytes_;
    return array;
  }
  return {};
}

bool RawVtu::has_head() {
  std::string head(1 << 16, '\0');
  stream_.read(head.data(), std::streamsize(head.size()));
  head.resize(std::size_t(stream_.gcount()));
  stream_.clear();
  const std::size_t appended = head.find("<AppendedData");
  const std::size_t begin =
      appended == std::string::npos ? appended : head.find('_', head.find('>', appended));
  if (begin == std::string::npos) return false;
  data_ = begin + 1;
  pugi::xml_document document;
  if (!document.load_string((head.substr(0, begin) + "</AppendedData></VTKFile>").c_str())) return false;
  const pugi::xml_node root = document.child("VTKFile");
  size_bytes_ = std::string(root.attribute("header_type").value()) == "UInt64" ? 8 : 4;
  const pugi::xml_node piece = root.child("UnstructuredGrid").child("Piece");
  const bool plain = std::string(root.child("AppendedData").attribute("encoding").value()) == "raw" &&
                     std::string(root.attribute("byte_order").value()) == "LittleEndian" &&
                     !root.attribute("compressor") && !piece.next_sibling("Piece");
  if (!plain || std::endian::native != std::endian::little) return false;
  tets = piece.attribute("NumberOfCells").as_int();
  vertices = piece.attribute("NumberOfPoints").as_int();
  points = find(piece, "Points", "");
  corners = find(piece, "Cells", "connectivity");
  types = find(piece, "Cells", "types");
  labels = find(piece, "CellData", "label");
  fibres = find(piece, "CellData", "fibre");
  const bool other_labels = !labels && piece.child("CellData").find_child([](const pugi::xml_node& node) {
    const std::string name = node.attribute("Name").value();
    return name == "gmsh:physical" || name == "medit:ref" || name == "CellEntityIds";
  });
  return tets > 0 && vertices > 0 && points && corners && types && !other_labels;
}

std::optional<RawVtu> RawVtu::open(const std::filesystem::path& file) {
  RawVtu vtu;
  vtu.name_ = file.string();
  vtu.stream_.open(file, std::ios::binary);
  if (!vtu.stream_ || file.extension() != ".vtu" || !vtu.has_head()) return {};
  return vtu;
}

void check_corners(const std::string& name, const MeshSlice& slice) {
  for (Index t = 0; t < slice.mesh.tet_count(); ++t)
    for (int c = 0; c < 4; ++c)
      if (const Index v = slice.mesh.tets(c, t); v < 0 || v >= slice.vertices)
        throw InputError(name + ": tetrahedron " + std::to_string(slice.first_tet + t),
                         "names vertex " + std::to_string(v) + ", must be from 0 to " +
                             std::to_string(slice.vertices - 1));
}

// Returns nothing if this rank has cells of other kinds.
bool read_own(RawVtu& vtu, const Ranks& ranks, MeshSlice& slice) {
  slice.tets = vtu.tets;
  slice.vertices = vtu.vertices;
  slice.first_tet = ranks.first_of(vtu.tets, ranks.rank());
  slice.first_vertex = ranks.first_of(vtu.vertices, ranks.rank());
  const Index tets = ranks.first_of(vtu.tets, ranks.rank() + 1) - slice.first_tet;
  const Index vertices = ranks.first_of(vtu.vertices, ranks.rank() + 1) - slice.first_vertex;
  const Eigen::MatrixXi types = vtu.read<int>(*vtu.types, 1, slice.first_tet, tets);
  if ((types.array() != 10).any()) return false;
  slice.mesh.tets = vtu.read<Index>(*vtu.corners, 4, slice.first_tet, tets);
  slice.mesh.points = vtu.read<double>(*vtu.points, 3, slice.first_vertex, vertices);
  slice.mesh.labels.assign(std::size_t(tets), 0);
  if (vtu.labels) {
    const Eigen::MatrixXi labels = vtu.read<int>(*vtu.labels, 1, slice.first_tet, tets);
    std::copy(labels.data(), labels.data() + labels.size(), slice.mesh.labels.begin());
  }
  if (vtu.fibres && vtu.fibres->components == 3)
    slice.mesh.fibres = vtu.read<double>(*vtu.fibres, 3, slice.first_tet, tets);
  return true;
}

MeshSlice cut_out(const Ranks& ranks, const TetMesh& mesh, int rank) {
  MeshSlice slice;
  slice.tets = mesh.tet_count();
  slice.vertices = mesh.vertex_count();
  slice.first_tet = ranks.first_of(slice.tets, rank);
  slice.first_vertex = ranks.first_of(slice.vertices, rank);
  const Index tets = ranks.first_of(slice.tets, rank + 1) - slice.first_tet;
  slice.mesh.tets = mesh.tets.middleCols(slice.first_tet, tets);
  slice.mesh.points = mesh.points.middleCols(slice.first_vertex,
                                             ranks.first_of(slice.vertices, rank + 1) - slice.first_vertex);
  slice.mesh.labels.assign(std::size_t(tets), 0);
  for (Index t = 0; t < tets && !mesh.labels.empty(); ++t)
    slice.mesh.labels[t] = mesh.labels[slice.first_tet + t];
  if (mesh.fibres.cols() > 0) slice.mesh.fibres = mesh.fibres.middleCols(slice.first_tet, tets);
  return slice;
}

template <class Matrix>
void send_columns(const Ranks& ranks, Matrix& matrix, const std::function<Matrix(int)>& of_rank) {
  using Scalar = typename Matrix::Scalar;
  std::vector<std::vector<Scalar>> to(std::size_t(ranks.count()));
  if (ranks.rank() == 0)
    for (int r = 0; r < ranks.count(); ++r) {
      const Matrix part = of_rank(r);
      to[r].assign(part.data(), part.data() + part.size());
    }
  const std::vector<Scalar> received = ranks.exchange(to)[0];
  matrix =
      Eigen::Map<const Matrix>(received.data(), matrix.rows(), Eigen::Index(received.size()) / matrix.rows());
}

MeshSlice scatter(const Ranks& ranks, const std::filesystem::path& file) {
  TetMesh whole;
  ranks.together([&] {
    if (ranks.rank() == 0) whole = read_mesh(file).mesh;
  });
  MeshSlice slice;
  slice.read_in_parts = ranks.count() == 1;
  slice.tets = Index(ranks.sum(std::int64_t(whole.tet_count())));
  slice.vertices = Index(ranks.sum(std::int64_t(whole.vertex_count())));
  slice.first_tet = ranks.first_of(slice.tets, ranks.rank());
  slice.first_vertex = ranks.first_of(slice.vertices, ranks.rank());
  send_columns<Mat3X<double>>(ranks, slice.mesh.points,
                              [&](int r) { return cut_out(ranks, whole, r).mesh.points; });
  send_columns<Tets>(ranks, slice.mesh.tets, [&](int r) { return cut_out(ranks, whole, r).mesh.tets; });
  send_columns<Mat3X<double>>(ranks, slice.mesh.fibres,
                              [&](int r) { return cut_out(ranks, whole, r).mesh.fibres; });
  std::vector<std::vector<int>> labels(std::size_t(ranks.count()));
  if (ranks.rank() == 0)
    for (int r = 0; r < ranks.count(); ++r) labels[r] = cut_out(ranks, whole, r).mesh.labels;
  slice.mesh.labels = ranks.exchange(labels)[0];
  return slice;
}

}  // namespace

MeshSlice slice_of(const Ranks& ranks, const TetMesh& mesh) { return cut_out(ranks, mesh, ranks.rank()); }

MeshSlice read_slice(const Ranks& ranks, const std::filesystem::path& file) {
  MeshSlice slice;
  bool in_parts = false;
  ranks.together([&] {
    std::optional<RawVtu> vtu = RawVtu::open(file);
    in_parts = vtu && read_own(*vtu, ranks, slice);
    if (in_parts) check_corners(file.string(), slice);
  });
  return ranks.min(in_parts ? 1 : 0) > 0 ? slice : scatter(ranks, file);
}

}  // namespace lobe::petsc
