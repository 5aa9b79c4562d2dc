// How many values the enumerations have that checkpoints and recordings keep, and how commands are read back.
#pragma once

#include "lobe/file/fields.h"
#include "lobe/forces/saved_terms.h"
#include "lobe/organ/left_out_fields.h"
#include "lobe/organ/report.h"
#include "lobe/tool/tools.h"

namespace lobe::io {

template <>
inline constexpr int enum_size<RegionModel> = int(region_model_names.size());
template <>
inline constexpr int enum_size<RigidShape::Kind> = 1 + int(RigidShape::Kind::mesh);
template <>
inline constexpr int enum_size<Grasp::Phase> = 1 + int(Grasp::Phase::released);
template <>
inline constexpr int enum_size<Condition::Kind> = 1 + int(Condition::Kind::clip);

}  // namespace lobe::io
