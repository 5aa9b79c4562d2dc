// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/label_image.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "lobe/error.h"
#include "lobe/text.h"
#include "lobe_mesh/label_image_parts.h"

namespace lobe::meshing {
namespace {

constexpr double most_voxels = 5e8;

bool is_nrrd(const std::string& name) { return name.ends_with(".nrrd") || name.ends_with(".nhdr"); }
bool is_nifti(const std::string& name) { return name.ends_with(".nii") || name.ends_with(".nii.gz"); }

template <class Value>
std::vector<std::int32_t> copied(const std::string& file, const void* data, std::size_t count) {
  const auto* values = static_cast<const Value*>(data);
  std::vector<std::int32_t> labels(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::in_range<std::int32_t>(values[i])) throw InputError(file, "a label is beyond 2^31");
    labels[i] = static_cast<std::int32_t>(values[i]);
  }
  return labels;
}

// Whole numbers that are stored as floating-point ones.
template <class Value>
std::vector<std::int32_t> whole_values(const std::string& file, const void* data,
                                       const std::array<Index, 3>& size) {
  const auto* values = static_cast<const Value*>(data);
  const std::size_t nx = std::size_t(size[0]), ny = std::size_t(size[1]),
                    count = nx * ny * std::size_t(size[2]);
  std::vector<std::int32_t> labels(count);
  std::size_t others = 0, first = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = static_cast<double>(values[i]);
    if (std::abs(value) <= 2147483647.0 && value == std::floor(value))
      labels[i] = static_cast<std::int32_t>(value);
    else if (others++ == 0)
      first = i;
  }
  if (others == 0) return labels;
  const std::size_t place[] = {first % nx, first / nx % ny, first / nx / ny};
  throw InputError(file, std::to_string(others) + " of its " + std::to_string(count) +
                             " voxels are no whole numbers below 2^31, the first is " +
                             exact(static_cast<double>(values[first])) + " at (" + std::to_string(place[0]) +
                             ", " + std::to_string(place[1]) + ", " + std::to_string(place[2]) +
                             "): a label image is expected, not an intensity image");
}

}  // namespace

std::array<Index, 3> checked_size(const std::string& file, const std::array<double, 3>& size) {
  const double voxels = size[0] * size[1] * size[2];
  if (!(voxels >= 1)) throw InputError(file, "empty: an axis has no voxels");
  if (voxels > most_voxels) {
    throw InputError(file,
                     "too large: " + std::to_string(std::llround(voxels / 1e6)) +
                         " million voxels, at most 500 million are read; crop it or halve its resolution");
  }
  return {static_cast<Index>(size[0]), static_cast<Index>(size[1]), static_cast<Index>(size[2])};
}

std::vector<std::int32_t> to_labels(const std::string& file, const void* data,
                                    const std::array<Index, 3>& size, VoxelType type) {
  const std::size_t count = std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]);
  switch (type) {
    case VoxelType::int8:
      return copied<std::int8_t>(file, data, count);
    case VoxelType::uint8:
      return copied<std::uint8_t>(file, data, count);
    case VoxelType::int16:
      return copied<std::int16_t>(file, data, count);
    case VoxelType::uint16:
      return copied<std::uint16_t>(file, data, count);
    case VoxelType::int32:
      return copied<std::int32_t>(file, data, count);
    case VoxelType::uint32:
      return copied<std::uint32_t>(file, data, count);
    case VoxelType::int64:
      return copied<std::int64_t>(file, data, count);
    case VoxelType::uint64:
      return copied<std::uint64_t>(file, data, count);
    case VoxelType::float32:
      return whole_values<float>(file, data, size);
    case VoxelType::float64:
      return whole_values<double>(file, data, size);
    case VoxelType::other:
      break;
  }
  return {};
}

void check_type(const std::string& file, VoxelType type) {
  if (type != VoxelType::other) return;
  throw InputError(file,
                   "its voxels are no numbers, or of a type that is not read: save the segmentation with an "
                   "integer type");
}

void check_axes(const std::string& file, const Mat34<double>& to_world) {
  const Mat3<double> axes = to_world.leftCols<3>();
  const double box = axes.colwise().norm().prod();
  if (!to_world.allFinite() || !(std::abs(axes.determinant()) > 1e-3 * box))
    throw InputError(file, "its axes are zero, parallel or not finite: the orientation is unknown");
}

double body_diagonal(const LabelImage& image) {
  Eigen::AlignedBox3d box;  // its corners are centres of voxels
  for (Index k = 0; k < image.size[2]; ++k)
    for (Index j = 0; j < image.size[1]; ++j)
      for (Index i = 0; i < image.size[0]; ++i)
        if (image.at(i, j, k) != 0) box.extend(Vec3d(i, j, k));
  if (box.isEmpty()) return 0;
  return (image.to_world.leftCols<3>() * (box.sizes().array() + 1).matrix()).norm();
}

bool is_label_image(const std::filesystem::path& file) {
  return is_nrrd(file.string()) || is_nifti(file.string());
}

LabelImage read_label_image(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(name, "no such file");
  if (std::filesystem::is_directory(file, error)) throw InputError(name, "is a folder, expected a file");
  if (is_nrrd(name)) return read_nrrd(name);
  if (is_nifti(name)) return read_nifti(name);
  throw InputError(name, "unknown extension of a label image, expected .nrrd, .nhdr, .nii or .nii.gz");
}

}  // namespace lobe::meshing
