#include "lobe/region/element_blocks.h"

#include <algorithm>

#include "lobe/fem/simd.h"
#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"

namespace lobe {
namespace stdx = std::experimental;

template <class Real>
void ElementBlocks<Real>::follow(const Elements& elements, const std::vector<Index>& leave,
                                 const std::vector<Index>& enter) {
  slot_of_tet_.resize(std::size_t(elements.topology.tet_count()), -1);
  while (outputs_of_.vertex_count() < elements.topology.vertex_count()) outputs_of_.add_vertex();
  volume_term_ = elements.volume_penalty > 0;
  for (Index t : leave)
    if (slot_of_tet_[t] >= 0) remove(t);
  for (Index t : enter)
    if (elements.region_of[t] == RegionModel::nonlinear) add(elements, t);
  corner_forces_.resize(blocks_.size() * 12 * width);
}

template <class Real>
void ElementBlocks<Real>::add(const Elements& elements, Index tet) {
  const Index slot = tet_count();
  if (slot % width == 0) blocks_.emplace_back();
  tet_of_slot_.push_back(tet);
  slot_of_tet_[tet] = slot;
  const Eigen::Vector4i corners = elements.topology.corners(tet);
  write(slot, elements.shape_of(tet), elements.elastic_of(tet), elements.volume_penalty, corners);
  for (int c = 0; c < 4; ++c) outputs_of_.append(corners[c], output(slot, c));
}

template <class Real>
void ElementBlocks<Real>::write(Index slot, const Shape& s, const Elastic& elastic, double kappa,
                                const Eigen::Vector4i& corners) {
  Block& block = blocks_[slot / width];
  const int lane = slot % width;
  for (int i = 0; i < 9; ++i) block.alpha[i][lane] = static_cast<Real>(s.gradients(i % 3, 1 + i / 3));
  block.lambda_V[lane] = static_cast<Real>(elastic.lambda * s.volume);
  block.mu_V[lane] = static_cast<Real>(elastic.mu * s.volume);
  block.kappa_V[lane] = static_cast<Real>(kappa * s.volume);
  for (int c = 0; c < 4; ++c) block.corners[c][lane] = corners[c];
}

template <class Real>
void ElementBlocks<Real>::remove(Index tet) {
  const Index slot = slot_of_tet_[tet], last = tet_count() - 1;
  for (int c = 0; c < 4; ++c)
    outputs_of_.erase_value(blocks_[slot / width].corners[c][slot % width], output(slot, c));
  if (slot != last) move(last, slot);
  write(last, Shape{Mat34<double>::Zero(), 0}, Elastic{0, 0, 0}, 0, Eigen::Vector4i::Zero());
  slot_of_tet_[tet] = -1;
  tet_of_slot_.pop_back();
  if (last % width == 0) blocks_.pop_back();
}

template <class Real>
void ElementBlocks<Real>::move(Index from, Index to) {
  const Block& source = blocks_[from / width];
  Block& target = blocks_[to / width];
  const int a = from % width, b = to % width;
  for (int i = 0; i < 9; ++i) target.alpha[i][b] = source.alpha[i][a];
  target.lambda_V[b] = source.lambda_V[a];
  target.mu_V[b] = source.mu_V[a];
  target.kappa_V[b] = source.kappa_V[a];
  for (int c = 0; c < 4; ++c) {
    const Index v = target.corners[c][b] = source.corners[c][a];
    for (Index& place : outputs_of_[v])
      if (place == output(from, c)) place = output(to, c);
  }
  tet_of_slot_[to] = tet_of_slot_[from];
  slot_of_tet_[tet_of_slot_[to]] = to;
}

template <class Real>
struct ElementBlocks<Real>::Lanes {
  using T = Pack<Real>;
  static constexpr int count = static_cast<int>(T::size());

  Lanes(const Block& block, int first, const Mat3X<Real>& u)
      : lambda_V(&block.lambda_V[first], stdx::element_aligned),
        mu_V(&block.mu_V[first], stdx::element_aligned),
        kappa_V(&block.kappa_V[first], stdx::element_aligned) {
    Mat34<T> at_corners;
    for (int c = 0; c < 4; ++c)
      for (int d = 0; d < 3; ++d)
        at_corners(d, c) =
            T([&](auto lane) { return u.data()[3 * std::size_t(block.corners[c][first + lane]) + d]; });
    for (int i = 0; i < 9; ++i) alpha(i % 3, i / 3).copy_from(&block.alpha[i][first], stdx::element_aligned);
    H = displacement_gradient(at_corners, alpha);
  }

