// Members of structs that no file and no digest of lobe has, on purpose.
#pragma once

#include "lobe/file/lists_all.h"
#include "lobe/setup/setup.h"
#include "lobe/tool/scalpel.h"

namespace lobe::io {

// No name, no folder and no label decides how a body moves.
template <class T>
requires requires {
  T::type;
  &T::name;
}  // the setups of all tools
inline constexpr auto left_out<T> = std::tuple(&T::name);
template <>
inline constexpr auto left_out<ObstacleSetup> = std::tuple(&ObstacleSetup::name);
template <>
inline constexpr auto left_out<StitchSetup> = std::tuple(&StitchSetup::name);
template <>
inline constexpr auto left_out<TetMesh> = std::tuple(&TetMesh::labels);
template <>
inline constexpr auto left_out<MeshBodies> = std::tuple(&MeshBodies::names);
// A state is saved between two frames. These are sums over the present one.
template <>
inline constexpr auto left_out<Scalpel> = std::tuple(&Scalpel::work, &Scalpel::length, &Scalpel::way);

}  // namespace lobe::io
