// What is done to a body, as data: edits that users ask for, and what a world then lists in its journal.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>
#include <variant>
#include <vector>

#include "lobe/forces/applied_forces.h"
#include "lobe/scalpel/grains.h"

namespace lobe {

// ---- Edits of the body

struct RemoveTets {
  std::vector<Index> tets;
  bool operator==(const RemoveTets&) const = default;
  static constexpr auto fields = std::tuple(&RemoveTets::tets);
};

// Changes the model of tetrahedra. Displacements and velocities stay, except where vertices become the
// interior of a pre-computed region.
struct SetRegion {
  std::vector<Index> tets;
  RegionModel model = RegionModel::nonlinear;
  bool operator==(const SetRegion&) const = default;
  static constexpr auto fields = std::tuple(&SetRegion::tets, &SetRegion::model);
};

// Expands pre-computed regions: they are non-linear until Condense. Needs an expandable setup.
struct Expand {
  bool operator==(const Expand&) const = default;
  static constexpr auto fields = std::tuple();
};

// Condenses an expanded region again. Its interior then takes its displacements from the interface. Refused
// if an edit has changed the region since the last Relinearise.
struct Condense {
  bool operator==(const Condense&) const = default;
  static constexpr auto fields = std::tuple();
};

// Relinearises pre-computed regions about the present state. Another thread does the work. The result is used
// from the first frame that starts `delay` later; if it is not ready by then, the world waits for it.
struct Relinearise {
  double delay = 0;  // [s], > 0
  bool operator==(const Relinearise&) const = default;
  static constexpr auto fields = std::tuple(&Relinearise::delay);
};

// Sets the degree of selective masses, one of Inertia::degrees(), between two frames. Displacements stay. If
// the degree grows, velocities lose their short waves.
struct SetMassDegree {
  int degree = 1;
  bool operator==(const SetMassDegree&) const = default;
  static constexpr auto fields = std::tuple(&SetMassDegree::degree);
};

// Makes vertices of reduced regions full for a while, from the next frame on: they do not follow the lattice.
struct KeepFull {
  std::vector<Index> vertices;
  double duration = 0;  // [s], > 0
  bool operator==(const KeepFull&) const = default;
  static constexpr auto fields = std::tuple(&KeepFull::vertices, &KeepFull::duration);
};

// Sets external forces on vertices [N]. They replace the previous ones.
struct SetForces {
  std::vector<VertexLoad> forces;
  bool operator==(const SetForces&) const = default;
  static constexpr auto fields = std::tuple(&SetForces::forces);
};

// Sets springs from vertices to points. They replace the previous ones. Explicit integrator only.
struct SetSprings {
  std::vector<Spring> springs;
  bool operator==(const SetSprings&) const = default;
  static constexpr auto fields = std::tuple(&SetSprings::springs);
};

// Sets where the points of the springs are at the end of the next frame, 3 × #springs [m]. They move
// uniformly during the frame.
struct MoveSprings {
  Mat3X<double> points;
  bool operator==(const MoveSprings& other) const {
    return points.cols() == other.points.cols() && points == other.points;
  }
  static constexpr auto fields = std::tuple(&MoveSprings::points);
};

// ---- Thread (forces/threads.h). An application chooses its number; threads of a scene have 0, 1, 2 … in
// the order of its stitches.

struct BringThread {
  int thread = 0;  // number ≥ 0 that no thread has
  ThreadMaterial material;
  bool operator==(const BringThread&) const = default;
  static constexpr auto fields = std::tuple(&BringThread::thread, &BringThread::material);
};

// Draws a thread through a point of the tissue, after its earlier bites.
struct Bite {
  int thread = 0;
  EmbeddedPoint point;
  bool operator==(const Bite&) const = default;
  static constexpr auto fields = std::tuple(&Bite::thread, &Bite::point);
};

// Takes the free ends of a thread in a hand at a point [m], or moves them there uniformly during the next
// frame; lets go if it is not `on`. The end after the last bite is always in the hand, the one before the
// first bite as long as there is no knot.
struct Pull {
  int thread = 0;
  bool on = true;
  Vec3d point = Vec3d::Zero();
  bool operator==(const Pull&) const = default;
  static constexpr auto fields = std::tuple(&Pull::thread, &Pull::on, &Pull::point);
};

// Closes the thread between two bites to a loop, with a knot, and draws it together by `tighten` [m] in the
// time `over` [s]. The hand lets go.
struct Tie {
  int thread = 0;
  Index from = 0, to = 1;  // bites, counted from 0 in the order in which they were sewn
  double tighten = 0, over = 0.2;
  bool operator==(const Tie&) const = default;
  static constexpr auto fields = std::tuple(&Tie::thread, &Tie::from, &Tie::to, &Tie::tighten, &Tie::over);
};

// Cuts a thread after one of its bites: a loop opens, and what was taut is slack up to the next knot.
struct CutThread {
  int thread = 0;
  Index after = 0;  // a bite, counted from 0 in the order in which they were sewn
  bool operator==(const CutThread&) const = default;
  static constexpr auto fields = std::tuple(&CutThread::thread, &CutThread::after);
};

// ---- Attachments (forces/attachments.h), which have names.

// Ties points to each other or to the world. No strand of an attachment of this name may be left.
struct Attach {
  AttachmentSetup attachment;
  bool operator==(const Attach&) const = default;
  static constexpr auto fields = std::tuple(&Attach::attachment);
};

// Cuts all strands of an attachment.
struct Detach {
  std::string attachment;
  bool operator==(const Detach&) const = default;
  static constexpr auto fields = std::tuple(&Detach::attachment);
};

using Edit =
    std::variant<RemoveTets, SetRegion, Expand, Condense, Relinearise, SetMassDegree, KeepFull, SetForces,
                 SetSprings, MoveSprings, BringThread, Bite, Pull, Tie, CutThread, Attach, Detach>;

// ---- What a body does by itself, and its journal lists

// What a blade has cut in one frame, step by step, by numbers of grains. Tetrahedra were divided once, after
// the last step. The first one is empty; it marks when the grains were made.
struct Incise {
  std::vector<Incision> incisions;
  bool is_empty() const {
    return std::all_of(incisions.begin(), incisions.end(), [](const Incision& i) { return i.empty(); });
  }
  bool operator==(const Incise&) const = default;
  static constexpr auto fields = std::tuple(&Incise::incisions);
};

// Says which vertices were held from then on, where a pre-computed region depends on it.
struct Hold {
  HeldVertices held;
  bool operator==(const Hold&) const = default;
  static constexpr auto fields = std::tuple(&Hold::held);
};

// BeginCondensing: another thread begins to condense pre-computed regions from scratch. EndCondensing: the
// result is used.
struct BeginCondensing {
  double due = 0;  // time when EndCondensing follows [s]
  // Displacements about which the region is relinearised, 3 × #vertices [m]; none: as before.
  std::shared_ptr<const std::vector<double>> about = {};
  bool operator==(const BeginCondensing& other) const {
    return due == other.due && (about == other.about || (about && other.about && *about == *other.about));
  }
  bool is_valid() const {
    return std::isfinite(due) &&
           (!about || std::all_of(about->begin(), about->end(), [](double x) { return std::isfinite(x); }));
  }
  static constexpr auto fields = std::tuple(&BeginCondensing::due, &BeginCondensing::about);
};
struct EndCondensing {
  bool operator==(const EndCondensing&) const = default;
  static constexpr auto fields = std::tuple();
};

// Takes the place of an entry whose effect a later entry has replaced. So the others keep their numbers.
struct Superseded {
  bool operator==(const Superseded&) const = default;
  static constexpr auto fields = std::tuple();
};

// The entries of a journal, in the order in which they were done. RemoveTets and SetRegion are there without
// their consequences, which follow as entries of their own.
using JournalEntry = std::variant<RemoveTets, SetRegion, Expand, Condense, Incise, Hold, BeginCondensing,
                                  EndCondensing, Superseded>;

}  // namespace lobe
