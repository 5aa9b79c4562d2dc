#include "pictures.h"

#include <nlohmann/json.hpp>

#include "console.h"
#include "lobe/file/atomic_file.h"

namespace lobe::program {

std::string render_pictures(const std::filesystem::path& request) {
  const std::string picture = sibling("lobe-picture").string();
  const int status = run_program({picture, request.string()});
  if (status == 0) return "";
  const std::string again = "; to draw them later: lobe-picture " + request.string();
  if (status == 127) return "no pictures: lobe-picture is missing" + again;
  return "no pictures: lobe-picture ended with status " + std::to_string(status) + again;
}

std::string draw_cells(const std::filesystem::path& mesh, const std::string& data,
                       const std::filesystem::path& picture) {
  std::filesystem::path file = picture;
  file.replace_extension(".json");
  const nlohmann::json panel{{"mesh", std::filesystem::absolute(mesh).string()},
                             {"title", mesh.stem().string()},
                             {"color", data},
                             {"edges", true}};
  const nlohmann::json request{{"pictures", {{{"out", picture.filename().string()}, {"panels", {panel}}}}}};
  io::write_file(file, request.dump());
  const std::string trouble = render_pictures(file);
  if (trouble.empty()) std::filesystem::remove(file);
  return trouble;
}

}  // namespace lobe::program
