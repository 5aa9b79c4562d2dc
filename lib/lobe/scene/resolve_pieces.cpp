#include <algorithm>

#include "lobe/mesh/topology.h"
#include "lobe/scene/resolve_parts.h"

namespace lobe {
namespace {

constexpr std::size_t most_named = 5;

// Whatever boundary conditions, grasps, or a piece that they hold keep in place.
std::vector<char> held_from_the_start(const Setup& setup) {
  std::vector<char> held(std::size_t(setup.mesh.vertex_count()), 0);
  for (const PrescribedVertex& p : setup.prescribed) held[std::size_t(p.vertex)] = 1;
  for (const PartlyHeldVertex& p : setup.partly_held) held[std::size_t(p.vertex)] = 1;
  for (const GraspSetup& grasp : setup.grasps)
    for (const Index v : grasp.vertices)
      if (v < setup.mesh.vertex_count()) held[std::size_t(v)] = 1;
  return held;
}

// Whether an attachment ties a tetrahedron to the world or to what is held.
std::vector<char> tied_tets(const Setup& setup, const std::vector<char>& held) {
  std::vector<char> tied(std::size_t(setup.mesh.tet_count()), 0);
  const auto is_held = [&](Index tet) {
    const auto corners = setup.mesh.tets.col(tet);
    return std::any_of(corners.begin(), corners.end(), [&](Index v) { return held[std::size_t(v)] != 0; });
  };
  for (const AttachmentSetup& attachment : setup.attachments)
    for (const StrandSetup& strand : attachment.strands) {
      if (strand.ends_in_world() || is_held(strand.to.tet)) tied[std::size_t(strand.from.tet)] = 1;
      if (!strand.ends_in_world() && is_held(strand.from.tet)) tied[std::size_t(strand.to.tet)] = 1;
    }
  return tied;
}

bool holds_nothing(const Setup& setup) {
  const auto is_tied = [](const AttachmentSetup& attachment) {
    return std::any_of(attachment.strands.begin(), attachment.strands.end(),
                       [](const StrandSetup& strand) { return strand.ends_in_world(); });
  };
  return setup.prescribed.empty() && setup.partly_held.empty() &&
         std::none_of(setup.attachments.begin(), setup.attachments.end(), is_tied);
}

}  // namespace

// Of a body that nothing holds at all another warning says so, and one that an obstacle may carry has none.
void warn_of_unheld_pieces(Resolution& resolution) {
  const Setup& setup = resolution.result.setup;
  if (holds_nothing(setup) || !setup.contact.obstacles.empty()) return;
  std::vector<std::vector<Index>> open = Topology(setup.mesh).pieces();
  std::vector<char> held = held_from_the_start(setup);
  std::vector<char> tied;
  const auto touches = [&](Index tet) {
    const auto corners = setup.mesh.tets.col(tet);
    return tied[std::size_t(tet)] ||
           std::any_of(corners.begin(), corners.end(), [&](Index v) { return held[std::size_t(v)] != 0; });
  };
  for (std::size_t before = open.size() + 1; before > open.size();) {
    before = open.size();
    tied = tied_tets(setup, held);
    std::erase_if(open, [&](const std::vector<Index>& piece) {
      if (std::none_of(piece.begin(), piece.end(), touches)) return false;
      for (const Index t : piece)
        for (const Index v : setup.mesh.tets.col(t)) held[std::size_t(v)] = 1;
      return true;
    });
  }
  for (std::size_t i = 0; i < std::min(open.size(), most_named); ++i)
    resolution.warn("/boundary", "a piece of " + counted(open[i].size(), "tetrahedron", "tetrahedra") +
                                     setup.mesh.bodies.in_words(open[i][0]) + ", among them " +
                                     std::to_string(open[i][0]) + ", is not held and can move freely");
  if (open.size() > most_named)
    resolution.warn("/boundary",
                    std::to_string(open.size() - most_named) + " further pieces are not held either");
}

}  // namespace lobe