  T lambda_V, mu_V, kappa_V;
  Mat3<T> alpha, H;  // α_1, α_2, α_3; ∇u
};

template <class Real>
template <typename ElementBlocks<Real>::Part part>
void ElementBlocks<Real>::evaluate(const Mat3X<Real>& u, Index begin, Index end) {
  for (Index b = begin; b < end; ++b)
    for (int first = 0; first < width; first += Lanes::count) {
      const Lanes e(blocks_[b], first, u);
      Mat3<Pack<Real>> VP;
      if constexpr (part == Part::volume_term)
        VP = volume_stress(e.H, e.kappa_V);
      else
        VP = svk_stress(e.H, e.lambda_V, e.mu_V);
      if constexpr (part == Part::both) VP += volume_stress(e.H, e.kappa_V);
      const Mat34<Pack<Real>> f = corner_forces(VP, e.alpha);
      Real* place = corner_forces_.data() + std::size_t(b) * 12 * width + first;
      for (int i = 0; i < 12; ++i) f(i % 3, i / 3).copy_to(place + i * width, stdx::element_aligned);
    }
}

template <class Real>
void ElementBlocks<Real>::add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Part part, Parallel& parallel) {
  if (!volume_term_ && part == Part::volume_term) return;
  if (!volume_term_) part = Part::svk;
  parallel.for_ranges(Index(blocks_.size()), 2048 / width, [&](Index begin, Index end) {
    if (part == Part::svk) evaluate<Part::svk>(u, begin, end);
    if (part == Part::volume_term) evaluate<Part::volume_term>(u, begin, end);
    if (part == Part::both) evaluate<Part::both>(u, begin, end);
  });
  parallel.for_ranges(outputs_of_.vertex_count(), 1024, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v) {
      Vec3<Real> sum = Vec3<Real>::Zero();
      for (Index place : outputs_of_[v])
        for (int d = 0; d < 3; ++d) sum[d] += corner_forces_[std::size_t(place + d * width)];
      f.col(v) += sum;
    }
  });
}

template <class Real>
double ElementBlocks<Real>::energy(const Mat3X<Real>& u) const {
  double sum = 0;
  for (const Block& block : blocks_)
    for (int first = 0; first < width; first += Lanes::count) {
      const Lanes e(block, first, u);
      Pack<Real> W = svk_energy_density(e.H, e.lambda_V, e.mu_V);
      if (volume_term_) W += volume_energy_density(e.H, e.kappa_V);
      for (int lane = 0; lane < Lanes::count; ++lane) sum += double(Real(W[lane]));
    }
  return sum;
}

template <class Real>
typename ElementBlocks<Real>::Stiffness ElementBlocks<Real>::add_diagonal_stiffness(
    const Mat3X<Real>& u, DiagonalStiffness& K) const {
  static constexpr int upper[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  Stiffness result;
  for (Index begin = 0; begin < tet_count(); begin += Lanes::count) {
    const Block& block = blocks_[begin / width];
    const int first = begin % width;
    const Lanes e(block, first, u);
    const Pack<Real> change = volume_change(e.H);
    const int used = std::min<int>(Lanes::count, tet_count() - begin);
    for (int lane = 0; lane < used; ++lane)
      if (1 + Real(change[lane]) < result.smallest_volume_ratio) {
        result.smallest_volume_ratio = 1 + Real(change[lane]);
        result.smallest_tet = tet_of_slot_[begin + lane];
      }
    for (int c = 0; c < 4; ++c) {
      const Vec3<Pack<Real>> a = c == 0
                                     ? Vec3<Pack<Real>>(-(e.alpha.col(0) + e.alpha.col(1) + e.alpha.col(2)))
                                     : Vec3<Pack<Real>>(e.alpha.col(c - 1));
      Mat3<Pack<Real>> own = svk_diagonal_block(e.H, a, e.lambda_V, e.mu_V);
      if (volume_term_) own += volume_diagonal_block(e.H, a, e.kappa_V);
      for (int i = 0; i < 6; ++i)
        for (int lane = 0; lane < used; ++lane)
          K(i, block.corners[c][first + lane]) += double(Real(own(upper[i][0], upper[i][1])[lane]));
    }
  }
  return result;
}

template class ElementBlocks<float>;
template class ElementBlocks<double>;

}  // namespace lobe
