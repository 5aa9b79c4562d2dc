// The files that pages have sent, in a folder of their own that is removed with this.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace lobe::view {

class Inbox {
 public:
  static constexpr std::size_t largest_file = std::size_t(128) << 20;  // [bytes]
  static constexpr std::size_t most = std::size_t(1) << 30;            // size of all files [bytes]

  Inbox() = default;
  ~Inbox() { clear(); }
  Inbox(const Inbox&) = delete;
  Inbox& operator=(const Inbox&) = delete;

  // Keeps a file under this name, in place of a former one. Throws InputError for a name that is not plain or
  // of no kind that lobe reads, for a file that is too large, and where it cannot be written.
  void take(const std::string& name, std::string_view content);
  // Where it lies. Throws InputError for one that was not sent.
  std::filesystem::path path_of(const std::string& name) const;
  // A new folder in it, for what is made of its files.
  std::filesystem::path make_folder();
  void clear();
  // Copies a file of a scene that was sent to the folder in which the scene is going to be, as STEM_NAME, and
  // names it so. Others stay as they are.
  void keep(std::filesystem::path& file, const std::filesystem::path& folder, const std::string& stem) const;
  bool has(const std::filesystem::path& file) const;  // whether a file lies in the folder

 private:
  void make();

  std::filesystem::path folder_;  // empty: nothing was sent yet
  std::set<std::string> names_;
  std::size_t size_ = 0;
  int folders_ = 0;
};

// The extensions of what may be sent: ".vtu" and so on; those of surfaces and images only where lobe-mesh is.
std::vector<std::string> readable_extensions();

// The name under which a page sends a file of this name: what is not plain becomes "_".
std::string plain_name(const std::string& name);

// A file of this machine that a scene which was sent may name, since this program has read or written it;
// empty: none.
using Known = std::function<std::filesystem::path(const std::filesystem::path& named)>;

// Makes a scene that was sent name its files where they are: the file of that name that was sent with it,
// whatever folder the scene says; else the one that is known. What a page sends reads nothing else of this
// machine. Returns the names of those that are missing, and then changes nothing. Throws InputError for what
// is no JSON.
std::vector<std::string> find_files_of_scene(const std::filesystem::path& scene,
                                             const std::vector<std::string>& sent, const Known& known);

}  // namespace lobe::view
