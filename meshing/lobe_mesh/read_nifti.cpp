// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe/error.h"
#include "lobe_mesh/label_image_parts.h"

#ifdef LOBE_NIFTI

#include <nifti2_io.h>

#include <memory>

namespace lobe::meshing {
namespace {

VoxelType type_of(const nifti_image& image) {
  switch (image.datatype) {
    case DT_INT8:
      return VoxelType::int8;
    case DT_UINT8:
      return VoxelType::uint8;
    case DT_INT16:
      return VoxelType::int16;
    case DT_UINT16:
      return VoxelType::uint16;
    case DT_INT32:
      return VoxelType::int32;
    case DT_UINT32:
      return VoxelType::uint32;
    case DT_INT64:
      return VoxelType::int64;
    case DT_UINT64:
      return VoxelType::uint64;
    case DT_FLOAT32:
      return VoxelType::float32;
    case DT_FLOAT64:
      return VoxelType::float64;
    default:
      return VoxelType::other;
  }
}

double metres(int units) {
  if (units == NIFTI_UNITS_MM) return 1e-3;
  return units == NIFTI_UNITS_MICRON ? 1e-6 : 1;
}

// Takes the sform if there is one, else the qform. NIfTI's axes point to the right and to the front.
Mat34<double> oriented(const std::string& file, const nifti_image& image) {
  if (image.sform_code == 0 && image.qform_code == 0)
    throw InputError(file, "its sform and qform codes are 0: the orientation is unknown");
  const nifti_dmat44& m = image.sform_code > 0 ? image.sto_xyz : image.qto_xyz;
  const Vec3d signs(-1, -1, 1);
  Mat34<double> to_world;
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 4; ++k) to_world(row, k) = signs[row] * metres(image.xyz_units) * m.m[row][k];
  }
  return to_world;
}

}  // namespace

LabelImage read_nifti(const std::string& file) {
  nifti_set_debug_level(0);
  const std::unique_ptr<nifti_image, decltype(&nifti_image_free)> nifti(nifti_image_read(file.c_str(), 0),
                                                                        &nifti_image_free);
  if (nifti == nullptr) throw InputError(file, "not a NIfTI file, or a garbled one");
  if (nifti->nt > 1 || nifti->nu > 1 || nifti->nv > 1 || nifti->nw > 1)
    throw InputError(file, "more than 3 axes: one label per voxel is expected");
  if ((nifti->scl_slope != 0 && nifti->scl_slope != 1) || nifti->scl_inter != 0)
    throw InputError(file, "its values are scaled (scl_slope, scl_inter): save the labels as they are");
  LabelImage image;
  const auto axis = [](std::int64_t n) { return static_cast<double>(n); };
  image.size = checked_size(file, {axis(nifti->nx), axis(nifti->ny), axis(nifti->nz)});
  image.to_world = oriented(file, *nifti);
  const bool names_unit = nifti->xyz_units == NIFTI_UNITS_METER || metres(nifti->xyz_units) != 1;
  image.assumed_unit = names_unit ? 0 : 1;
  check_axes(file, image.to_world);
  check_type(file, type_of(*nifti));
  if (nifti_image_load(nifti.get()) != 0) throw InputError(file, "truncated: voxels are missing");
  image.values = to_labels(file, nifti->data, image.size, type_of(*nifti));
  return image;
}

}  // namespace lobe::meshing

#else

namespace lobe::meshing {

LabelImage read_nifti(const std::string& file) {
  throw InputError(
      file, "lobe was built without niftilib: install libnifti-dev and build again, or save it as NRRD");
}

}  // namespace lobe::meshing

#endif
