// What is done to a body, and what must hold: one row of `lobe bench stress`. The stress suite is a list of
// these.
#pragma once

#include <string>
#include <vector>

#include "lobe/setup/setup.h"

namespace lobe::stress {

enum class Must {
  recover,      // advances throughout, and is back at rest, nothing inverted, at the end
  survive,      // advances throughout, all values finite
  report,       // advances, or is refused or stops and says by name why; all values finite
  keep_energy,  // the largest energy of the second half is at most 1.5 times that of the first
  stay,         // displacements exactly zero
  flag,         // its step is too long: that is noticed before a vertex has moved by 1 % of the body
  be_flagged,   // takes steps beyond the limit unchecked, and grows: so the limit is no wider than it says
  vanish        // nothing is left, and it says so
};
const char* name(Must must);

struct Plan {
  std::string name, body, model;
  Must must = Must::survive;
  Setup setup;
  Mat3X<double> u, v;       // at the start, 3 × #vertices [m], [m/s]; empty: zero
  double seconds = 1;       // of advance()
  double frame = 1.0 / 60;  // [s]
  double cut_share = 0;     // of the tetrahedra, removed at random every frame
  long steps = 0;           // if above 0: bare steps in place of advance()
  double step_factor = 0;   // their size, as a share of the limit
};

struct Subject {  // a mesh that is held at its low end along x, and handled at its high one
  std::string name;
  TetMesh mesh;

  std::vector<Index> low_end() const;
  std::vector<Index> high_end() const;
  double length() const;  // [m]
};
Subject box();                            // 162 irregular tetrahedra, 3 cm long
std::vector<Subject> organs(bool quick);  // the shipped meshes

// Every model and mixture of models: "mixed", "precomputed" and "corotated" (precomputed, in a frame that
// turns with it) are linear in their low half and non-linear in the other; "selective" has selective masses
// beside the volume term; "reduced" is so throughout, with cells of the size that lobe chooses. Then all of
// them with edge-smoothed tetrahedra, as "smoothed mixed".
const std::vector<std::string>& models();
std::string kind_of(const std::string& model);  // without "smoothed "
// A guarded body of soft tissue, held at its low end if asked, damped.
Setup tissue(const TetMesh& mesh, const std::string& model);
Setup held_tissue(const Subject& subject, const std::string& model);

std::vector<Plan> all_plans(bool quick);
void add_time_step_plans(std::vector<Plan>& plans, bool quick);
void add_shape_plans(std::vector<Plan>& plans, const Subject& subject, const std::string& model);
void add_gesture_plans(std::vector<Plan>& plans, const Subject& subject, const std::string& model);
void add_probe_plans(std::vector<Plan>& plans, const Subject& subject, const std::string& model);
void add_material_plans(std::vector<Plan>& plans);
void add_mesh_plans(std::vector<Plan>& plans);

}  // namespace lobe::stress
