#include "lobe/region/element_blocks.h"

#include <algorithm>

namespace lobe {
namespace {

// Lists of the right lengths for the corners of these tetrahedra, so that filling them moves nothing.
VertexLists<Index> lists_for_corners(const Elements& elements, const std::vector<Index>& tets) {
  std::vector<Index> lengths(std::size_t(elements.topology.vertex_count()), 0);
  for (Index t : tets)
    if (elements.region_of[t] == RegionModel::nonlinear)
      for (Index v : elements.topology.corners(t)) ++lengths[v];
  return VertexLists<Index>(lengths);
}

}  // namespace

template <class Real>
void ElementBlocks<Real>::follow(const Elements& elements, const std::vector<Index>& leave,
                                 const std::vector<Index>& enter) {
  slot_of_tet_.resize(std::size_t(elements.topology.tet_count()), -1);
  if (outputs_of_.vertex_count() == 0) outputs_of_ = lists_for_corners(elements, enter);
  while (outputs_of_.vertex_count() < elements.topology.vertex_count()) outputs_of_.add_vertex();
  volume_term_ = elements.volume_penalty > 0;
  nodal_pressure_ = std::any_of(elements.materials.begin(), elements.materials.end(),
                                [](const Elastic& elastic) { return elastic.nodal_lambda() > 0; });
  for (Index t : leave)
    if (slot_of_tet_[t] >= 0) remove(t);
  if (nodal_pressure_) nodes_.follow(elements, leave, enter);
  for (Index t : enter)
    if (elements.region_of[t] == RegionModel::nonlinear) add(elements, t);
  corner_forces_.resize(blocks_.size() * 12 * width);
  if (!nodal_pressure_) return;
  volume_strain_.resize(slot_of_tet_.size());
  pressure_.resize(std::size_t(nodes_.count()));
  slopes_.resize(3, 4 * Eigen::Index(slot_of_tet_.size()));
}

template <class Real>
void ElementBlocks<Real>::add(const Elements& elements, Index tet) {
  const Index slot = tet_count();
  if (slot % width == 0) {
    blocks_.emplace_back();
    if (nodal_pressure_) pressure_blocks_.emplace_back();
  }
  tet_of_slot_.push_back(tet);
  slot_of_tet_[tet] = slot;
  const Eigen::Vector4i corners = elements.topology.corners(tet);
  const Shape s = elements.shape_of(tet);
  write(slot, s, elements.elastic_of(tet), elements.volume_penalty, corners);
  if (nodal_pressure_) write_pressure(slot, s.volume, nodes_.of(tet));
  for (int c = 0; c < 4; ++c) outputs_of_.append(corners[c], output(slot, c));
}

template <class Real>
void ElementBlocks<Real>::write(Index slot, const Shape& s, const Elastic& elastic, double kappa,
                                const Eigen::Vector4i& corners) {
  Block& block = blocks_[slot / width];
  const int lane = slot % width;
  for (int i = 0; i < 9; ++i) block.alpha[i][lane] = static_cast<Real>(s.gradients(i % 3, 1 + i / 3));
  block.lambda_V[lane] = static_cast<Real>(elastic.element_lambda() * s.volume);
  block.mu_V[lane] = static_cast<Real>(elastic.mu * s.volume);
  block.kappa_V[lane] = static_cast<Real>(kappa * s.volume);
  for (int c = 0; c < 4; ++c) block.corners[c][lane] = corners[c];
}

template <class Real>
void ElementBlocks<Real>::write_pressure(Index slot, double volume, const Eigen::Vector4i& nodes) {
  Pressures& block = pressure_blocks_[slot / width];
  block.V[slot % width] = static_cast<Real>(volume);
  for (int c = 0; c < 4; ++c) block.nodes[c][slot % width] = nodes[c];
}

template <class Real>
void ElementBlocks<Real>::remove(Index tet) {
  const Index slot = slot_of_tet_[tet], last = tet_count() - 1;
  for (int c = 0; c < 4; ++c)
    outputs_of_.erase_value(blocks_[slot / width].corners[c][slot % width], output(slot, c));
  if (slot != last) move(last, slot);
  write(last, Shape{Mat34<double>::Zero(), 0}, Elastic{0, 0, 0}, 0, Eigen::Vector4i::Zero());
  if (nodal_pressure_) write_pressure(last, 0, Eigen::Vector4i::Constant(PressureNodes::none));
  slot_of_tet_[tet] = -1;
  tet_of_slot_.pop_back();
  if (last % width > 0) return;
  blocks_.pop_back();
  if (nodal_pressure_) pressure_blocks_.pop_back();
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
  if (nodal_pressure_) {
    const Pressures& of = pressure_blocks_[from / width];
    write_pressure(to, of.V[a], {of.nodes[0][a], of.nodes[1][a], of.nodes[2][a], of.nodes[3][a]});
  }
  tet_of_slot_[to] = tet_of_slot_[from];
  slot_of_tet_[tet_of_slot_[to]] = to;
}

template class ElementBlocks<float>;
template class ElementBlocks<double>;

}  // namespace lobe
