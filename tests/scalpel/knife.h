// A blade through a body at rest, without a world; and what it has left, found by a builder of its own.
#pragma once

#include <array>
#include <map>
#include <numeric>
#include <set>

#include "lobe/scalpel/incise.h"
#include "support.h"

namespace lobe::test {

class Knife {
 public:
  explicit Knife(const TetMesh& mesh, double snap = 0.1, bool along_faces = false)
      : elements(setup_of(mesh)),
        grains(elements),
        snap_(snap),
        along_faces_(along_faces),
        whole_(elements.topology.tet_count()) {
    for (Index t = 0; t < whole_; ++t) all_.push_back(t);
  }

  void set_along_faces(bool along_faces) { along_faces_ = along_faces; }

  void begin() {
    stroke_ = (stroke_ + 1) % Grains::most_strokes;
    grains.forget_stroke(stroke_);
    swept_.clear();
    is_under_way_ = false;
  }

  // The edge moves from one row of points, which is where it is, to another.
  Incised sweep(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to) {
    if (!is_under_way_) swept_.add(from);
    is_under_way_ = true;
    swept_.add(to);
    const Placements at_rest = [&](Index t) {
      const Vec3d start = elements.points.col(elements.topology.corners(t)[0]);
      return Placement{start, start, Mat3<double>::Identity()};
    };
    const Incised incised = incise(grains, {stroke_, snap_, along_faces_}, swept_,
                                   PlacedTets(grains, near(swept_.last()), at_rest));
    area += incised.area;
    crumbs += incised.crumbs;
    opened_ += static_cast<Index>(incised.incision.opened.size());
    if (!incised.opened.empty()) {
      const MeshEdit edit = elements.topology.divide(grains.divide(elements.topology, incised.opened));
      elements.follow(edit);
      for (const TetCopy& tet_copy : edit.copies) all_.push_back(tet_copy.copy);
      cut_off += static_cast<Index>(edit.cut_off.size());
    }
    return incised;
  }

  // An edge of length 2 r about the centre moves along its normal direction, through `part` of 2 r, in steps;
  // it waves by `height` across.
  void plane(const Vec3d& normal, const Vec3d& centre, int steps, double part = 1, double r = 0.2,
             double height = 0, double wave = 1) {
    const Vec3d n = normal.normalized(), along = n.unitOrthogonal(), edge = n.cross(along);
    const auto row = [&](int i) {
      const double x = -r + 2 * r * part * i / steps;
      const Vec3d middle = centre + x * along + height * std::sin(wave * x) * n;
      return std::vector<Vec3d>{middle - r * edge, middle + r * edge};
    };
    begin();
    for (int i = 0; i < steps; ++i) sweep(row(i), row(i + 1));
  }

  Elements elements;
  Grains grains;
  double area = 0;  // opened [m²]
  Index cut_off = 0, crumbs = 0;

 private:
  std::vector<Index> near(const Sheet& sheet) const {
    std::vector<Index> found;
    const double reach = 2 * grains.mean_edge();
    for (Index t : all_) {
      const Mat34<double> X = elements.corner_points(t);
      const Eigen::AlignedBox3d box(X.rowwise().minCoeff(), X.rowwise().maxCoeff());
      if (box.squaredExteriorDistance(sheet.box()) <= reach * reach) found.push_back(t);
    }
    return found;
  }

  double snap_;
  bool along_faces_;
  Index whole_;
  std::vector<Index> all_;
  int stroke_ = -1;
  Index opened_ = 0;
  SweptSheets swept_;
  bool is_under_way_ = false;
};

class Sets {  // that are joined
 public:
  explicit Sets(Index count) : up_(std::size_t(count)) { std::iota(up_.begin(), up_.end(), 0); }
  Index of(Index i) {
    while (up_[std::size_t(i)] != i) i = up_[std::size_t(i)] = up_[std::size_t(up_[std::size_t(i)])];
    return i;
  }
  void join(Index a, Index b) { up_[std::size_t(of(a))] = of(b); }

 private:
  std::vector<Index> up_;
};

// Pieces, vertices and tetrahedra of a cut body from the grains' places and open faces alone: by joining over
// all faces, which are found by the places of their corners.
struct Rebuilt {
  Index pieces = 0, vertices = 0, tets = 0;
  Index faults = 0;                             // faces of three grains, or open on one side
  bool same_vertices = true, same_tets = true;  // as the topology has them
  Index odd_edges = 0;                          // of the surface

