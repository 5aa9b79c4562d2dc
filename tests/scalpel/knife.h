// A blade through a body at rest, without a world.
#pragma once

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
    ++begun_;
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
    const Incised incised = incise(grains, {stroke_, snap_, along_faces_, false, begun_ - 1}, swept_,
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
  Index begun_ = 0;  // strokes
  Index opened_ = 0;
  SweptSheets swept_;
  bool is_under_way_ = false;
};

}  // namespace lobe::test
