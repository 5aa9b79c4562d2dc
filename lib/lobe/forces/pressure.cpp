#include "lobe/forces/pressure.h"

#include <algorithm>
#include <cmath>

#include "lobe/error.h"
#include "lobe/file/fields.h"

namespace lobe {

template <class Real>
void Pressure<Real>::add_forces(const At& at, Mat3X<Real>& f) {
  const double share = ramp_ > 0 ? std::clamp(at.time / ramp_, 0.0, 1.0) : 1;
  add_pressures(pressures_, at.model.elements, share, at.u, f);
}

template <class Real>
std::vector<Index> Pressure<Real>::acts_on(const Model& model) const {
  std::vector<Index> vertices;
  for (const FacePressure& load : pressures_) {
    if (load.tet >= model.elements.topology.tet_count())
      throw InputError("checkpoint", "has a pressure on tetrahedron " + std::to_string(load.tet) +
                                         ", which the body does not have");
    const Eigen::Vector4i corners = model.elements.topology.corners(load.tet);
    for (const int k : face_corners[load.face]) vertices.push_back(corners[k]);
  }
  return vertices;
}

// Faces of removed tetrahedra bear nothing, copies bear what the whole did. What a cut opens is not under
// pressure.
template <class Real>
void Pressure<Real>::follow(const Topology& topology, const MeshEdit& edit) {
  std::erase_if(pressures_, [&](const FacePressure& load) { return !topology.alive(load.tet); });
  const std::size_t count = pressures_.size();
  for (const TetCopy& made : edit.copies)
    for (std::size_t i = 0; i < count; ++i)
      if (pressures_[i].tet == made.tet)
        pressures_.push_back({made.copy, pressures_[i].face, pressures_[i].pressure});
}

template <class Real>
void Pressure<Real>::add_to_setup(const Elements&, const CompactMesh& left, Setup& setup) const {
  for (const FacePressure& load : pressures_)
    if (left.tet_target[load.tet] >= 0)
      setup.pressures.push_back({left.tet_target[load.tet], load.face, load.pressure});
}

template <class Real>
std::string Pressure<Real>::save() const {
  io::ByteWriter out;
  io::put(out, pressures_);
  io::put(out, ramp_);
  return out.bytes();
}

template <class Real>
void Pressure<Real>::load(const std::string& saved, Index) {
  io::ByteReader in("checkpoint", saved);
  std::vector<FacePressure> pressures;
  double ramp = 0;
  io::get(in, pressures);
  io::get(in, ramp);
  for (const FacePressure& load : pressures)
    in.expect(load.tet >= 0 && load.face >= 0 && load.face < 4 && std::isfinite(load.pressure));
  in.expect(std::isfinite(ramp) && ramp >= 0);
  in.expect_end();
  pressures_ = std::move(pressures);
  ramp_ = ramp;
}

template class Pressure<float>;
template class Pressure<double>;

}  // namespace lobe
