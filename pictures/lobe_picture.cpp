// lobe-picture REQUEST.json: draws meshes, tools and colours into PNG files (request.h has the format). It
// needs an X display: without one, run it under xvfb-run -a. Exit status 0 done, 2 bad input.
#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkRenderWindow.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>
#include <stdexcept>

#include "render.h"

namespace {

// VTK ends the process where there is no display.
void need_display() {
  const char* display = std::getenv("DISPLAY");
  if (!display || !*display) throw std::runtime_error("no X display; run under xvfb-run -a");
}

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
    need_display();
    // An X server whose last client has left starts again, and refuses clients meanwhile. This window stays.
    const vtkNew<vtkRenderWindow> kept;
    kept->SetOffScreenRendering(true);
    kept->Start();
    for (const picture::Picture& one : pictures) picture::render(one);
    return 0;
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}