  explicit Rebuilt(const Knife& knife);
};

using Place = std::array<double, 3>;
using FacePlace = std::array<Place, 3>;

inline Rebuilt::Rebuilt(const Knife& knife) {
  const Grains& grains = knife.grains;
  const Topology& topology = knife.elements.topology;
  const Index n = grains.count();
  const auto place = [&](Index p) {
    const Vec3d& x = grains.point(p);
    return Place{x[0], x[1], x[2]};
  };
  std::map<FacePlace, std::vector<Index>> faces;
  for (Index g = 0; g < n; ++g)
    for (int f = 0; f < 4; ++f) {
      FacePlace key;
      for (int k = 0; k < 3; ++k) key[std::size_t(k)] = place(grains[g].points[face_corners[f][k]]);
      std::sort(key.begin(), key.end());
      faces[key].push_back(4 * g + f);
    }
  Sets piece(n), fragment(n), surface(4 * n);
  std::vector<std::pair<Index, Index>> links;
  std::vector<Index> outer;
  for (const auto& [key, sides] : faces) {
    faults += sides.size() > 2;
    if (sides.size() < 2) {
      outer.push_back(sides[0]);
      continue;
    }
    const Index a = sides[0] / 4, b = sides[1] / 4;
    const bool open = grains.is_open(a, sides[0] % 4);
    faults += open != grains.is_open(b, sides[1] % 4);
    if (open) {
      outer.insert(outer.end(), sides.begin(), sides.end());
      continue;
    }
    piece.join(a, b);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        if (i != sides[0] % 4 && j != sides[1] % 4 &&
            place(grains[a].points[i]) == place(grains[b].points[j]))
          surface.join(4 * a + i, 4 * b + j);
    if (topology.parent(grains[a].element) == topology.parent(grains[b].element))
      fragment.join(a, b);
    else
      links.push_back({a, b});
  }
  // A link joins the three vertices that two parents have in common.
  Sets vertex(4 * n);
  const auto parent_corner = [&](Index g, int k) {
    return topology.origin(topology.corners(grains[g].element)[k]);
  };
  for (const auto& [a, b] : links)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        if (parent_corner(a, i) == parent_corner(b, j))
          vertex.join(4 * fragment.of(a) + i, 4 * fragment.of(b) + j);
  std::set<Index> all_pieces, all_vertices;
  std::map<Index, Index> number_of;  // of the topology, per vertex here
  std::map<std::pair<Index, std::array<Index, 4>>, std::set<Index>> tets_of;
  std::set<Index> elements;
  for (Index g = 0; g < n; ++g) {
    all_pieces.insert(piece.of(g));
    elements.insert(grains[g].element);
    std::array<Index, 4> corners;
    for (int k = 0; k < 4; ++k) {
      corners[std::size_t(k)] = vertex.of(4 * fragment.of(g) + k);
      const Index corner = topology.corners(grains[g].element)[k];
      same_vertices =
          same_vertices && number_of.emplace(corners[std::size_t(k)], corner).first->second == corner;
      all_vertices.insert(corners[std::size_t(k)]);
    }
    tets_of[{topology.parent(grains[g].element), corners}].insert(grains[g].element);
  }
  for (const auto& [key, own] : tets_of) same_tets = same_tets && own.size() == 1;
  std::set<Index> numbers;
  for (const auto& [own, number] : number_of) numbers.insert(number);
  same_vertices = same_vertices && numbers.size() == number_of.size();
  pieces = static_cast<Index>(all_pieces.size());
  vertices = static_cast<Index>(all_vertices.size());
  tets = static_cast<Index>(tets_of.size());
  same_tets = same_tets && tets == static_cast<Index>(elements.size());
  std::map<std::pair<Index, Index>, int> edges;
  for (Index code : outer)
    for (int k = 0; k < 3; ++k) {
      const int* c = face_corners[code % 4];
      const Index a = surface.of(4 * (code / 4) + c[k]), b = surface.of(4 * (code / 4) + c[(k + 1) % 3]);
      ++edges[std::minmax(a, b)];
    }
  for (const auto& [edge, count] : edges) odd_edges += count % 2;
}

}  // namespace lobe::test
