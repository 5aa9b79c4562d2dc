// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe/error.h"
#include "lobe_mesh/label_image_parts.h"
#include "lobe_mesh/segment_names.h"

#ifdef LOBE_TEEM

#include <teem/nrrd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>

#include "lobe_mesh/label_layers.h"

namespace lobe::meshing {
namespace {

constexpr std::size_t most_layers = 250;

struct Nuke {
  void operator()(Nrrd* nrrd) const { nrrdNuke(nrrd); }
  void operator()(NrrdIoState* state) const { nrrdIoStateNix(state); }
};
using NrrdOwner = std::unique_ptr<Nrrd, Nuke>;

NrrdOwner load(const std::string& file, bool header_only) {
  NrrdOwner nrrd(nrrdNew());
  const std::unique_ptr<NrrdIoState, Nuke> state(nrrdIoStateNew());
  state->skipData = header_only ? 1 : 0;
  if (nrrdLoad(nrrd.get(), file.c_str(), state.get()) == 0) return nrrd;
  const std::unique_ptr<char, decltype(&std::free)> text(biffGetDone(NRRD), &std::free);
  std::string why(text.get());  // one line per level of teem's calls, the cause last
  while (!why.empty() && why.back() == '\n') why.pop_back();
  throw InputError(file, "teem cannot read it (" + why.substr(why.find_last_of('\n') + 1) + ")");
}

VoxelType type_of(const Nrrd& nrrd) {
  switch (nrrd.type) {
    case nrrdTypeChar:
      return VoxelType::int8;
    case nrrdTypeUChar:
      return VoxelType::uint8;
    case nrrdTypeShort:
      return VoxelType::int16;
    case nrrdTypeUShort:
      return VoxelType::uint16;
    case nrrdTypeInt:
      return VoxelType::int32;
    case nrrdTypeUInt:
      return VoxelType::uint32;
    case nrrdTypeLLong:
      return VoxelType::int64;
    case nrrdTypeULLong:
      return VoxelType::uint64;
    case nrrdTypeFloat:
      return VoxelType::float32;
    case nrrdTypeDouble:
      return VoxelType::float64;
    default:
      return VoxelType::other;
  }
}

// Metres per unit; 1 if the file names none.
double metres(const std::string& file, const char* unit) {
  static const std::map<std::string, double> known{
      {"", 1}, {"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}, {"microns", 1e-6}, {"\u00b5m", 1e-6}};
  const auto found = known.find(unit == nullptr ? "" : unit);
  if (found == known.end())
    throw InputError(file, "unknown unit '" + std::string(unit) + "', expected m, cm, mm or um");
  return found->second;
}

// Maps the axes of the file's space to left, posterior, superior. A space without such axes is left as it is.
Vec3d signs_of(int space) {
  if (space == nrrdSpaceRightAnteriorSuperior) return {-1, -1, 1};
  if (space == nrrdSpaceLeftAnteriorSuperior) return {1, -1, 1};
  return {1, 1, 1};
}

// Of its axes from `first` on.
Mat34<double> oriented(const std::string& file, const Nrrd& nrrd, unsigned first) {
  Mat34<double> to_world;
  const Vec3d signs = signs_of(nrrd.space);
  for (int row = 0; row < 3; ++row) {
    const double unit = signs[row] * metres(file, nrrd.spaceUnits[row]);
    for (int k = 0; k < 3; ++k) to_world(row, k) = unit * nrrd.axis[first + unsigned(k)].spaceDirection[row];
    to_world(row, 3) = unit * nrrd.spaceOrigin[row];
  }
  if (!to_world.col(3).allFinite())
    throw InputError(file, "the 'space origin' is missing: the position is unknown");
  return to_world;
}

// Without a space: voxel (0, 0, 0) at the origin, axes along x, y and z.
Mat34<double> spaced(const std::string& file, const Nrrd& nrrd) {
  Mat34<double> to_world = Mat34<double>::Zero();
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(nrrd.axis[k].spacing))
      throw InputError(file, "neither 'space directions' nor 'spacings': size and orientation are unknown");
    if (std::isfinite(nrrd.axis[k].min))
      throw InputError(file, "'axis mins' are not understood: give 'space origin' and 'space directions'");
    to_world(k, k) = metres(file, nrrd.axis[k].units) * nrrd.axis[k].spacing;
  }
  return to_world;
}

// How many layers of segments it has, each with one value per voxel: the first of four axes, which is none of
// space. 1: one value per voxel.
std::size_t layers_of(const std::string& file, const Nrrd& nrrd) {
  if (nrrd.dim == 3 && (nrrd.spaceDim == 0 || nrrd.spaceDim == 3)) return 1;
  const bool has_layers = nrrd.dim == 4 && nrrd.spaceDim == 3 &&
                          !std::isfinite(nrrd.axis[0].spaceDirection[0]) && nrrd.axis[0].size > 0;
  if (!has_layers)
    throw InputError(file, std::to_string(nrrd.dim) +
                               " axes, expected 3: one label per voxel; or before these one of layers, whose "
                               "space direction is 'none'");
  if (nrrd.axis[0].size > most_layers)
    throw InputError(file, "more than " + std::to_string(most_layers) + " layers of segments");
  return nrrd.axis[0].size;
}

std::string text_of(const Nrrd& nrrd, const std::string& key) {
  const std::unique_ptr<char, decltype(&std::free)> text(nrrdKeyValueGet(&nrrd, key.c_str()), &std::free);
  return text ? text.get() : "";
}

// As 3D Slicer lists them; none where the file does not.
std::vector<Segment> segments_of(const Nrrd& nrrd) {
  std::vector<Segment> segments;
  for (int i = 0; i < 1000; ++i) {
    const std::string key = "Segment" + std::to_string(i) + "_", value = text_of(nrrd, key + "LabelValue"),
                      layer = text_of(nrrd, key + "Layer");
    if (value.empty()) break;
    segments.push_back({static_cast<std::size_t>(std::strtoul(layer.c_str(), nullptr, 10)),
                        static_cast<std::int32_t>(std::strtol(value.c_str(), nullptr, 10)),
                        text_of(nrrd, key + "Name")});
  }
  return segments;
}

// What a unit is taken for [m] where the file names none, else 0. 3D Slicer writes millimetres and does not
// say so.
double unnamed_unit(const Nrrd& nrrd) {
  for (unsigned k = 0; k < 3; ++k) {
    const char* unit = nrrd.spaceDim == 3 ? nrrd.spaceUnits[k] : nrrd.axis[k].units;
    if (unit != nullptr && *unit != '\0') return 0;
  }
  const bool is_of_slicer =
      nrrd.spaceDim == 3 &&
      !(text_of(nrrd, "Segment0_ID") + text_of(nrrd, "Segmentation_MasterRepresentation") +
        text_of(nrrd, "Segmentation_ContainedRepresentationNames"))
           .empty();
  return is_of_slicer ? 1e-3 : 1;
}

// A segment that has voxels, but none where it is not covered, would be lost.
void refuse_covered(const std::string& file, const std::vector<std::int32_t>& values, std::size_t layers,
                    const MergedLayers& merged) {
  for (std::size_t s = 0; s < merged.segments.size(); ++s) {
    const Segment& segment = merged.segments[s];
    const auto label = static_cast<std::int32_t>(s + 1);
    if (std::find(merged.values.begin(), merged.values.end(), label) != merged.values.end()) continue;
    for (std::size_t voxel = segment.layer; voxel < values.size(); voxel += layers)
      if (values[voxel] == segment.value)
        throw InputError(file, "later segments cover label " + std::to_string(label) +
                                   (segment.name.empty() ? "" : " (" + segment.name + ")") +
                                   " wholly: move it behind them in the list of segments");
  }
}

// `names`: gets those of the segments, by label.
LabelImage read_named(const std::string& file, std::map<int, std::string>& names) {
  LabelImage image;
  std::size_t layers = 1;
  {
    const NrrdOwner header = load(file, true);
    layers = layers_of(file, *header);
    const unsigned first = header->dim - 3;
    std::array<double, 3> size{};
    for (unsigned k = 0; k < 3; ++k) size[k] = static_cast<double>(header->axis[first + k].size);
    checked_size(file, {static_cast<double>(layers) * size[0], size[1], size[2]});
    image.size = checked_size(file, size);
    image.to_world = header->spaceDim == 3 ? oriented(file, *header, first) : spaced(file, *header);
    image.assumed_unit = unnamed_unit(*header);
    if (image.assumed_unit > 0) image.to_world *= image.assumed_unit;
    check_axes(file, image.to_world);
    check_type(file, type_of(*header));
  }
  const NrrdOwner nrrd = load(file, false);
  const std::array<Index, 3> stored{Index(layers) * image.size[0], image.size[1], image.size[2]};
  image.values = to_labels(file, nrrd->data, stored, type_of(*nrrd));
  std::vector<Segment> named = segments_of(*nrrd);
  if (nrrd->dim == 3) {
    for (const Segment& segment : named)
      if (!segment.name.empty()) names[segment.value] = segment.name;
    return image;
  }
  std::erase_if(named, [&](const Segment& segment) { return segment.layer >= layers; });
  MergedLayers merged = merge_layers(image.values, layers, named);
  refuse_covered(file, image.values, layers, merged);
  image.notes.push_back(words_of(merged));
  image.values = std::move(merged.values);
  for (std::size_t s = 0; s < merged.segments.size(); ++s)
    if (!merged.segments[s].name.empty()) names[int(s) + 1] = merged.segments[s].name;
  return image;
}

bool is_nrrd_file(const std::filesystem::path& file) {
  return file.extension() == ".nrrd" || file.extension() == ".nhdr";
}

}  // namespace

LabelImage read_nrrd(const std::string& file) {
  std::map<int, std::string> ignored;
  return read_named(file, ignored);
}

std::map<int, std::string> segment_names(const std::filesystem::path& file) {
  std::map<int, std::string> names;
  if (is_nrrd_file(file)) read_named(file.string(), names);
  return names;
}

}  // namespace lobe::meshing

#else

namespace lobe::meshing {

std::map<int, std::string> segment_names(const std::filesystem::path&) { return {}; }

LabelImage read_nrrd(const std::string& file) {
  throw InputError(file,
                   "lobe was built without teem: install libteem-dev and build again, or save it as NIfTI");
}

}  // namespace lobe::meshing

#endif
