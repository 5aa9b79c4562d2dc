#include "lobe/run/reactions.h"

namespace lobe {

nlohmann::ordered_json reactions_json(const std::vector<HeldEntry>& entries, const Elements& elements,
                                      const Mat3X<double>& reactions) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  const std::vector<Vec3d> forces = held_forces(entries, elements, reactions);
  for (std::size_t i = 0; i < entries.size(); ++i)
    list.push_back({{"entry", entries[i].pointer}, {"force", {forces[i][0], forces[i][1], forces[i][2]}}});
  return list;
}

}  // namespace lobe
