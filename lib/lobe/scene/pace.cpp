#include "lobe/scene/pace.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "lobe/sim/world.h"

namespace lobe {
namespace {

constexpr int most_rounds = 12;  // of measuring levels; squares have grown 12-fold by then

bool is_excluded(const Setup& setup) {
  const auto follows = [](RegionModel model) {
    return model == RegionModel::precomputed || model == RegionModel::reduced;
  };
  return setup.integrator != Integrator::central_difference || setup.selective_mass > 1 ||
         std::any_of(setup.region_of.begin(), setup.region_of.end(), follows);
}

// The setup without tools, loads and contact.
Setup bare(const Setup& setup) {
  Setup bare;
  static_cast<Body&>(bare) = setup;
  bare.prescribed = setup.prescribed;
  bare.partly_held = setup.partly_held;
  return bare;
}

// Corners of the tetrahedra at both ends of each strand.
std::vector<std::vector<Index>> tied_vertices(const Setup& setup) {
  std::vector<std::vector<Index>> groups;
  for (const AttachmentSetup& attachment : setup.attachments)
    for (const StrandSetup& strand : attachment.strands) {
      std::vector<Index>& group = groups.emplace_back();
      for (const EmbeddedPoint* end : {&strand.from, &strand.to})
        if (end->tet >= 0) {
          const auto corners = setup.mesh.tets.col(end->tet);
          group.insert(group.end(), corners.begin(), corners.end());
        }
    }
  return groups;
}

// The setup with some of its tetrahedra, free. Other vertices have no tetrahedron, and stay where they are.
template <class Takes>
Setup part_of(const Setup& setup, Takes&& takes) {
  std::vector<Index> taken;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (takes(t)) taken.push_back(t);
  const auto pick = [&]<class Item>(const std::vector<Item>& items) {
    std::vector<Item> picked;
    if (!items.empty())
      for (Index t : taken) picked.push_back(items[std::size_t(t)]);
    return picked;
  };
  Setup part = bare(setup);
  part.prescribed.clear();
  part.partly_held.clear();
  part.mesh.bodies = {};
  part.mesh.tets = setup.mesh.tets(Eigen::all, taken).eval();
  if (setup.mesh.fibres.cols() > 0) part.mesh.fibres = setup.mesh.fibres(Eigen::all, taken).eval();
  part.mesh.labels = pick(setup.mesh.labels);
  part.material_of = pick(setup.material_of);
  part.region_of = pick(setup.region_of);
  part.shares = pick(setup.shares);
  return part;
}

// Makes the squares of the corners of some tetrahedra `times` as high, at least 1.25 times, and at least the
// highest so high that its level falls, which it does above `most`.
template <class Takes>
void raise_squares(const TetMesh& mesh, Takes&& takes, double most, double times,
                   std::vector<double>& squares) {
  std::vector<bool> is_corner(squares.size(), false);
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (takes(t))
      for (Index v : mesh.tets.col(t)) is_corner[std::size_t(v)] = true;
  double highest = 0;
  for (std::size_t v = 0; v < squares.size(); ++v)
    if (is_corner[v]) highest = std::max(highest, squares[v]);
  if (highest > 0) times = std::max({times, 1.25, 1.1 * most / highest});
  for (std::size_t v = 0; v < squares.size(); ++v)
    if (is_corner[v]) squares[v] *= times;
}

// Whether the tetrahedra of each level alone are stable with its step. Where they are not, the squares of
// their corners are raised. A part may have a higher frequency than its vertices tell with the ratio of the
// stiffest part.
bool are_stable(const Setup& setup, const std::vector<Level>& levels, double time_step, double highest,
                std::vector<double>& squares) {
  bool all = true;
  for (Level l = 1; l <= highest_level; ++l) {
    const auto takes = [&](Index t) { return levels[std::size_t(t)] == l; };
    if (std::find(levels.begin(), levels.end(), l) == levels.end()) continue;
    const double excess = (1 << l) * time_step / World<double>(part_of(setup, takes)).time_step_limit();
    if (excess <= 1) continue;
    all = false;
    raise_squares(setup.mesh, takes, highest / (1 << 2 * l), excess * excess, squares);
  }
  return all;
}

double share_by_patches(Dynamics<double>& body, const std::vector<Level>& of_vertices) {
  std::vector<std::span<const Index>> patches;
  std::vector<double> items;
  body.regions.visit_patches([&](const auto& layout, const auto&) {
    for (Index p = 0; p < layout.patch_count(); ++p) {
      patches.push_back(layout.vertices_of(p));
      items.push_back(layout.patch(p).items);
    }
  });
  const auto vertices_of = [&](Index p) { return patches[std::size_t(p)]; };
  return evaluated_share(levels_of_parts(static_cast<Index>(patches.size()), vertices_of, of_vertices),
                         items);
}

}  // namespace

std::optional<Pace> pace_at_rest(const Setup& setup) {
  if (is_excluded(setup)) return std::nullopt;
  World<double> world(bare(setup));
  Pace pace;
  pace.time_step = world.time_step_limit();
  if (!std::isfinite(pace.time_step)) return std::nullopt;
  std::vector<double> squares;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    squares.push_back(world.step_limit().limiting_square(world.body(), v, 0));
  const double highest = *std::max_element(squares.begin(), squares.end());
  const auto groups = tied_vertices(setup);
  const auto corners_of = [&](Index t) { return setup.mesh.tets.col(t); };
  std::vector<Level> of_vertices, levels;
  int rounds = 0;
  do {
    if (++rounds > most_rounds) return std::nullopt;
    of_vertices = levels_of_vertices(squares, highest);
    step_together(groups, of_vertices);
    levels = levels_of_parts(setup.mesh.tet_count(), corners_of, of_vertices);
    pace.by_tets = evaluated_share(levels, {});
  } while (pace.by_tets <= Pace::worth_telling &&
           !are_stable(setup, levels, pace.time_step, highest, squares));
  pace.materials.resize(setup.materials.size());
  pace.tets_of_level.resize(highest_level + 1, 0);
  for (std::size_t t = 0; t < levels.size(); ++t) {
    Pace::Part& part = pace.materials[setup.material_of[t]];
    part.lowest = std::min(part.lowest, levels[t]);
    part.highest = std::max(part.highest, levels[t]);
    ++pace.tets_of_level[levels[t]];
  }
  pace.by_patches = share_by_patches(world.body(), of_vertices);
  return pace;
}

}  // namespace lobe
