// Positions and normals of a skin (skin.h) in a frame.
#pragma once

#include <array>

#include "lobe/skin/skin_binding.h"
#include "lobe/skin/skin_state.h"

namespace lobe {

class SkinFrame {
 public:
  explicit SkinFrame(const SkinBinding& rest);

  // Works as Skin::update(), with `drawn` and `state` as they are now.
  template <class Real>
  void update(const SkinBinding& rest, const SkinState& state, const SkinMesh& drawn,
              const Eigen::Ref<const Mat3X<double>>& X, const Eigen::Ref<const Mat3X<Real>>& u,
              Mat3X<float>& x, Mat3X<float>& normals);

 private:
  using Padded = std::vector<Eigen::Vector4f>;  // three numbers that fill a vector register

  void find_positions(const SkinBinding& rest, const SkinState& state, Mat3X<float>& x);
  void find_cut_positions(const SkinBinding& rest, const SkinState& state, Mat3X<float>& x);
  void find_areas(const SkinState& state);
  void find_normals(Mat3X<float>& normals) const;
  void find_cut_normals(const SkinBinding& rest, const SkinState& state, Mat3X<float>& normals) const;
  void list_parts(const SkinBinding& rest, const SkinState& state);

  // Around each carried vertex at rest: six triangles; where there are fewer, one of no area. Those beyond
  // six come with their vertex, in its order.
  std::vector<std::array<Index, 6>> six_around_;
  std::vector<std::array<Index, 2>> others_around_;

  // The revision of what is shown that was seen last, and what belongs to it.
  std::uint64_t revision_ = 0;
  std::vector<std::array<Index, 2>> parts_around_;  // carried vertices with parts, in the vertices' order

  // Scratch.
  Padded twice_area_;  // twice the area of each triangle's number along its normal; 0 where it is not shown
  Padded mesh_x_;      // positions of the mesh
  Padded x_;           // positions of carried vertices, then of cut ones
};

extern template void SkinFrame::update(const SkinBinding&, const SkinState&, const SkinMesh&,
                                       const Eigen::Ref<const Mat3X<double>>&,
                                       const Eigen::Ref<const Mat3X<float>>&, Mat3X<float>&, Mat3X<float>&);
extern template void SkinFrame::update(const SkinBinding&, const SkinState&, const SkinMesh&,
                                       const Eigen::Ref<const Mat3X<double>>&,
                                       const Eigen::Ref<const Mat3X<double>>&, Mat3X<float>&, Mat3X<float>&);

}  // namespace lobe
