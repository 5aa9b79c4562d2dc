// Private to run/: frames and the picture request of a run.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "lobe/scene/scene.h"
#include "lobe/sim/world.h"

namespace lobe {

class FrameWriter {
 public:
  // The obstacles are drawn in pictures.
  FrameWriter(const Output& output, std::vector<ObstacleSetup> obstacles, std::filesystem::path directory)
      : output_(output), obstacles_(std::move(obstacles)), directory_(std::move(directory)) {}

  // Writes a frame if a frame or a picture is due at the world's time. With `last` it writes one in any case.
  // `reactions`: 3 × #vertices [N], or no column. Frames of a body that a blade has cut have none.
  template <class Real>
  void record(World<Real>& world, const Mat3X<double>& reactions, bool last);

  // DIR/series.pvd and, if pictures were asked for, DIR/pictures.json, whose path is returned (else empty).
  std::filesystem::path finish() const;

  std::size_t frame_count() const { return frames_.size(); }

 private:
  template <class Real>
  void record_lines(World<Real>& world);
  template <class Real>
  void add_pictures(World<Real>& world, const std::string& frame);

  Output output_;
  std::vector<ObstacleSetup> obstacles_;
  std::filesystem::path directory_;
  using Series = std::vector<std::pair<double, std::string>>;
  Series frames_;
  std::map<std::string, Series> lines_;  // series by force term: "threads", "attachments"
  nlohmann::ordered_json pictures_ = nlohmann::ordered_json::array();
  double next_frame_ = 0;  // [s]
  std::size_t next_picture_ = 0;
};

}  // namespace lobe
