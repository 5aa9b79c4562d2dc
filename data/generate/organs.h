// The shapes of data/: closed formulas, in metres, and the triangles made of them.
#pragma once

#include <array>
#include <vector>

#include "distance.h"

namespace organs {

// Axes of the body: +x to the patient's left, +y to the back, +z to the head. Seen from the front (−y), the
// right lobe of the liver is on the left of the picture.
double liver(const Vec3& p);   // negative inside [m]
double kidney(const Vec3& p);  // a right kidney: its hilum looks to +x
// In the fossa of that liver, 2.5 to 3 mm from it, and 2 mm from each other.
double gallbladder(const Vec3& p);  // with its duct
double artery(const Vec3& p);       // of the gallbladder

struct Surface {
  std::vector<Vec3> points;                   // [m]
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise seen from outside
};

// Radius 0.02 m, axis from z = 0 to z = 0.1 m, sharp rims.
Surface cylinder();

}  // namespace organs
