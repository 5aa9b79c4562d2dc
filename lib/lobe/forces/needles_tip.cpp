// The tips of needles: where they are in the tissue, and where they meet its surface.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "lobe/forces/needles.h"
#include "lobe/sort_unique.h"
#include "lobe/tool/paths.h"

namespace lobe {
namespace {

using Tip = NeedlePassage::Tip;

// Entries and exits need places of their own besides those of the holds inside.
constexpr std::size_t most_with_inside = NeedleGuide::most - 10;
// A tip that is this share of a triangle's edge beyond it when it is first seen is on it.
constexpr double slack_of_meeting = 1e-3;

template <class At>
Mat34<double> tet_now(Index tet, const At& at) {
  const Elements& elements = at.model.elements;
  return elements.corner_points(tet) +
         at.u(Eigen::all, elements.topology.corners(tet)).template cast<double>();
}

// The unit vector along which a linear function grows that has these values at the corners.
Vec3d steepest(const Eigen::Vector4d& values, const Mat34<double>& corners) {
  Mat3<double> edges;
  Vec3d differences;
  for (int i = 0; i < 3; ++i) {
    edges.row(i) = (corners.col(i + 1) - corners.col(0)).transpose();
    differences[i] = values[i + 1] - values[0];
  }
  // edges · g = differences, by Cramer's rule: the length is of no matter, but the sign is.
  const Vec3d a = edges.row(0), b = edges.row(1), c = edges.row(2);
  const Vec3d scaled =
      differences[0] * b.cross(c) + differences[1] * c.cross(a) + differences[2] * a.cross(b);
  return (a.dot(b.cross(c)) < 0 ? -1 : 1) * scaled.normalized();
}

double longest_edge(const Mat3<double>& triangle) {
  double longest = 0;
  for (int i = 0; i < 3; ++i)
    longest = std::max(longest, (triangle.col((i + 1) % 3) - triangle.col(i)).norm());
  return longest;
}

template <class Real>
Mat3<double> triangle_at(const std::array<Eigen::Vector4i, 3>& vertices,
                         const std::array<Eigen::Vector4d, 3>& weights, const Elements& elements,
                         const Mat3X<Real>& u) {
  Mat3<double> x = Mat3<double>::Zero();
  for (int k = 0; k < 3; ++k)
    for (int c = 0; c < 4; ++c) {
      const Index v = vertices[std::size_t(k)][c];
      x.col(k) +=
          weights[std::size_t(k)][c] * (Vec3d(elements.points.col(v)) + u.col(v).template cast<double>());
    }
  return x;
}

}  // namespace

template <class Real>
Vec3d Needles<Real>::outwards(const NeedlePassage& passage, const At& at) const {
  return steepest(passage.level, tet_now(passage.at.tet, at));
}

// ---- Before the steps of a frame

// A box around the way of the tip in the frame.
template <class Real>
Eigen::AlignedBox3d Needles<Real>::reach_of_tip(const Needle& needle) const {
  constexpr int parts = 8;
  Eigen::AlignedBox3d box;
  double way = 0;
  Vec3d before = needle.pose(from_).place(needle.settings.shape, 0);
  for (int i = 0; i <= parts; ++i) {
    const double time = from_ + (to_ - from_) * i / parts;
    const Vec3d tip = needle.pose(time).place(needle.settings.shape, 0);
    way += (tip - before).norm();
    before = tip;
    box.extend(tip);
  }
  box.min().array() -= way;
  box.max().array() += way;
  return box;
}

template <class Real>
void Needles<Real>::look_ahead(const At& at) {
  state_.near.clear();
  scratch_.resize(state_.needles.size());
  for (std::size_t i = 0; i < state_.needles.size(); ++i) {
    const Needle& needle = state_.needles[i];
    scratch_[i].candidates.clear();
    if (needle.path.empty() || needle.appears > to_ || needle.goes < from_) continue;
    if (surface_) find_candidates(needle, *surface_, at, scratch_[i]);
    find_near(needle, scratch_[i], at);
  }
  sort_unique(state_.near);
  surface_ = nullptr;
}

// The triangles that are no further from the tip's way than their longest edge: tissue moves by less in a
// frame.
template <class Real>
void Needles<Real>::find_candidates(const Needle& needle, const SurfaceMesh& surface, const At& at,
                                    Scratch& scratch) {
  const Elements& elements = at.model.elements;
  const Eigen::AlignedBox3d reach = reach_of_tip(needle);
  std::vector<const SurfaceMesh::Within*> within(std::size_t(surface.vertex_count()), nullptr);
  for (const SurfaceMesh::Within& each : surface.within) within[std::size_t(each.vertex)] = &each;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    Candidate candidate{surface.owner[t], {}, {}};
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = surface.triangles[t][int(k)];
      const SurfaceMesh::Within* inner = within[std::size_t(v)];
      candidate.vertices[k] =
          inner ? inner->corners : Eigen::Vector4i::Constant(surface.mesh_vertex[std::size_t(v)]);
      candidate.weights[k] = inner ? inner->weights : Eigen::Vector4d::UnitX();
    }
    const Mat3<double> x = triangle_at(candidate.vertices, candidate.weights, elements, at.u);
    Eigen::AlignedBox3d box(x.rowwise().minCoeff(), x.rowwise().maxCoeff());
    const double margin = longest_edge(x);
    box.min().array() -= margin;
    box.max().array() += margin;
    if (box.intersects(reach)) scratch.candidates.push_back(candidate);
  }
  std::sort(scratch.candidates.begin(), scratch.candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::pair(a.owner.tet, a.owner.code) < std::pair(b.owner.tet, b.owner.code);
  });
}

