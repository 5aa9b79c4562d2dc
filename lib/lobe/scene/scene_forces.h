// Forces of a scene besides those of its boundary and contact. Each kind has a struct in a file of its own,
// with the table of its keys, and a list here. All structs have
//
//   key, sentence                    the list's key in scenes, and what it means
//   resolve(all, resolution)         finds their setups (setup/force_setups.h), faults and warnings
//   summary<Json>(setup, number)     what `lobe check` says of one, as JSON
//   print(summary, out)              the same in words
//   for_each_selector(force, visit)  visit(selector, what, key) for each that it has
//   for_each_point(visit)            visit(point) for each point of the tissue at rest that it has
#pragma once

#include "lobe/scene/attachments.h"
#include "lobe/scene/threads.h"

namespace lobe {

struct SceneForces {
  std::vector<SceneThread> threads;
  std::vector<SceneAttachment> attachments;
  static constexpr auto fields = std::tuple(&SceneForces::threads, &SceneForces::attachments);

  // The keys of those that it has.
  std::vector<std::string> force_keys() const {
    std::vector<std::string> keys;
    for_each_kind(*this, [&]<class Force>(const std::vector<Force>& all) {
      if (!all.empty()) keys.push_back(Force::key);
    });
    return keys;
  }
};

}  // namespace lobe
