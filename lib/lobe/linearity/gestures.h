// Gestures: what will be done to the body. Regions are chosen for them.
#pragma once

#include <string>
#include <vector>

#include "lobe/setup/setup.h"

namespace lobe {

struct Gesture {
  std::string name;
  std::vector<Index> vertices;
  std::vector<Vec3d> displacements;  // displacements of the vertices [m]; none: a force acts on them
  Vec3d force = Vec3d::Zero();       // total force [N], in addition to the loads of the setup
};

// The setup at the end of a gesture: the vertices that it moves are prescribed, and there are no tools.
Setup at_the_end_of(const Gesture& gesture, const Setup& setup);

// The gestures that the grasps of a setup make, each at its furthest place. Empty if there are no grasps.
std::vector<Gesture> gestures_of_grasps(const Setup& setup);

// A demand on a body in static equilibrium: what holds and loads it, without tools.
struct StaticLoad {
  std::string name;
  Setup setup;
  std::vector<Index> moved;  // vertices that the gesture moves; none: it is the weight
};
// First the weight (by the setup's gravity, or 9.81 m/s² along −z if it has none), then each grasp at its
// furthest place. The loads of the setup act in all of them.
std::vector<StaticLoad> static_loads(const Setup& setup);

// Usual gestures: pulls at five places of the free surface, outwards by a tenth of the body's diagonal. The
// places are as far as possible from each other and from held vertices.
std::vector<Gesture> usual_gestures(const Setup& setup);

}  // namespace lobe