// The corners of the tetrahedra to which the tip may come, from those on: from neighbour to neighbour.
template <class Real>
void Needles<Real>::find_near(const Needle& needle, const Scratch& scratch, const At& at) {
  const Topology& topology = at.model.elements.topology;
  const Eigen::AlignedBox3d reach = reach_of_tip(needle);
  std::vector<Index> found;
  const auto add = [&](Index tet) {
    if (std::find(found.begin(), found.end(), tet) != found.end()) return;
    const Mat34<double> x = tet_now(tet, at);
    Eigen::AlignedBox3d box(x.rowwise().minCoeff(), x.rowwise().maxCoeff());
    const double margin = (box.max() - box.min()).maxCoeff() / 2;
    box.min().array() -= margin;
    box.max().array() += margin;
    if (box.intersects(reach)) found.push_back(tet);
  };
  if (needle.passage.tip != Tip::free) found.push_back(needle.passage.at.tet);
  for (const Candidate& candidate : scratch.candidates) add(candidate.owner.tet);
  for (std::size_t i = 0; i < found.size(); ++i)
    topology.for_neighbours(found[i], [&](int, Index other) { add(other); });
  for (const Index tet : found)
    for (const Index v : topology.corners(tet)) state_.near.push_back(v);
}

// ---- At the start of a step

template <class Real>
void Needles<Real>::move_tip(Needle& needle, Scratch& scratch, const At& at, const Mat3X<Real>& f) {
  if (needle.passage.tip == Tip::inside) walk(needle, at);
  if (!needle.passage.touches()) seek_surface(needle, scratch, at, f);
}

// Follows the tip through the tissue. If it is out of it without having touched the surface from inside, as
// where that was cut open around it, it has come out; unless it was drawn back, which draw_back() sees.
template <class Real>
void Needles<Real>::walk(Needle& needle, const At& at) {
  NeedlePassage& passage = needle.passage;
  const NeedleShape& shape = needle.settings.shape;
  const Elements& elements = at.model.elements;
  const NeedlePose now = needle.pose(at.time);
  const Vec3d tip = now.place(shape, 0);
  const EmbeddedPoint moved = moved_through(passage.at, tip, elements, grains_, at.u);
  if (moved.tet >= 0)
    passage.go_to(moved, needle.spacing(), most_with_inside);
  else if ((tip - position(passage.at, elements, at.u)).dot(now.forward(shape, 0)) > 0) {
    passage.come_out();
    report(Event::Kind::exited, needle, tip, 0);
  }
}

// Finds where the tip meets the surface first in the step, on its way forward through the tissue.
template <class Real>
void Needles<Real>::seek_surface(Needle& needle, const Scratch& scratch, const At& at, const Mat3X<Real>& f) {
  NeedlePassage& passage = needle.passage;
  if (passage.holds.size() + 2 > std::size_t(NeedleGuide::most)) return;
  const NeedleShape& shape = needle.settings.shape;
  const Elements& elements = at.model.elements;
  const bool inwards = passage.tip == Tip::free;
  const NeedlePose now = needle.pose(at.time), next = needle.pose(std::min(at.time + at.kick.dt, to_));
  const Vec3d from = now.place(shape, 0), to = next.place(shape, 0), forward = next.forward(shape, 0);
  double first = std::numeric_limits<double>::infinity();
  for (const Candidate& candidate : scratch.candidates) {
    if (!exists({candidate.owner.tet, {}}, elements.topology)) continue;
    const Mat3<double> x = triangle_at(candidate.vertices, candidate.weights, elements, at.u);
    Mat3<double> moved = x;
    for (std::size_t k = 0; k < 3; ++k)
      for (int c = 0; c < 4; ++c)
        if (candidate.weights[k][c] != 0)
          moved.col(int(k)) +=
              at.kick.dt * candidate.weights[k][c] * end_velocity(candidate.vertices[k][c], at, f);
    const auto met = meeting(from, to, x, moved, inwards, slack_of_meeting * longest_edge(x));
    if (!met || !(met->share < first)) continue;
    const Vec3d normal = (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).normalized();
    const Vec3d way = to - from - (moved - x) * met->weights;
    if (!((inwards ? -1 : 1) * normal.dot(forward) > 0 && way.dot(forward) > 0)) continue;
    const Mat34<double> corners = tet_now(candidate.owner.tet, at);
    const EmbeddedPoint point{candidate.owner.tet, barycentric(corners, Vec3d(x * met->weights))};
    if (!point.is_valid()) continue;
    first = met->share;
    passage.tip = inwards ? Tip::free : Tip::inside;  // the nearest of several takes the place of the others
    passage.touch(point, corners.transpose() * normal);
  }
}

}  // namespace lobe
