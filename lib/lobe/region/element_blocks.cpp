#include "lobe/region/element_blocks.h"

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
  for (int i = 0; i < 9; ++i) target.alpha[i][b] = Real(source.alpha[i][a]);
  target.lambda_V[b] = Real(source.lambda_V[a]);
  target.mu_V[b] = Real(source.mu_V[a]);
  target.kappa_V[b] = Real(source.kappa_V[a]);
  for (int c = 0; c < 4; ++c) {
    const Index v = target.corners[c][b] = source.corners[c][a];
    for (Index& place : outputs_of_[v])
      if (place == output(from, c)) place = output(to, c);
  }
  tet_of_slot_[to] = tet_of_slot_[from];
  slot_of_tet_[tet_of_slot_[to]] = to;
}

template <class Real>
Mat34<Pack<Real>> ElementBlocks<Real>::gather(const Block& block, const Mat3X<Real>& u) {
  Mat34<Pack<Real>> corners;
  for (int c = 0; c < 4; ++c)
    for (int d = 0; d < 3; ++d)
      corners(d, c) =
          Pack<Real>([&](auto lane) { return u.data()[3 * std::size_t(block.corners[c][lane]) + d]; });
  return corners;
}

template <class Real>
Mat3<Pack<Real>> ElementBlocks<Real>::gradients(const Block& block) {
  Mat3<Pack<Real>> alpha;
  for (int i = 0; i < 9; ++i) alpha(i % 3, i / 3) = block.alpha[i];
  return alpha;
}

template <class Real>
template <typename ElementBlocks<Real>::Part part>
void ElementBlocks<Real>::evaluate(const Mat3X<Real>& u, Index begin, Index end) {
  for (Index b = begin; b < end; ++b) {
    const Block& block = blocks_[b];
    const Mat3<Pack<Real>> alpha = gradients(block);
    const Mat3<Pack<Real>> H = displacement_gradient(gather(block, u), alpha);
    Mat3<Pack<Real>> VP;
    if constexpr (part == Part::volume_term)
      VP = volume_stress(H, block.kappa_V);
    else
      VP = svk_stress(H, block.lambda_V, block.mu_V);
    if constexpr (part == Part::both) VP += volume_stress(H, block.kappa_V);
    const Mat34<Pack<Real>> f = corner_forces(VP, alpha);
    Real* place = corner_forces_.data() + std::size_t(b) * 12 * width;
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
  for (const Block& block : blocks_) {
    const Mat3<Pack<Real>> H = displacement_gradient(gather(block, u), gradients(block));
    Pack<Real> W = svk_energy_density(H, block.lambda_V, block.mu_V);
    if (volume_term_) W += volume_energy_density(H, block.kappa_V);
    for (int lane = 0; lane < width; ++lane) sum += double(Real(W[lane]));
  }
  return sum;
}

template <class Real>
typename ElementBlocks<Real>::Stiffness ElementBlocks<Real>::add_diagonal_stiffness(
    const Mat3X<Real>& u, DiagonalStiffness& K) const {
  static constexpr int upper[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  Stiffness result;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    const Mat3<Pack<Real>> alpha = gradients(block);
    const Mat3<Pack<Real>> H = displacement_gradient(gather(block, u), alpha);
    const Pack<Real> change = volume_change(H);
    const int lanes = std::min<int>(width, tet_count() - static_cast<Index>(b) * width);
    for (int lane = 0; lane < lanes; ++lane)
      if (1 + Real(change[lane]) < result.smallest_volume_ratio) {
        result.smallest_volume_ratio = 1 + Real(change[lane]);
        result.smallest_tet = tet_of_slot_[b * width + lane];
      }
    for (int c = 0; c < 4; ++c) {
      const Vec3<Pack<Real>> a = c == 0 ? Vec3<Pack<Real>>(-(alpha.col(0) + alpha.col(1) + alpha.col(2)))
                                        : Vec3<Pack<Real>>(alpha.col(c - 1));
      Mat3<Pack<Real>> own = svk_diagonal_block(H, a, block.lambda_V, block.mu_V);
      if (volume_term_) own += volume_diagonal_block(H, a, block.kappa_V);
      for (int i = 0; i < 6; ++i)
        for (int lane = 0; lane < lanes; ++lane)
          K(i, block.corners[c][lane]) += double(Real(own(upper[i][0], upper[i][1])[lane]));
    }
  }
  return result;
}

template class ElementBlocks<float>;
template class ElementBlocks<double>;

}  // namespace lobe
