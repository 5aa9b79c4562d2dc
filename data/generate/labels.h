// A label image of the liver, as a segmentation would give it.
#pragma once

#include <filesystem>

namespace organs {

// NRRD, uncompressed: voxels of 2 × 2 × 2.5 mm, 0 background, 1 liver, 2 a ball in its right lobe (a tumour),
// 3 a tube that enters it from the back (a vein). Whole or absent.
void write_labels(const std::filesystem::path& file);

}  // namespace organs
