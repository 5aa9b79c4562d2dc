#include "lobe/setup/pressures.h"

#include <Eigen/Geometry>

namespace lobe {

template <class Real>
void add_pressures(const std::vector<FacePressure>& pressures, const Elements& elements, double share,
                   const Mat3X<Real>& u, Mat3X<Real>& f) {
  for (const FacePressure& load : pressures) {
    const Eigen::Vector4i corners = elements.topology.corners(load.tet);
    Mat3<double> x;
    for (int k = 0; k < 3; ++k) {
      const Index v = corners[face_corners[load.face][k]];
      x.col(k) = elements.points.col(v) + u.col(v).template cast<double>();
    }
    const Vec3d area = (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)) / 2;
    const Vec3d force = -share * elements.share_of(load.tet) * load.pressure / 3 * area;
    for (const int k : face_corners[load.face]) f.col(corners[k]) += force.template cast<Real>();
  }
}

template void add_pressures(const std::vector<FacePressure>&, const Elements&, double, const Mat3X<float>&,
                            Mat3X<float>&);
template void add_pressures(const std::vector<FacePressure>&, const Elements&, double, const Mat3X<double>&,
                            Mat3X<double>&);

}  // namespace lobe
