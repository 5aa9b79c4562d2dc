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

using NamedFiles = std::vector<std::pair<nlohmann::json*, std::string>>;  // the entry, and what it says

void collect_files(nlohmann::json& json, NamedFiles& found) {
  for (auto& [key, value] : json.items()) {
    const bool may_name_a_file = key == "mesh" || key == "skin" || key == "file";
    if (may_name_a_file && value.is_string() && !value.get_ref<const std::string&>().empty())
      found.emplace_back(&value, value.get<std::string>());
    if (value.is_structured()) collect_files(value, found);
  }
}

// Of a path of this system, or of Windows.
std::string last_part(const std::string& path) {
  const std::size_t slash = path.find_last_of("/\\");
  return slash == path.npos ? path : path.substr(slash + 1);
}

}  // namespace

std::vector<std::string> readable_extensions() {
  std::vector<std::string> all{".vtk", ".vtu", ".msh", ".msh2", ".mesh", ".node", ".ele", ".json"};
  if (program::sibling("lobe-mesh").is_absolute())
    all.insert(all.end(), {".stl", ".obj", ".off", ".ply", ".vtp", ".nii", ".nii.gz", ".nrrd"});
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

// As the page does, which counts characters in units of UTF-16.
std::string plain_name(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain_letter = byte < 0x80 && (std::isalnum(byte) || c == '_' || c == '-' || c == '.');
    if (is_plain_letter)
      plain += c;
    else if (byte < 0x80 || byte >= 0xc0)
      plain += byte >= 0xf0 ? "__" : "_";
  }
  return plain.substr(std::min(plain.find_first_not_of(".-"), plain.size()));
}

std::vector<std::string> find_files_of_scene(const std::filesystem::path& scene,
                                             const std::vector<std::string>& sent, const Known& known) {
  nlohmann::json json = parse_json(io::read_file(scene), scene.filename().string());
  NamedFiles named;
  collect_files(json, named);
  std::vector<std::string> missing;
  bool is_changed = false;
  for (auto& [entry, path] : named) {
    std::string found = plain_name(last_part(path));
    if (std::find(sent.begin(), sent.end(), found) == sent.end()) {
      const std::filesystem::path here = known(path);
      if (here.empty() && std::find(missing.begin(), missing.end(), found) == missing.end())
        missing.push_back(found);
      found = here.string();
    }
    is_changed = is_changed || found != path;
    *entry = found;
  }
  if (missing.empty() && is_changed) io::write_file(scene, json.dump());
  return missing;
}

}  // namespace lobe::view
