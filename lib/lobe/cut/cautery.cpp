#include "lobe/cut/cautery.h"

#include <algorithm>
#include <cmath>

#include "lobe/cut/distance.h"

namespace lobe {
namespace {

bool touches(const Sweep& sweep, int samples, const Mat34<double>& x) {
  for (int s = 0; s <= samples; ++s) {
    const Vec3d tip = sweep.from + (sweep.to - sweep.from) * (double(s) / samples);
    if (distance_to_tet(tip, x) <= sweep.radius) return true;
  }
  return false;
}

}  // namespace

template <class Real>
std::vector<Index> touched_tets(const Topology& topology, const Mat3X<double>& points, const Mat3X<Real>& u,
                                const Sweep& sweep) {
  const Vec3d low = sweep.from.cwiseMin(sweep.to).array() - sweep.radius;
  const Vec3d high = sweep.from.cwiseMax(sweep.to).array() + sweep.radius;
  const double length = (sweep.to - sweep.from).norm();
  const int samples = static_cast<int>(std::clamp(std::ceil(4 * length / sweep.radius), 1.0, 1e4));
  std::vector<Index> touched;
  for (Index t = 0; t < topology.tet_count(); ++t) {
    if (!topology.alive(t)) continue;
    Mat34<double> x;
    for (int c = 0; c < 4; ++c) {
      const Index v = topology.tets()(c, t);
      x.col(c) = points.col(v) + u.col(v).template cast<double>();
    }
    const bool apart = (x.rowwise().minCoeff().array() > high.array()).any() ||
                       (x.rowwise().maxCoeff().array() < low.array()).any();
    if (!apart && touches(sweep, samples, x)) touched.push_back(t);
  }
  return touched;
}

template std::vector<Index> touched_tets(const Topology&, const Mat3X<double>&, const Mat3X<float>&,
                                         const Sweep&);
template std::vector<Index> touched_tets(const Topology&, const Mat3X<double>&, const Mat3X<double>&,
                                         const Sweep&);

}  // namespace lobe
