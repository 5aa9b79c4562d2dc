// The parts of `lobe bench scalpel`: strokes through a body and what they cost, and a beam with a slit.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "benchmarks/benchmarks.h"
#include "lobe/sim/world.h"

namespace lobe::bench {

constexpr double cut_frame = 1e-4;  // what is timed is the cut, not the steps [s]

struct FullStroke {
  BladePose from, to;
};

// All the way through a mesh, along a plane that is aslant to everything.
FullStroke full_stroke(const TetMesh& mesh, Vec3d normal = {1, 0.21, 0.13});

// From its start to its end, evenly, in so many frames, from the middle of frame `first` on.
ScalpelSetup on_path(const FullStroke& stroke, int frames, int first = 0);

struct CutFrames {
  double seconds = 0;               // of wall time, of all frames [s]
  double cutting = 0, slowest = 0;  // of those in which something was cut, and of the slowest of these [s]
  int frames = 0;                   // in which something was cut
  double area = 0;                  // that was opened [m²]
};

template <class Real>
CutFrames play_cut(World<Real>& world, int frames) {
  CutFrames played;
  for (int i = 0; i <= frames; ++i) {
    const Report report = world.advance(cut_frame);
    if (!report.ok) throw WrongResult("a cut body could not be advanced");
    const double seconds = report.seconds[std::size_t(Phase::cutting)];
    played.seconds += seconds;
    if (report.cut_area == 0) continue;
    played.area += report.cut_area;
    played.cutting += seconds;
    played.slowest = std::max(played.slowest, seconds);
    ++played.frames;
  }
  return played;
}

// In the middle of a body.
struct ShortBlades {
  double frame_ms = 0, slowest_ms = 0;  // of 40 mm at 50 mm/s, 30 frames a second; frames that open something
  double tet_us = 0, tets = 0;          // per tetrahedron that it cuts; how many these are per such frame
  double single_us = 0;    // per tetrahedron, of a blade of two edges that cuts about one in each frame
  double single_tets = 0;  // that are cut there per frame
  double error = 0;        // largest difference to a world built afresh
};

struct CostRow {
  std::string mesh;
  const char* region;
  Index tets = 0, cut = 0, copies = 0;
  int frames = 0;                      // of the 60 of a stroke: those that open something
  double geometry_us = 0, all_us = 0;  // per cut tetrahedron, of a stroke of 60 frames
  double sweep_us = 0, batch_us = 0;   // the same of a stroke that is one sweep; that is one frame
  ShortBlades blades = {};
  double step_ratio = 0;   // after the cut, against before
  double fresh_ratio = 0;  // the same of a world that was built from the cut body
  double loose_ratio = 0;  // after the cut where nothing holds one half, which is non-linear then
  double bytes = 0;        // of grains per cut tetrahedron
  double world_bytes = 0;  // of all that a world allocates, per cut tetrahedron, in seven cuts after a first
  double error = 0;        // largest difference to a world built afresh
};

// Throws WrongResult if the cut world is not one built afresh.
CostRow measure_costs(const std::string& mesh, const char* region, const Setup& setup);
// The median of so many worlds; throws as well.
ShortBlades measure_short_blades(const std::string& mesh, const Setup& setup, int worlds);
// Of one full cut in 60 frames, per cut tetrahedron.
double full_cut_us(const Setup& setup);
void print_head_of_costs();
void print(const CostRow& row);
std::string csv(const std::vector<CostRow>& rows);

// A beam that is held at one end, with an oblique slit from above through half of it.
struct BeamRow {
  double cell_mm = 0;
  Index tets = 0, grains = 0;
  double whole = 0, cut = 0, conforming = 0;  // sag of its end [m]
  double rim = 0;  // by how much the slit goes beyond what the blade swept, in mean edges of the mesh
};

// Of 16 n × 4 n × 4 n cells.
BeamRow measure_beam(int n);

// The sags of both kinds as s - c hᵖ, with one s and orders p of their own: the least squares over all p that
// are multiples of 0.01.
struct SagOrders {
  double limit = 0;                // s [m]
  double cut = 0, conforming = 0;  // p
  double rms = 0;                  // of what is left [m]
  double least = 0, most = 0;      // of both orders where any one mesh is left out; 0: too few meshes
};
SagOrders fit_orders(const std::vector<BeamRow>& rows);  // at least three

}  // namespace lobe::bench
