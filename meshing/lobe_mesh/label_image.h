// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// A segmentation: one label per voxel, and where the voxels lie.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lobe/types.h"

namespace lobe::meshing {

struct LabelImage {
  std::array<Index, 3> size{};       // voxels along i, j, k
  std::vector<std::int32_t> values;  // i fastest; 0 is background
  // 3 × 4: (i, j, k, 1) of a voxel's centre to its position [m]; +x to the patient's left, +y to the back, +z
  // up.
  Mat34<double> to_world = Mat34<double>::Zero();
  std::vector<std::string> notes = {};  // notes for people on what its labels are
  // What a unit of the file was taken for [m], where it names none: a millimetre for a segmentation of 3D
  // Slicer, which writes no other; else 1. 0: it names one.
  double assumed_unit = 0;
  bool is_of_surfaces = false;  // label k + 1 is that of surface k, which voxelise() has turned into voxels
  // Then the volume that each surface encloses, without what others win [m³]; else empty.
  std::vector<double> surface_volumes = {};

  std::int32_t at(Index i, Index j, Index k) const {
    return values[static_cast<std::size_t>(i) +
                  static_cast<std::size_t>(size[0]) *
                      (static_cast<std::size_t>(j) +
                       static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(k))];
  }
};

// Of the box around all voxels that are not 0 [m]; 0 if there are none.
double body_diagonal(const LabelImage& image);

// Whether the extension says so: .nrrd, .nhdr, .nii, .nii.gz.
bool is_label_image(const std::filesystem::path& file);

// NRRD 1 to 5 (read by teem) and NIfTI 1 and 2 (read by niftilib), compressed or not. Coordinates become
// metres where the file names its unit. Segments of an NRRD file that are in layers, since they overlap, get
// the labels 1, 2, … in their order (label_layers.h). Throws InputError naming the file: missing or garbled,
// not three axes, not whole numbers, more than half a billion voxels, spacing or orientation unknown.
LabelImage read_label_image(const std::filesystem::path& file);

}  // namespace lobe::meshing
