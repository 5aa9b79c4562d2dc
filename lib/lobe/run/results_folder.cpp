#include "lobe/run/results_folder.h"

#include <string>

#include "lobe/error.h"

namespace lobe {
namespace {

// prefix, a number, suffix.
bool is_numbered(const std::string& file, const std::string& prefix, const std::string& suffix) {
  if (!file.starts_with(prefix) || !file.ends_with(suffix) || file.size() <= prefix.size() + suffix.size())
    return false;
  const std::string number = file.substr(prefix.size(), file.size() - prefix.size() - suffix.size());
  return number.find_first_not_of("0123456789.e-+") == std::string::npos;
}

bool is_result(const std::string& file) {
  return is_numbered(file, "frame_", ".vtu") || is_numbered(file, "picture_", ".png") ||
         is_numbered(file, "threads_", ".vtp") || is_numbered(file, "attachments_", ".vtp") ||
         is_numbered(file, "clips_", ".vtp") || file == "clips.pvd" || file == "report.json" ||
         file == "series.pvd" || file == "threads.pvd" || file == "attachments.pvd" ||
         file == "pictures.json";
}

}  // namespace

void clear_earlier_run(const std::filesystem::path& directory,
                       const std::vector<std::filesystem::path>& inputs) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (!std::filesystem::is_directory(directory, error))
    throw InputError(directory.string(), "cannot be made a directory for the results");
  std::vector<std::filesystem::path> earlier;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error))
    if (is_result(entry.path().filename().string())) earlier.push_back(entry.path());
  for (const std::filesystem::path& file : earlier)
    for (const std::filesystem::path& input : inputs)
      if (std::filesystem::equivalent(file, input, error))
        throw InputError(input.string(), "would be overwritten by the results; choose another directory");
  for (const std::filesystem::path& file : earlier) std::filesystem::remove(file, error);
}

}  // namespace lobe
