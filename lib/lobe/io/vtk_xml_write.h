// Private to io/: VTK XML files out. All arrays are appended raw, each after its size in a UInt64.
#pragma once

#include <bit>
#include <cstdint>

#include "lobe/io/mesh_io.h"

namespace lobe::io {

inline constexpr const char* vtk_byte_order =
    std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

// An array as it goes into the file: its tag, and its bytes.
struct VtkBlock {
  const char*
      section;  // "FieldData" (before all others), "PointData", "CellData", "Points", "Cells", "Polys"
  std::string attributes;
  std::string owned;  // bytes converted for the file, or
  const void* data;   // bytes as they are in memory
  std::size_t size;
};

std::string vtk_attributes(const std::string& name, const char* type, Eigen::Index components);

// Strings in "FieldData".
VtkBlock vtk_strings(const std::string& name, const std::vector<std::string>& strings);

template <class T>
VtkBlock vtk_converted(const char* section, std::string tag, const std::vector<T>& values) {
  VtkBlock block{section, std::move(tag), std::string(), nullptr, values.size() * sizeof(T)};
  block.owned.assign(reinterpret_cast<const char*>(values.data()), block.size);
  return block;
}

template <class Matrix>
VtkBlock vtk_in_place(const char* section, std::string tag, const Matrix& values) {
  return {section, std::move(tag), std::string(), values.data(),
          static_cast<std::size_t>(values.size()) * sizeof(typename Matrix::Scalar)};
}

// Data of `items` points or cells; `place` is named in messages.
VtkBlock vtk_data_block(const char* section, const DataArray& array, Index items, const std::string& place);

// One array of ends for cells of so many vertices each.
VtkBlock vtk_offsets(const char* section, std::size_t cells, int vertices);

// Whole or absent. `piece`: its attributes, such as NumberOfPoints="4".
void write_vtk_xml(const std::filesystem::path& file, const std::string& type, const std::string& piece,
                   const std::vector<VtkBlock>& blocks);

// Triangles with data: .vtu, or .vtp for any other extension.
void write_vtk_triangles(const std::filesystem::path& file, const Mat3X<double>& points,
                         const Triangles& triangles, const std::vector<DataArray>& data);

}  // namespace lobe::io
