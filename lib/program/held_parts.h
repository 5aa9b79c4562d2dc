// What of a body a scene holds that is made for it: a side, fixed or on springs, and pins.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "commands.h"
#include "lobe/mesh/tet_mesh.h"

namespace lobe::program {

struct HeldParts {
  struct Pin {
    Vec3d center;
    double radius = 0;  // [m] of the ball whose vertices are fixed
  };

  const char* side = nullptr;                           // as names_of_sides() has it; null: no side is held
  Vec3d point = Vec3d::Zero(), normal = Vec3d::Zero();  // of the plane beyond which the side lies [m]
  Index vertices = 0;                                   // beyond it
  double springs = 0;                                   // [Pa/m] of the bed under the side; 0: it is fixed
  std::vector<Pin> pins;
};

// Throws InputError for a pin that is far from the body.
HeldParts find_held_parts(const MakeSceneOptions& options, const TetMesh& mesh);

// Its entries of "boundary" and "attachments".
void write_held_parts(const HeldParts& parts, nlohmann::ordered_json& scene);

// For people: one line each.
std::vector<std::string> words_of(const HeldParts& parts, const MakeSceneOptions& options);

}  // namespace lobe::program
