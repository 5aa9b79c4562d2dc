#include "lobe/skin/skin_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

namespace lobe {
namespace {

// Writes vectors of four numbers as columns of three. The next column overwrites the fourth number; that of
// the last column is left out. The compiler must assume that vector registers alias everything, so loops have
// pointers of their own.
class Columns {
 public:
  explicit Columns(Mat3X<float>& to, Index count) : data_(to.data()), last_(count - 1), to_(to) {}
  void put_before_last(Index i, const Eigen::Vector4f& vector) const {
    Eigen::Map<Eigen::Vector4f>(data_ + 3 * std::size_t(i)) = vector;
  }
  void put_last(const Eigen::Vector4f& vector) const { to_.col(last_) = vector.head<3>(); }

 private:
  float* data_;
  Index last_;
  Mat3X<float>& to_;
};

// b × c of the first three numbers; the fourth is 0 where theirs are. (Eigen's cross3() does one number at a
// time.)
Eigen::Vector4f cross(const Eigen::Vector4f& b, const Eigen::Vector4f& c) {
  using Four [[gnu::vector_size(16)]] = float;
  const auto turned = [](Four a) { return __builtin_shufflevector(a, a, 1, 2, 0, 3); };
  const Four own_b = *reinterpret_cast<const Four*>(b.data()),
             own_c = *reinterpret_cast<const Four*>(c.data());
  const Four product = turned(own_b * turned(own_c) - turned(own_b) * own_c);
  return Eigen::Map<const Eigen::Vector4f>(reinterpret_cast<const float*>(&product));
}

}  // namespace

// Lists six triangles for each vertex, so that the loop over them always has the same length.
SkinFrame::SkinFrame(const SkinBinding& rest) {
  const Index of_no_area = rest.file_count();
  for (Index vertex = 0; vertex < rest.around.count(); ++vertex) {
    auto& six = six_around_.emplace_back();
    six.fill(of_no_area);
    const std::span<const Index> around = rest.around[vertex];
    for (std::size_t i = 0; i < around.size(); ++i) {
      if (i < six.size())
        six[i] = around[i];
      else
        others_around_.push_back({vertex, around[i]});
    }
  }
}

template <class Real>
void SkinFrame::update(const SkinBinding& rest, const SkinState& state, const SkinMesh& drawn,
                       const Eigen::Ref<const Mat3X<double>>& X, const Eigen::Ref<const Mat3X<Real>>& u,
                       Mat3X<float>& x, Mat3X<float>& normals) {
  mesh_x_.resize(std::size_t(X.cols()));
  for (Eigen::Index v = 0; v < X.cols(); ++v)
    mesh_x_[v] << (X.col(v) + u.col(v).template cast<double>()).template cast<float>(), 0.0F;
  x.resize(3, drawn.vertex_count());
  normals.resize(3, drawn.vertex_count());
  if (revision_ != drawn.revision) list_parts(rest, state);
  revision_ = drawn.revision;
  find_positions(rest, state, x);
  find_areas(state);
  find_normals(normals);
  find_cut_normals(rest, state, normals);
  const Index carried = rest.carried_count();
  for (Index i = carried; i < rest.first_cut(); ++i) {
    x.col(i) = x.col(rest.copied_from[i - carried]);
    normals.col(i) = normals.col(rest.copied_from[i - carried]);
  }
}

template void SkinFrame::update(const SkinBinding&, const SkinState&, const SkinMesh&,
                                const Eigen::Ref<const Mat3X<double>>&, const Eigen::Ref<const Mat3X<float>>&,
                                Mat3X<float>&, Mat3X<float>&);
template void SkinFrame::update(const SkinBinding&, const SkinState&, const SkinMesh&,
                                const Eigen::Ref<const Mat3X<double>>&,
                                const Eigen::Ref<const Mat3X<double>>&, Mat3X<float>&, Mat3X<float>&);

// Triangles that are shown no more have no area.
void SkinFrame::list_parts(const SkinBinding& rest, const SkinState& state) {
  twice_area_.assign(state.slot_of.size(), Eigen::Vector4f::Zero());
  const Index carried = rest.carried_count();
  parts_around_.clear();
  for (const auto& [triangle, divided] : state.divided)
    for (Index part : divided.parts)
      for (Index vertex : state.shown[state.slot_of[part]])
        if (vertex < carried) parts_around_.push_back({vertex, part});
  std::sort(parts_around_.begin(), parts_around_.end());
}

void SkinFrame::find_positions(const SkinBinding& rest, const SkinState& state, Mat3X<float>& x) {
  const Index count = rest.carried_count();
  if (count == 0) return;
  x_.resize(std::size_t(count) + state.cut.size());
  const Eigen::Vector4f *const mesh = mesh_x_.data(), *const weights = state.weights.data();
  const Eigen::Vector4i* const corners = state.carrier_corners.data();
  Eigen::Vector4f* const carried = x_.data();
  const Columns columns(x, count);
  for (Index i = 0; i < count; ++i) {
    const Eigen::Vector4f& w = weights[i];
    const Eigen::Vector4i& c = corners[i];
    carried[i] = (w[0] * mesh[c[0]] + w[1] * mesh[c[1]]) + (w[2] * mesh[c[2]] + w[3] * mesh[c[3]]);
    if (i + 1 < count) columns.put_before_last(i, carried[i]);
  }
  columns.put_last(carried[count - 1]);
  find_cut_positions(rest, state, x);
}

void SkinFrame::find_cut_positions(const SkinBinding& rest, const SkinState& state, Mat3X<float>& x) {
  const auto carried = std::size_t(rest.carried_count());
  for (std::size_t i = 0; i < state.cut.size(); ++i) {
    const Eigen::Vector4f& w = state.cut[i].weights;
    const Eigen::Vector4i& c = state.cut[i].corners;
    x_[carried + i] =
        (w[0] * mesh_x_[c[0]] + w[1] * mesh_x_[c[1]]) + (w[2] * mesh_x_[c[2]] + w[3] * mesh_x_[c[3]]);
    x.col(rest.first_cut() + Index(i)) = x_[carried + i].head<3>();
  }
}

void SkinFrame::find_areas(const SkinState& state) {
  const Eigen::Vector4f* const x = x_.data();
  Eigen::Vector4f* const areas = twice_area_.data();
  const Eigen::Vector3i* const shown = state.shown.data();
  const Index* const numbers = state.number_of.data();
  const std::size_t count = state.shown.size();
  for (std::size_t slot = 0; slot < count; ++slot) {
    const Eigen::Vector3i& t = shown[slot];
    const Eigen::Vector4f a = x[t[0]], b = x[t[1]] - a, c = x[t[2]] - a;
    areas[numbers[slot]] = cross(b, c);
  }
}

// A vertex sums the triangles around it. To add each triangle to its corners would be slower, because it
// would wait for sums that were just written. Four square roots are computed at a time. A vertex without area
// has no normal.
void SkinFrame::find_normals(Mat3X<float>& normals) const {
  const auto count = static_cast<Index>(six_around_.size());
  if (count == 0) return;
  const Eigen::Vector4f* const areas = twice_area_.data();
  const std::array<Index, 6>* const around = six_around_.data();
  const Columns columns(normals, count);
  auto other = others_around_.cbegin(), part = parts_around_.cbegin();
  const auto end = others_around_.cend(), end_of_parts = parts_around_.cend();
  for (Index i = 0; i < count; i += 4) {
    const Index here = std::min(4, count - i);
    Eigen::Matrix4f sums = Eigen::Matrix4f::Zero();
    for (Index k = 0; k < here; ++k) {
      const std::array<Index, 6>& t = around[i + k];
      sums.col(k) = (areas[t[0]] + areas[t[1]]) + (areas[t[2]] + areas[t[3]]) + (areas[t[4]] + areas[t[5]]);
    }
    for (; other != end && (*other)[0] < i + 4; ++other) sums.col((*other)[0] - i) += areas[(*other)[1]];
    for (; part != end_of_parts && (*part)[0] < i + 4; ++part) sums.col((*part)[0] - i) += areas[(*part)[1]];
    const Eigen::Array4f squares = sums.colwise().squaredNorm().transpose();
    const Eigen::Array4f factors = (squares > 0).select(squares.sqrt().inverse(), 0.0F);
    for (Index k = 0; k < here && i + k + 1 < count; ++k)
      columns.put_before_last(i + k, factors[k] * sums.col(k));
    if (i + 4 >= count) columns.put_last(factors[here - 1] * sums.col(here - 1));
  }
}

void SkinFrame::find_cut_normals(const SkinBinding& rest, const SkinState& state,
                                 Mat3X<float>& normals) const {
  if (state.cut.empty()) return;
  const Index carried = rest.carried_count();
  auto own = normals.rightCols(Eigen::Index(state.cut.size()));
  own.setZero();
  for (const auto& [triangle, divided] : state.divided)
    for (Index part : divided.parts)
      for (Index vertex : state.shown[state.slot_of[part]])
        if (vertex >= carried) own.col(vertex - carried) += twice_area_[part].head<3>();
  for (auto normal : own.colwise())
    if (const float length = normal.norm(); length > 0) normal /= length;
}

}  // namespace lobe
