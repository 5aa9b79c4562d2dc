// lobe-picture REQUEST.json: draws meshes, tools and colours into PNG files (request.h has the format). Exit
// status 0 done, 2 bad input or nothing to draw on.
#include <vtkObject.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "display.h"
#include "render.h"

namespace {

int fail(const char* message) {
  std::cerr << "lobe-picture: error: " << message << '\n';
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Draws meshes into PNG files."};
  std::filesystem::path request;
  app.add_option("request", request, "JSON file that lists the pictures")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return fail(error.what());
  }
  try {
    vtkObject::GlobalWarningDisplayOff();  // faults are reported in one line, below
    const std::vector<picture::Picture> pictures = picture::read_request(request);
    const picture::Display display;
    for (const picture::Picture& one : pictures) picture::render(one);
    return 0;
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}
