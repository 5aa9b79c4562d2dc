// Whatever the bytes, the scene reader gives a scene or an InputError; a scene can be written, read again,
// and resolved on a small mesh, or is refused.
#include <string_view>

#include "fuzz/target.h"
#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"

using namespace lobe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const TetMesh mesh = box_mesh({0.1, 0.1, 0.1}, 2, 2, 2);
  Scene scene;
  try {
    scene = parse_scene({reinterpret_cast<const char*>(data), size}, "scene.json");
  } catch (const InputError&) {
    return 0;
  }
  parse_scene(to_json(scene), "written.json");  // what was accepted once is accepted again
  try {
    resolve(scene, mesh, {false});
  } catch (const InputError&) {
  }
  return 0;
}
