// The folder that a run writes its results to. Private to this folder.
#pragma once

#include <filesystem>
#include <vector>

namespace lobe {

// Makes the directory and removes what an earlier run left in it; before it removes anything, it refuses to
// remove what this run is made from. Throws InputError.
void clear_earlier_run(const std::filesystem::path& directory,
                       const std::vector<std::filesystem::path>& inputs);

}  // namespace lobe
