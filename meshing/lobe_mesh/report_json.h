// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lobe_mesh/repair.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

// A file of one run and what its repair did; a label image is not repaired.
struct InputFile {
  std::string file;
  std::optional<RepairReport> repair;
};

// Everything about one run of lobe-mesh; units as in the structs.
std::string in_json(const std::vector<InputFile>& inputs, const std::string& mesh_file,
                    const MeshOptions& options, const MeshReport& report);
std::string in_words(const MeshReport& report);

// Of a surface that was repaired and not meshed.
std::string in_json(const InputFile& input);

}  // namespace lobe::meshing
