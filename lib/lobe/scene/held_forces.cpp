#include "lobe/scene/held_forces.h"

#include <array>
#include <map>

namespace lobe {
namespace {

// Per vertex of the mesh at the start: its copies, which lie where it lay.
std::map<Index, std::vector<Index>> copies_of(const std::vector<HeldEntry>& entries, const Elements& elements,
                                              Index first_copy) {
  std::map<Index, std::vector<Index>> copies;
  const Index count = elements.topology.vertex_count();
  if (first_copy >= count) return copies;
  std::map<std::array<double, 3>, Index> at;
  const auto place = [&](Index v) {
    const Vec3d X = elements.points.col(v);
    return std::array{X.x(), X.y(), X.z()};
  };
  for (const HeldEntry& entry : entries)
    for (const Index v : entry.vertices) at[place(v)] = v;
  for (Index v = first_copy; v < count; ++v)
    if (const auto found = at.find(place(v)); found != at.end()) copies[found->second].push_back(v);
  return copies;
}

}  // namespace

template <class Real>
Mat3X<double> reactions_of(World<Real>& world) {
  const Mat3X<double> forces = world.forces().template cast<double>();
  Dynamics<Real>& body = world.body();
  body.recover(Regions<Real>::Interior::all);
  Mat3X<double> reactions = Mat3X<double>::Zero(3, forces.cols());
  for (const HeldVertices::Held& item : world.held().all()) {
    const Index v = item.vertex;
    const Vec3d inside = body.regions.force_on_fixed(body.model.elements, body.motion.u.padded(), v);
    for (int i = 0; i < 3; ++i)
      if (item.axes[i]) reactions(i, v) = -forces(i, v) - inside[i];
  }
  return reactions;
}

template Mat3X<double> reactions_of(World<float>&);
template Mat3X<double> reactions_of(World<double>&);

std::vector<Vec3d> held_forces(const std::vector<HeldEntry>& entries, const Elements& elements,
                               const Mat3X<double>& reactions) {
  std::vector<Vec3d> forces;
  const auto copies = copies_of(entries, elements, entries.empty() ? 0 : entries.front().mesh_vertices);
  for (const HeldEntry& entry : entries) {
    Vec3d sum = Vec3d::Zero();
    const auto add = [&](Index v, const Axes& axes) {
      for (int i = 0; i < 3; ++i)
        if (axes[i]) sum[i] += reactions(i, v);
    };
    for (std::size_t k = 0; k < entry.vertices.size(); ++k) {
      add(entry.vertices[k], entry.axes[k]);
      if (const auto split = copies.find(entry.vertices[k]); split != copies.end())
        for (const Index copy : split->second) add(copy, entry.axes[k]);
    }
    forces.push_back(sum);
  }
  return forces;
}

}  // namespace lobe
