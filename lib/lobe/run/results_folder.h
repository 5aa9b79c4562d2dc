// The folder that a run writes its results to. Private to this folder.
#pragma once

#include <filesystem>
#include <vector>

namespace lobe {

// Makes the directory, or removes what an earlier run left in it. Throws InputError before anything is
// removed, if it would remove an input of this run.
void clear_earlier_run(const std::filesystem::path& directory,
                       const std::vector<std::filesystem::path>& inputs);

}  // namespace lobe
