// Needles as they follow cuts, and as they are saved and drawn.
#include <algorithm>

#include "lobe/forces/needles.h"
#include "lobe/forces/saved_terms.h"
#include "lobe/tool/paths.h"

namespace lobe {
namespace io {

template <>
inline constexpr int enum_size<NeedleHold::Kind> = int(NeedleHold::Kind::exit) + 1;
template <>
inline constexpr int enum_size<NeedlePassage::Tip> = int(NeedlePassage::Tip::leaving) + 1;

}  // namespace io

// ---- Cuts

template <class Real>
void Needles<Real>::follow(const Topology& topology, const MeshEdit&) {
  const auto is_lost = [&](const EmbeddedPoint& point) { return !exists(point, topology); };
  for (Needle& needle : state_.needles) needle.passage.forget(is_lost);
  std::erase_if(state_.bites, [&](const NeedleBite& bite) { return is_lost(bite.point); });
  for (Scratch& scratch : scratch_) scratch.candidates.clear();
}

template <class Real>
void Needles<Real>::follow_grains(const Elements& elements, const Grains& grains, const MeshEdit& edit) {
  for (Needle& needle : state_.needles) {
    for (NeedleHold& hold : needle.passage.holds) follow_division(hold.point, elements, grains, edit);
    if (needle.passage.tip != NeedlePassage::Tip::free)
      follow_division(needle.passage.at, elements, grains, edit);
  }
  for (NeedleBite& bite : state_.bites) follow_division(bite.point, elements, grains, edit);
}

// ---- Checkpoints

template <class Real>
bool Needles<Real>::Needle::is_valid() const {
  return settings.is_valid() && is_path(path) && passage.is_valid() &&
         passage.holds.size() <= std::size_t(NeedleGuide::most) && force.allFinite() && torque.allFinite() &&
         std::isfinite(pressed) && pressed >= 0;
}

template <class Real>
std::string Needles<Real>::save() const {
  io::ByteWriter out;
  io::put(out, state_.needles);
  io::put(out, state_.bites);
  io::put(out, state_.events);
  io::put(out, state_.ledger);
  io::put(out, state_.near);
  io::put(out, there_);
  return out.bytes();
}

template <class Real>
void Needles<Real>::load(const std::string& saved, Index vertices) {
  io::ByteReader in("checkpoint", saved);
  State found;
  std::vector<int> there;
  io::get(in, found.needles);
  for (std::size_t i = 1; i < found.needles.size(); ++i)
    in.expect(found.needles[i].tool > found.needles[i - 1].tool);
  io::get(in, found.bites);
  io::get(in, found.events);
  io::get(in, found.ledger);
  io::get(in, found.near);
  for (const Index v : found.near) in.expect(v >= 0 && v < vertices);
  io::get(in, there);
  in.expect_end();
  state_ = std::move(found);
  there_ = std::move(there);
  scratch_.assign(state_.needles.size(), {});
  is_solved_ = false;
}

// ---- For readers

template <class Real>
std::vector<NeedleFigures> Needles<Real>::figures() const {
  std::vector<NeedleFigures> all;
  for (const Needle& needle : state_.needles) {
    const NeedlePassage& passage = needle.passage;
    NeedleFigures& own = all.emplace_back();
    own.tool = needle.tool;
    own.name = needle.name;
    own.tip = passage.tip;
    if (passage.tip != NeedlePassage::Tip::free) own.at = passage.at;
    own.inside = passage.length_inside(needle.settings.shape);
    for (const NeedleHold& hold : passage.holds) {
      own.entries += hold.kind == NeedleHold::Kind::entry;
      own.exits += hold.kind == NeedleHold::Kind::exit;
      own.holds.push_back(hold.point);
    }
    own.force = needle.force;
    own.torque = needle.torque;
    own.pressed = needle.pressed;
  }
  return all;
}

template <class Real>
std::vector<TermLines> Needles<Real>::lines(const At& at) const {
  constexpr int segments = 24;
  std::vector<TermLines> all;
  for (const Needle& needle : state_.needles) {
    if (!needle.is_there(at.time)) continue;
    const NeedlePose pose = needle.pose(at.time);
    const NeedleShape& shape = needle.settings.shape;
    TermLines& lines = all.emplace_back(TermLines{term_name, needle.name, needle.tool});
    lines.ends.resize(3, 2 * segments);
    for (Eigen::Index i = 0; i < 2 * segments; ++i)
      lines.ends.col(i) = pose.place(shape, shape.length() * double((i + 1) / 2) / segments);
    lines.tensions.assign(segments, 0);
  }
  return all;
}

}  // namespace lobe
