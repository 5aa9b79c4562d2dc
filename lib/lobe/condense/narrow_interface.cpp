#include "lobe/condense/narrow_interface.h"

#include "lobe/mesh/vertex_lists.h"

namespace lobe {
namespace {

// Finds paths from the linear to the non-linear side along edges of the tetrahedra between them, one after
// the other (L. Ford, D. Fulkerson 1956). A vertex has an entrance and an exit, 2 v and 2 v + 1. Only one
// path may go through it. A new path may undo parts of older ones.
class VertexPaths {
 public:
  VertexPaths(const TetMesh& mesh, const std::vector<Side>& sides);

  bool add();  // one more; false if there is none
  // Call it after the last path. Whether a path could still leave the vertex; the vertex is then on the
  // linear side of the cut.
  bool leaves(Index vertex) const { return reached_from_[std::size_t(2 * vertex + 1)] != unknown; }

 private:
  static constexpr Index unknown = -2, source = -1;

  void reach(Index node, Index from);
  void visit(Index node);
  void take(Index exit);

  const TetMesh& mesh_;
  VertexLists<Index> between_;       // the tetrahedra around each vertex that may be on either side
  std::vector<char> starts_, ends_;  // per vertex: whether it belongs to the linear, the non-linear side
  std::vector<char> used_;           // per vertex: whether a path goes through
  std::vector<Index> before_;        // per vertex: the one before it on its path, or the source
  std::vector<Index> reached_from_;  // per node
  std::vector<Index> queue_;         // of nodes
};

VertexPaths::VertexPaths(const TetMesh& mesh, const std::vector<Side>& sides) : mesh_(mesh) {
  const auto vertices = std::size_t(mesh.vertex_count());
  std::vector<Index> lengths(vertices, 0);
  for (auto* flags : {&starts_, &ends_, &used_}) flags->assign(vertices, 0);
  before_.assign(vertices, source);
  for (Index t = 0; t < mesh.tet_count(); ++t)
    for (Index v : mesh.tets.col(t)) {
      lengths[v] += sides[t] == Side::either;
      if (sides[t] == Side::linear) starts_[v] = 1;
      if (sides[t] == Side::nonlinear) ends_[v] = 1;
    }
  between_ = VertexLists<Index>(lengths);
  for (Index t = 0; t < mesh.tet_count(); ++t)
    for (Index v : mesh.tets.col(t))
      if (sides[t] == Side::either) between_.append(v, t);
}

void VertexPaths::reach(Index node, Index from) {
  if (reached_from_[node] != unknown) return;
  reached_from_[node] = from;
  queue_.push_back(node);
}

void VertexPaths::visit(Index node) {
  const Index v = node / 2;
  const bool is_exit = node % 2 == 1;
  if (!is_exit && !used_[v]) reach(2 * v + 1, node);
  if (!is_exit && used_[v] && before_[v] != source) reach(2 * before_[v] + 1, node);
  if (!is_exit) return;
  if (used_[v]) reach(2 * v, node);
  for (Index t : between_[v])
    for (Index w : mesh_.tets.col(t))
      if (w != v) reach(2 * w, node);
}

bool VertexPaths::add() {
  reached_from_.assign(2 * starts_.size(), unknown);
  queue_.clear();
  for (Index v = 0; v < mesh_.vertex_count(); ++v)
    if (starts_[v]) reach(2 * v, source);
  for (std::size_t at = 0; at < queue_.size(); ++at) {
    const Index node = queue_[at];
    if (node % 2 == 1 && ends_[node / 2]) {
      take(node);
      return true;
    }
    visit(node);
  }
  return false;
}

// Follows the new path backwards from the exit where it ends.
void VertexPaths::take(Index node) {
  while (node != source) {
    const Index from = reached_from_[node], v = node / 2;
    if (from == source)
      before_[v] = source;
    else if (from / 2 == v)
      used_[v] = node % 2 == 1;
    else if (node % 2 == 0)
      before_[v] = from / 2;
    node = from;
  }
}

}  // namespace

std::vector<Side> with_narrow_interface(const TetMesh& mesh, std::vector<Side> sides) {
  VertexPaths paths(mesh, sides);
  while (paths.add()) continue;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if (sides[t] != Side::either) continue;
    sides[t] = Side::nonlinear;
    for (Index v : mesh.tets.col(t))
      if (paths.leaves(v)) sides[t] = Side::linear;
  }
  return sides;
}

}  // namespace lobe
