#include "inbox.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "console.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/file/scanner.h"
#include "lobe/scene/json_text.h"

namespace lobe::view {
namespace {

constexpr std::size_t longest_name = 100;  // [bytes]

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool is_plain(const std::string& name) {
  return !name.empty() && name.size() <= longest_name && name.front() != '.' && name.front() != '-' &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return c < 128 && (std::isalnum(c) || c == '_' || c == '-' || c == '.');
         });
}

bool is_readable(const std::string& name) {
  const std::string text = lower(name);
  const auto known = readable_extensions();
  return std::any_of(known.begin(), known.end(), [&](const auto& end) { return text.ends_with(end); });
}

// The head of an NRRD file may say that the voxels are in another file.
bool reads_another(const std::string& name, std::string_view content) {
  if (!lower(name).ends_with(".nrrd")) return false;
  const std::size_t end = std::min(content.find("\n\n"), content.find("\n\r\n"));
  const std::string head = lower(std::string(content.substr(0, end)));
  return head.find("data file:") != head.npos || head.find("datafile:") != head.npos;
}

void check_names(const nlohmann::json& json, const std::string& place) {
  for (const auto& [key, value] : json.items()) {
    const std::string here = place + "/" + key;
    const bool may_name_a_file = key == "mesh" || key == "skin" || key == "file";
    if (value.is_string() && may_name_a_file && !value.get_ref<const std::string&>().empty() &&
        !is_plain(value.get<std::string>()))
      throw InputError(here,
                       value.get<std::string>() +
                           ": a scene that is sent to lobe view names only files that are sent with it");
    if (value.is_structured()) check_names(value, here);
  }
}

}  // namespace

std::vector<std::string> readable_extensions() {
  std::vector<std::string> all{".vtk", ".vtu", ".msh", ".msh2", ".mesh", ".node", ".ele", ".json"};
  if (program::sibling("lobe-mesh").is_absolute())
    all.insert(all.end(), {".stl", ".obj", ".ply", ".vtp", ".nii", ".nii.gz", ".nrrd"});
  return all;
}

void Inbox::clear() {
  std::error_code ignored;  // the system removes its temporary files some day
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  folder_.clear();
  names_.clear();
}

void Inbox::make() {
  if (!folder_.empty()) return;
  std::string pattern = (std::filesystem::temp_directory_path() / "lobe-view-XXXXXX").string();
  if (!::mkdtemp(pattern.data())) throw InputError(pattern, std::strerror(errno));
  folder_ = pattern;
}

void Inbox::take(const std::string& name, std::string_view content) {
  if (!is_plain(name))
    throw InputError("name", "must be of letters, digits, \"_\", \"-\" and \".\", at most 100 of them");
  if (!is_readable(name)) throw InputError(name, "is of no kind that lobe reads");
  if (content.size() > largest_file) throw InputError(name, "has more than 128 MiB");
  if (reads_another(name, content))
    throw InputError(name, "has its voxels in another file: save it as one file");
  if (size_ + content.size() > most)
    throw InputError(name, "would be too much: 1 GiB was sent since lobe view was started");
  make();
  io::write_file(folder_ / name, std::string(content));
  names_.insert(name);
  size_ += content.size();
}

std::filesystem::path Inbox::path_of(const std::string& name) const {
  if (!names_.contains(name)) throw InputError("/files", "\"" + name + "\" was not sent");
  return folder_ / name;
}

void Inbox::keep(std::filesystem::path& file, const std::filesystem::path& folder,
                 const std::string& stem) const {
  if (!has(file)) return;
  const std::string name = stem + "_" + file.filename().string();
  std::filesystem::copy_file(file, folder / name, std::filesystem::copy_options::overwrite_existing);
  file = name;
}

std::filesystem::path Inbox::make_folder() {
  make();
  const std::filesystem::path folder = folder_ / std::to_string(++folders_);
  std::filesystem::create_directory(folder);
  return folder;
}

bool Inbox::has(const std::filesystem::path& file) const {
  if (folder_.empty()) return false;
  const auto relative = file.lexically_relative(folder_);
  return !relative.empty() && *relative.begin() != "..";
}

void check_names_beside(const std::filesystem::path& scene) {
  check_names(parse_json(io::read_file(scene), scene.filename().string()), "");
}

}  // namespace lobe::view
