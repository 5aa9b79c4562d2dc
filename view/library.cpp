#include "library.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

namespace lobe::view {
namespace {

std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder, const char* extension) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == extension) files.push_back(it->path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string title_of_scene(const std::filesystem::path& file) {
  std::ifstream in(file);
  const auto json = nlohmann::json::parse(in, nullptr, false);
  return json.is_object() && json.contains("name") && json["name"].is_string()
             ? json["name"].get<std::string>()
             : std::string();
}

}  // namespace

std::filesystem::path library_folder() {
  std::error_code error;
  const auto programs = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return {};
  for (const auto& folder : {programs.parent_path() / "share/lobe/data", programs / "../../data"})
    if (std::filesystem::is_directory(folder / "scenes", error)) return folder.lexically_normal();
  return {};
}

std::vector<Shipped> library(const std::filesystem::path& folder) {
  std::vector<Shipped> all;
  if (folder.empty()) return all;
  for (const auto& file : files_of(folder / "scenes", ".json"))
    if (std::string title = title_of_scene(file); !title.empty())
      all.push_back({"scenes/" + file.filename().string(), std::move(title)});
  for (const auto& file : files_of(folder / "meshes", ".vtu"))
    all.push_back({"meshes/" + file.filename().string(), file.stem().string()});
  return all;
}

}  // namespace lobe::view
