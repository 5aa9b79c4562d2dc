#include "pictures.h"

#include "console.h"

namespace lobe::program {

std::string render_pictures(const std::filesystem::path& request) {
  const std::string picture = sibling("lobe-picture").string();
  // Debian's VTK draws through X only; xvfb-run -a gives it a server of its own, whatever DISPLAY says.
  const int status = run_program({"xvfb-run", "-a", picture, request.string()});
  if (status == 0) return "";
  const std::string again = "; to draw them later: xvfb-run -a lobe-picture " + request.string();
  if (status == 127) return "no pictures: lobe-picture or xvfb-run is missing" + again;
  return "no pictures: lobe-picture ended with status " + std::to_string(status) + again;
}

}  // namespace lobe::program
