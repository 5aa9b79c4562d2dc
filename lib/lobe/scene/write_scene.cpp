#include "lobe/scene/write_scene.h"

#include "lobe/scene/material_keys.h"
#include "lobe/scene/read_shape.h"
#include "lobe/scene/scene_document.h"
#include "lobe/scene/scene_keys.h"

namespace lobe {

using nlohmann::ordered_json;

ordered_json keys::Form<Material>::write(const Material& material) {
  ordered_json entry = ordered_json::object();
  write_rows(material_keys, material, entry);
  return entry;
}

ordered_json write_document(const Scene& scene) {
  ordered_json document = ordered_json::object();
  keys::write_rows(keys::scene_keys, scene, document);
  if (scene.auto_regions) document["regions"] = {{"auto", keys::write_value(*scene.auto_regions)}};
  for (std::size_t i = 0; i < scene.contact.obstacles.size(); ++i)
    document["contact"]["obstacles"][i]["shape"] =
        write_shape(scene.contact.obstacles[i].shape, scene.obstacle_files[i]);
  return document;
}

std::string to_json(const Scene& scene) {
  return write_document(scene).dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace lobe
