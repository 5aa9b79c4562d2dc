#include <doctest/doctest.h>

#include <string>

#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/model.h"
#include "lobe_mesh/repair.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

template <class Step>
std::string refusal(const Step& step) {
  try {
    step();
  } catch (const MeshingFailure& failure) {
    return failure.what();
  }
  return "";
}

TEST_CASE("a build for the demo says what it cannot do, and how to have it") {
  const Surface surface;
  RepairReport report;
  for (const auto& [message, what] :
       {std::pair(refusal([&] { repair_in_steps(surface, 0, report, [](const Surface&) {}); }), "repair"),
        std::pair(refusal([&] { alpha_wrap(surface, 1, 1); }), "wrap"),
        std::pair(refusal([&] { remesh(surface, {}, 1); }), "remesh")}) {
    CHECK(message.starts_with(std::string("this build of lobe-mesh cannot ") + what));
    CHECK(message.ends_with("`./dev build` compiles all of it"));
  }
}

}  // namespace
}  // namespace lobe::meshing
