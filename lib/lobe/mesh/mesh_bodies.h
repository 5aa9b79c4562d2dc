// Which body each tetrahedron of a mesh belongs to, where the mesh is that of several bodies: organs that are
// simulated together. No vertex belongs to two of them.
#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/types.h"

namespace lobe {

struct MeshBodies {
  static constexpr std::size_t most = 255;  // bodies of a mesh

  std::vector<std::string> names = {};  // names of the bodies; none: the mesh is one body without a name
  std::vector<std::uint8_t> of =
      {};  // per tetrahedron: its body's place among the names; none if there are none

  bool any() const { return !names.empty(); }
  std::size_t count() const { return any() ? names.size() : 1; }
  int body_of(Index tet) const { return of.empty() ? 0 : of[std::size_t(tet)]; }
  // ` of "liver"`, for messages; empty where there are no names.
  std::string in_words(Index tet) const {
    return any() ? " of \"" + names[std::size_t(body_of(tet))] + "\"" : "";
  }

  static constexpr auto fields = std::tuple(&MeshBodies::of);
};

}  // namespace lobe
