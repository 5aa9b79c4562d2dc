// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// What the readers of the image formats share. Private.
#pragma once

#include <string>

#include "lobe_mesh/label_image.h"

namespace lobe::meshing {

enum class VoxelType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64, other };

// Each throws InputError that begins with `file`.
LabelImage read_nrrd(const std::string& file);
LabelImage read_nifti(const std::string& file);
std::array<Index, 3> checked_size(const std::string& file, const std::array<double, 3>& size);
void check_type(const std::string& file, VoxelType type);
// Floating-point voxels are labels if all of them are whole numbers.
std::vector<std::int32_t> to_labels(const std::string& file, const void* data,
                                    const std::array<Index, 3>& size, VoxelType type);
void check_axes(const std::string& file, const Mat34<double>& to_world);

}  // namespace lobe::meshing
