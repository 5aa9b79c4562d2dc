#include "lobe_petsc/part.h"

#include <petscmat.h>

#include <algorithm>
#include <array>
#include <string>

#include "lobe/mesh/spatial_order.h"

namespace lobe::petsc {
namespace {

struct Face {
  std::array<Index, 3> corners;  // ascending
  Index tet = 0;
  int face = 0;
  friend auto operator<=>(const Face&, const Face&) = default;
};
struct Neighbour {  // across a face of a tetrahedron; −1: none
  Index tet = 0;
  int face = 0;
  Index other = 0;
};
struct Tet {
  Index number = 0;
  std::array<Index, 4> corners{};
  int label = 0;
  std::array<bool, 4> is_outer{};
  std::array<double, 3> fibre{};
};

// Finds the tetrahedron across each face. All copies of a face are sent to the rank whose slice has its first
// corner, and that rank answers.
std::vector<Neighbour> find_neighbours(const Ranks& ranks, const MeshSlice& slice, const std::string& name) {
  std::vector<std::vector<Face>> to(std::size_t(ranks.count()));
  for (Index t = 0; t < slice.mesh.tet_count(); ++t)
    for (int f = 0; f < 4; ++f) {
      Face face{{}, slice.first_tet + t, f};
      for (int c = 0; c < 3; ++c) face.corners[c] = slice.mesh.tets(face_corners[f][c], t);
      std::sort(face.corners.begin(), face.corners.end());
      to[ranks.holder_of(slice.vertices, face.corners[0])].push_back(face);
    }
  std::vector<Face> faces;
  for (const auto& list : ranks.exchange(to)) faces.insert(faces.end(), list.begin(), list.end());
  std::sort(faces.begin(), faces.end());
  std::vector<std::vector<Neighbour>> back(std::size_t(ranks.count()));
  const auto tell = [&](const Face& face, Index other) {
    back[ranks.holder_of(slice.tets, face.tet)].push_back({face.tet, face.face, other});
  };
  ranks.together([&] {
    for (std::size_t i = 0; i < faces.size();) {
      std::size_t end = i + 1;
      while (end < faces.size() && faces[end].corners == faces[i].corners) ++end;
      if (end - i > 2)
        throw InputError(name + ": tetrahedron " + std::to_string(faces[i].tet),
                         "has a face that " + std::to_string(end - i) + " tetrahedra share; at most two may");
      tell(faces[i], end - i == 2 ? faces[i + 1].tet : -1);
      if (end - i == 2) tell(faces[i + 1], faces[i].tet);
      i = end;
    }
  });
  std::vector<Neighbour> neighbours;
  for (const auto& list : ranks.exchange(back)) neighbours.insert(neighbours.end(), list.begin(), list.end());
  std::sort(neighbours.begin(), neighbours.end(), [](const Neighbour& a, const Neighbour& b) {
    return std::pair(a.tet, a.face) < std::pair(b.tet, b.face);
  });
  return neighbours;  // four per tetrahedron of the slice, in its order
}

// The rank that each tetrahedron of the slice goes to.
std::vector<PetscInt> partition(const Ranks& ranks, const MeshSlice& slice,
                                const std::vector<Neighbour>& neighbours) {
  const PetscInt tets_here = slice.mesh.tet_count();
  std::vector<PetscInt> target(std::size_t(tets_here), 0);
  if (ranks.count() == 1) return target;
  PetscInt *begin = nullptr, *others = nullptr;
  check(PetscMalloc1(tets_here + 1, &begin));
  check(PetscMalloc1(neighbours.size() + 1, &others));
  PetscInt at = 0;
  for (PetscInt t = 0; t < tets_here; ++t) {
    begin[t] = at;
    for (int f = 0; f < 4; ++f)
      if (const Index other = neighbours[std::size_t(4 * t + f)].other; other >= 0) others[at++] = other;
    std::sort(others + begin[t], others + at);
  }
  begin[tets_here] = at;
  Owned<Mat, MatDestroy> graph;
  check(MatCreateMPIAdj(ranks.comm(), tets_here, slice.tets, begin, others, nullptr, graph.fill()));
  Owned<MatPartitioning, MatPartitioningDestroy> partitioning;
  check(MatPartitioningCreate(ranks.comm(), partitioning.fill()));
  check(MatPartitioningSetAdjacency(partitioning, graph));
  check(MatPartitioningSetType(partitioning, MATPARTITIONINGPTSCOTCH));
  check(MatPartitioningSetFromOptions(partitioning));
  Owned<IS, ISDestroy> parts;
  check(MatPartitioningApply(partitioning, parts.fill()));
  const PetscInt* values = nullptr;
  check(ISGetIndices(parts, &values));
  std::copy(values, values + tets_here, target.begin());
  check(ISRestoreIndices(parts, &values));
  return target;
}

std::vector<Tet> move_tets(const Ranks& ranks, const MeshSlice& slice, const std::string& name) {
  const std::vector<Neighbour> neighbours = find_neighbours(ranks, slice, name);
  const std::vector<PetscInt> target = partition(ranks, slice, neighbours);
  std::vector<std::vector<Tet>> to(std::size_t(ranks.count()));
  for (Index t = 0; t < slice.mesh.tet_count(); ++t) {
    Tet tet{slice.first_tet + t};
    for (int c = 0; c < 4; ++c) tet.corners[c] = slice.mesh.tets(c, t);
    for (int f = 0; f < 4; ++f) tet.is_outer[f] = neighbours[std::size_t(4 * t + f)].other < 0;
    tet.label = slice.mesh.labels[std::size_t(t)];
    if (slice.mesh.fibres.cols() > 0)
      for (int i = 0; i < 3; ++i) tet.fibre[i] = slice.mesh.fibres(i, t);
    to[target[std::size_t(t)]].push_back(tet);
  }
  std::vector<Tet> tets;
  for (const auto& list : ranks.exchange(to)) tets.insert(tets.end(), list.begin(), list.end());
  std::sort(tets.begin(), tets.end(), [](const Tet& a, const Tet& b) { return a.number < b.number; });
  return tets;
}

struct Place {
  int owner = 0;
  std::array<double, 3> point{};
};

// The rank that has read a vertex tells each rank with a tetrahedron of it who owns the vertex, and its
// position.
std::vector<std::vector<Place>> ask_places(const Ranks& ranks, const MeshSlice& slice,
                                           const std::vector<std::vector<Index>>& asked) {
  const std::vector<std::vector<Index>> by = ranks.exchange(asked);
  std::vector<int> owner(std::size_t(slice.mesh.vertex_count()), ranks.count());
  for (int r = ranks.count() - 1; r >= 0; --r)
    for (Index v : by[r]) owner[v - slice.first_vertex] = r;
  std::vector<std::vector<Place>> answers(by.size());
  for (std::size_t r = 0; r < by.size(); ++r)
    for (Index v : by[r]) {
      const auto X = slice.mesh.points.col(v - slice.first_vertex);
      answers[r].push_back({owner[v - slice.first_vertex], {X[0], X[1], X[2]}});
    }
  return ranks.exchange(answers);
}

// Numbers the owned vertices, and learns the numbers of the ghosts from their owners.
void number_vertices(const Ranks& ranks, const std::vector<int>& owner, Part& part) {
  const PetscInt first = PetscInt(ranks.sum_before(std::int64_t(part.owned)));
  part.all_owned = Index(ranks.sum(std::int64_t(part.owned)));
  part.global.resize(part.vertex_number.size());
  std::iota(part.global.begin(), part.global.begin() + part.owned, first);
  std::vector<std::vector<Index>> ghosts(std::size_t(ranks.count())), local = ghosts;
  for (Index v = part.owned; v < part.mesh.vertex_count(); ++v) {
    ghosts[owner[v]].push_back(part.vertex_number[v]);
    local[owner[v]].push_back(v);
  }
  std::vector<std::vector<Index>> asked = ranks.exchange(ghosts);
  for (auto& list : asked)
    for (Index& number : list) number = part.global[part.vertex_of(number)];
  const std::vector<std::vector<Index>> answers = ranks.exchange(asked);
  for (std::size_t r = 0; r < answers.size(); ++r)
    for (std::size_t i = 0; i < answers[r].size(); ++i) part.global[local[r][i]] = answers[r][i];
}

void take_vertices(const Ranks& ranks, const MeshSlice& slice, const std::vector<Tet>& tets, Part& part) {
  std::vector<Index> numbers;
  for (const Tet& tet : tets) numbers.insert(numbers.end(), tet.corners.begin(), tet.corners.end());
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  std::vector<std::vector<Index>> asked(std::size_t(ranks.count()));
  for (Index v : numbers) asked[ranks.holder_of(slice.vertices, v)].push_back(v);  // in order
  std::vector<Place> places;
  for (const auto& list : ask_places(ranks, slice, asked))
    places.insert(places.end(), list.begin(), list.end());

  Mat3X<double> points(3, Eigen::Index(numbers.size()));
  for (std::size_t i = 0; i < numbers.size(); ++i)
    points.col(Eigen::Index(i)) = Vec3d(places[i].point.data());
  std::vector<Index> order = spatial_order(points);
  std::stable_partition(order.begin(), order.end(), [&](Index i) { return places[i].owner == ranks.rank(); });
  std::vector<int> owner;
  part.mesh.points.resize(3, points.cols());
  for (Index i : order) {
    part.mesh.points.col(Index(owner.size())) = points.col(i);
    part.by_number.emplace_back(numbers[i], Index(owner.size()));
    part.vertex_number.push_back(numbers[i]);
    part.owned += places[i].owner == ranks.rank();
    owner.push_back(places[i].owner);
  }
  std::sort(part.by_number.begin(), part.by_number.end());
  number_vertices(ranks, owner, part);
}

// Corners, labels and fibres in local numbers. prepare() swaps corners 2 and 3 of tetrahedra that are inside
// out, and so the faces opposite to these corners.
void take_tets(const std::vector<Tet>& tets, bool fibres, const std::string& name, Part& part) {
  const auto count = Eigen::Index(tets.size());
  part.mesh.tets.resize(4, count);
  part.mesh.fibres.resize(3, fibres ? count : 0);
  for (Index t = 0; t < count; ++t) {
    for (int c = 0; c < 4; ++c) part.mesh.tets(c, t) = part.vertex_of(tets[t].corners[c]);
    part.mesh.labels.push_back(tets[t].label);
    part.tet_number.push_back(tets[t].number);
    if (fibres) part.mesh.fibres.col(t) = Vec3d(tets[t].fibre.data());
  }
  prepare(part.mesh, name);
  for (Index t = 0; t < count; ++t) {
    const bool swapped = part.mesh.tets(2, t) != part.vertex_of(tets[t].corners[2]);
    for (int f = 0; f < 4; ++f)
      if (tets[t].is_outer[swapped && f >= 2 ? 5 - f : f]) part.outer.push_back({t, f});
  }
}

Index find(const std::vector<std::pair<Index, Index>>& pairs, Index number) {
  const auto at = std::lower_bound(pairs.begin(), pairs.end(), std::pair(number, Index(0)));
  return at != pairs.end() && at->first == number ? at->second : -1;
}

}  // namespace

Index Part::vertex_of(Index number) const { return find(by_number, number); }
Index Part::tet_of(Index number) const {
  const auto at = std::lower_bound(tet_number.begin(), tet_number.end(), number);
  return at != tet_number.end() && *at == number ? Index(at - tet_number.begin()) : -1;
}

Part make_part(const Ranks& ranks, MeshSlice slice, const std::string& name) {
  Part part;
  part.all_tets = slice.tets;
  part.all_vertices = slice.vertices;
  if (slice.tets < ranks.count())
    throw InputError(name, std::to_string(slice.tets) + " tetrahedra for " + std::to_string(ranks.count()) +
                               " ranks: start at most as many ranks as there are tetrahedra");
  const std::vector<Tet> tets = move_tets(ranks, slice, name);
  ranks.together([&] {
    if (tets.empty())
      throw InputError(name, "rank " + std::to_string(ranks.rank()) +
                                 " is left without a tetrahedron: start fewer ranks for so small a mesh");
  });
  const bool fibres = ranks.max(slice.mesh.fibres.cols() > 0 ? 1.0 : 0.0) > 0;
  take_vertices(ranks, slice, tets, part);
  slice = {};
  const std::string place =
      ranks.count() == 1 ? name : name + ", part of rank " + std::to_string(ranks.rank());
  ranks.together([&] { take_tets(tets, fibres, place, part); });
  return part;
}

}  // namespace lobe::petsc
