#include "stress/random_command.h"

#include <algorithm>
#include <array>
#include <vector>

namespace lobe::test {
namespace {

// In the cube and around it.
Vec3d place(Dice& dice, double size) { return dice.vector(-0.2 * size, 1.2 * size); }

ToolPose pose(Dice& dice, double size) {
  Eigen::Vector4d orientation(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1),
                              dice.between(-1, 1));
  if (orientation.norm() < 0.1 || dice.says(0.4)) orientation = {0, 0, 0, 1};
  return {place(dice, size), orientation.normalized()};
}

template <class Items>
auto one_of(Dice& dice, const Items& items) {
  return items[std::size_t(dice.below(static_cast<Index>(items.size())))];
}

// ---- Tools

template <class Real>
Command hold(Dice& dice, World<Real>& world, double size) {
  const Topology& topology = world.elements().topology;
  TakeHold command{"grasp", {}};
  if (dice.says(0.3)) {
    command.vertices = {dice.below(topology.vertex_count())};
    return command;
  }
  const Vec3d centre = place(dice, size);
  const double radius = dice.between(0.5, 2) * cell;
  const auto u = world.displacements();
  for (Index v = 0; v < topology.vertex_count(); ++v) {
    const Vec3d x = world.elements().points.col(v) + u.col(v).template cast<double>();
    if (!topology.around(v).empty() && !world.held().fixes(v) && (x - centre).norm() < radius)
      command.vertices.push_back(v);
  }
  return command;
}

Command bring_scalpel(Dice& dice, double size) {
  const Vec3d tip = place(dice, size);
  return BringScalpel{
      "scalpel", {tip, tip + dice.vector(-size, size)}, dice.between(0.02, 0.3), dice.says(0.1)};
}

Command bring_probe(Dice& dice, double size) {
  BringProbe command;
  command.name = "probe";
  command.pose = pose(dice, size);
  command.friction = dice.says(0.3) ? 0 : dice.between(0, 1);
  switch (dice.among(0, 3)) {
    case 0:
      command.shape = RigidShape::sphere(dice.between(0.4, 1.5) * cell);
      break;
    case 1:
      command.shape = RigidShape::capsule(0.5 * cell, 2 * cell);
      break;
    case 2:
      command.shape = RigidShape::box(Vec3d::Constant(1.5 * cell));
      break;
    default:
      command.shape = RigidShape::jaws({cell, 0.5 * cell, 2 * cell});
      command.pose.opening = dice.between(0, 3) * cell;
  }
  return command;
}

// A grasp goes anywhere around where it took hold. A body that touches itself is pulled gently: a crushed one
// has so many pairs that touch that a frame takes a minute.
template <class Real>
ToolPose next_pose(Dice& dice, const World<Real>& world, ToolId tool, const RandomSetup& body) {
  ToolPose next = pose(dice, body.size);
  const Grasp* grasp = world.tools().grasp(tool);
  if (!grasp) return next;
  const double reach = body.setup.contact.self ? 0.3 * cell : body.size;
  next.position = grasp->centre + dice.vector(-reach, reach);
  return next;
}

template <class Real>
Command use_tool(Dice& dice, World<Real>& world, const RandomSetup& body) {
  const std::vector<ToolId> tools = world.tools().held_by_hands();
  if (tools.empty()) return bring_probe(dice, body.size);
  const ToolId tool = one_of(dice, tools);
  if (dice.says(0.1)) return LetGo{tool};
  if (dice.says(0.3)) return SwitchTool{tool, dice.says(0.7)};
  return Lead{tool, next_pose(dice, world, tool, body)};
}

template <class Real>
Command tool_command(Dice& dice, World<Real>& world, const RandomSetup& body) {
  const double size = body.size;
  switch (dice.among(0, 9)) {
    case 0:
      return hold(dice, world, size);
    case 1:
      return BringCautery{"cautery", dice.between(0.2, 1) * cell, place(dice, size)};
    case 2:
      return bring_scalpel(dice, size);
    case 3:
      return bring_probe(dice, size);
    default:
      return use_tool(dice, world, body);
  }
}

// ---- Edits

std::vector<Index> any_of(Dice& dice, Index count, int most) {
  std::vector<Index> found;
  for (int i = dice.among(1, most); i > 0; --i) found.push_back(dice.below(count));
  return found;
}

Command set_region(Dice& dice, Index tets) {
  SetRegion command{{}, RegionModel(dice.below(Index(region_model_names.size())))};
  if (dice.says(0.7)) command.model = dice.says(0.5) ? RegionModel::nonlinear : RegionModel::tensor_mass;
  const Index first = dice.below(tets), end = std::min(tets, first + dice.among(1, 40));
  for (Index t = first; t < end; ++t) command.tets.push_back(t);
  return command;
}

template <class Real>
Command set_springs(Dice& dice, const World<Real>& world) {
  SetSprings command;
  for (int i = dice.among(0, 3); i > 0; --i) {
    const Index v = dice.below(world.elements().topology.vertex_count());
    command.springs.push_back({v, dice.between(1, 100), world.elements().points.col(v) + Vec3d(0, 0, 0.005)});
  }
  return command;
}

Command set_forces(Dice& dice, Index vertices) {
  SetForces command;
  for (int i = dice.among(0, 3); i > 0; --i)
    command.forces.push_back({dice.below(vertices), {0, 0, dice.between(-0.1, 0.1)}});
  return command;
}

Command move_springs(Dice& dice, double size) {
  Mat3X<double> points(3, dice.among(0, 3));
  for (Eigen::Index i = 0; i < points.cols(); ++i) points.col(i) = place(dice, size);
  return MoveSprings{points};
}

template <class Real>
Command edit(Dice& dice, World<Real>& world, double size) {
  const Topology& topology = world.elements().topology;
  switch (dice.among(0, 9)) {
    case 0:
      return RemoveTets{any_of(dice, topology.tet_count(), 6)};
    case 1:
      return Expand{};
    case 2:
      return Condense{};
    case 3:
      return Relinearise{dice.between(0.01, 0.1)};
    case 4:
      return SetMassDegree{one_of(dice, std::array{1, 3, 5, 9, 12})};
    case 5:
      return KeepFull{any_of(dice, topology.vertex_count(), 20), dice.between(0.01, 0.2)};
    case 6:
      return set_forces(dice, topology.vertex_count());
    case 7:
      return set_springs(dice, world);
    case 8:
      return move_springs(dice, size);
    default:
      return set_region(dice, topology.tet_count());
  }
}

}  // namespace

template <class Real>
Command random_command(Dice& dice, World<Real>& world, const RandomSetup& body) {
  return dice.says(0.6) ? tool_command(dice, world, body) : edit(dice, world, body.size);
}

template Command random_command(Dice&, World<float>&, const RandomSetup&);
template Command random_command(Dice&, World<double>&, const RandomSetup&);

}  // namespace lobe::test
