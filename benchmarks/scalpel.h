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

// From its start to its end, evenly, in so many frames; the first begins at the middle of a frame.
ScalpelSetup on_path(const FullStroke& stroke, int frames);

struct CutFrames {
  double seconds = 0, slowest = 0;  // of wall time, of all frames and the slowest [s]
  int frames = 0;                   // in which something was cut
};

template <class Real>
CutFrames play_cut(World<Real>& world, int frames) {
  CutFrames played;
  for (int i = 0; i <= frames; ++i) {
    const Report report = world.advance(cut_frame);
    if (!report.ok) throw WrongResult("a cut body could not be advanced");
    if (report.cut_area == 0) continue;
    const double seconds = report.seconds[std::size_t(Phase::cutting)];
    played.seconds += seconds;
    played.slowest = std::max(played.slowest, seconds);
    ++played.frames;
  }
  return played;
}

struct CostRow {
  std::string mesh;
  const char* region;
  Index tets = 0, cut = 0, copies = 0;
  double geometry_us = 0, all_us = 0;   // per cut tetrahedron, of a stroke of 60 frames
  double sweep_us = 0, batch_us = 0;    // the same of a stroke that is one sweep; that is one frame
  double frame_ms = 0, slowest_ms = 0;  // of a blade of 40 mm at 50 mm/s, 30 frames a second
  double step_ratio = 0;                // after the cut, against before
  double fresh_ratio = 0;               // the same of a world that was built from the cut body
  double loose_ratio = 0;  // after the cut where nothing holds one half, which is non-linear then
  double bytes = 0;        // of grains per cut tetrahedron
  double error = 0;        // largest difference to a world built afresh
};

// Throws WrongResult if the cut world is not one built afresh.
CostRow measure_costs(const std::string& mesh, const char* region, const Setup& setup);
void print_head_of_costs();
void print(const CostRow& row);
std::string csv(const std::vector<CostRow>& rows);

// A beam that is held at one end, with an oblique slit from above through half of it.
struct BeamRow {
  double cell_mm = 0;
  Index tets = 0, grains = 0;
  double whole = 0, cut = 0, conforming = 0;  // sag of its end [m]
};

// Of 16 n × 4 n × 4 n cells.
BeamRow measure_beam(int n);

}  // namespace lobe::bench
