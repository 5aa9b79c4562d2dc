// The scenes and meshes that come with lobe, for a page to choose from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lobe::view {

struct Shipped {
  std::string name;   // "scenes/two_organs.json", in the folder of the library
  std::string title;  // name of a scene, or of a mesh's file
};

// The folder of the installed data, or of the tree in which the program was built; empty if there is none.
std::filesystem::path library_folder();

// Scenes first, each kind in the order of their names. A file that cannot be read is left out.
std::vector<Shipped> library(const std::filesystem::path& folder);

}  // namespace lobe::view
