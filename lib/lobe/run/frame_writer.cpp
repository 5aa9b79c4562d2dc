#include "lobe/run/frame_writer.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>

#include "lobe/diagnostics/fields.h"
#include "lobe/diagnostics/grain_frame.h"
#include "lobe/file/atomic_file.h"
#include "lobe/run/line_file.h"
#include "lobe/text.h"

namespace lobe {
namespace {

// name_0007.suffix
std::string numbered(const std::string& name, std::size_t number, const char* suffix) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "_%04zu", number);
  return name + digits + suffix;
}

using Json = nlohmann::ordered_json;

Json array(const Vec3d& p) { return {p[0], p[1], p[2]}; }

Json tool_json(const PlacedTool& tool, const Mat3X<double>& x) {
  Json entry{{"type", tool.type}, {"position", array(tool.position)}};
  if (tool.shape.radius > 0) entry["radius"] = tool.shape.radius;
  for (Index v : tool.vertices) entry["points"].push_back(array(x.col(v)));
  return entry;
}

Json body_json(const char* shape, Json size, const Vec3d& position, const Eigen::Vector4d& q) {
  return {{shape, std::move(size)}, {"position", array(position)}, {"orientation", {q[0], q[1], q[2], q[3]}}};
}

// Planes and meshes are not drawn.
void add_obstacle(Json& bodies, const ObstacleSetup& obstacle) {
  const RigidShape& shape = obstacle.shape;
  if (shape.kind == RigidShape::Kind::sphere || shape.kind == RigidShape::Kind::capsule)
    bodies.push_back(
        body_json("capsule", {shape.radius, shape.length}, obstacle.position, obstacle.orientation));
  if (shape.kind == RigidShape::Kind::box)
    bodies.push_back(body_json("box", array(shape.size), obstacle.position, obstacle.orientation));
}

// Two boxes and a shaft.
void add_jaws(Json& bodies, const PlacedTool& tool) {
  const Vec3d& size = tool.shape.jaw;
  const Eigen::Quaterniond turn(tool.orientation);
  for (double side : {-1.0, 1.0}) {
    const Vec3d centre(0, side * (tool.shape.opening + size[1]) / 2, size[2] / 2);
    bodies.push_back(body_json("box", array(size), tool.position + turn * centre, tool.orientation));
  }
  const double thick = size[1] / 2;
  const Vec3d across(tool.shape.opening + 2 * size[1], size[0], thick);
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(EIGEN_PI / 2, Vec3d::UnitZ()));
  bodies.push_back(body_json("box", array(across), tool.position - turn * Vec3d(0, 0, thick / 2),
                             (turn * quarter).coeffs()));
  constexpr double shaft = 0.08;  // [m]
  bodies.push_back(
      body_json("capsule", {thick, shaft}, tool.position - turn * Vec3d(0, 0, shaft), tool.orientation));
}

// Per vertex; empty if nothing is reduced.
template <class Real>
std::vector<std::uint8_t> embedded(const World<Real>& world) {
  const LatticeRegion<Real>& region = world.body().regions.reduced();
  if (!region.any()) return {};
  std::vector<std::uint8_t> is_embedded = region.embedding().roles.is_embedded;
  is_embedded.resize(std::size_t(world.elements().topology.vertex_count()), 0);
  return is_embedded;
}

}  // namespace

template <class Real>
void FrameWriter::record(World<Real>& world, const Mat3X<double>& reactions, bool last) {
  const bool frame_due = world.time() >= next_frame_ - just_before;
  const bool picture_due = next_picture_ < output_.pictures.size() &&
                           world.time() >= output_.pictures[next_picture_] - just_before;
  if (!frame_due && !picture_due && !last) return;
  // A run that ended early may be at the time of its last frame, perhaps with more cuts.
  if (!frames_.empty() && frames_.back().first == world.time()) frames_.pop_back();
  const std::string frame = numbered("frame", frames_.size(), ".vtu");
  const Mat3X<double> u = world.state().u.template cast<double>(),
                      v = world.state().v.template cast<double>();
  if (const Grains* grains = world.grains())
    write_grain_frame(directory_ / frame, world.elements(), *grains, u, v, embedded(world));
  else
    write_frame(directory_ / frame, world.elements(), u, v, embedded(world), reactions);
  frames_.emplace_back(world.time(), frame);
  record_lines(world);
  if (frame_due) next_frame_ = output_.every * (std::floor((world.time() + just_before) / output_.every) + 1);
  const bool something_left = world.elements().topology.alive_count() > 0;  // an empty mesh cannot be drawn
  if (something_left && (picture_due || last)) add_pictures(world, frame);
}

// A file per frame and kind of force term, from the first line of it on.
template <class Real>
void FrameWriter::record_lines(World<Real>& world) {
  std::map<std::string, std::vector<TermLines>> now;
  for (TermLines& lines : term_lines(world)) now[lines.term].push_back(std::move(lines));
  for (auto& [term, files] : lines_) {
    if (files.back().first == world.time()) files.pop_back();
    now.try_emplace(term);
  }
  for (const auto& [term, lines] : now) {
    const std::string file = numbered(term, frames_.size() - 1, ".vtp");
    write_lines(directory_ / file, lines);
    lines_[term].emplace_back(world.time(), file);
  }
}

template <class Real>
void FrameWriter::add_pictures(World<Real>& world, const std::string& frame) {
  const Mat3X<double> x = world.elements().points.view() + world.state().u.template cast<double>();
  for (; next_picture_ < output_.pictures.size() &&
         world.time() >= output_.pictures[next_picture_] - just_before;
       ++next_picture_) {
    char title[64];
    std::snprintf(title, sizeof title, "t = %.2f s", world.time());
    Json panel{{"mesh", frame},
               {"title", title},
               {"color", world.elements().bodies.any() ? "body" : "region"},
               {"edges", true},
               {"first", frames_.front().second}};
    if (world.elements().fibres.cols() > 0) panel["fibres"] = true;
    panel["tools"] = Json::array();
    Json bodies = Json::array();
    for (const PlacedTool& tool : placed_tools(world))
      tool.shape.jaw.isZero(0) ? panel["tools"].push_back(tool_json(tool, x)) : add_jaws(bodies, tool);
    for (const ObstacleSetup& obstacle : obstacles_) add_obstacle(bodies, obstacle);
    add_lines(bodies, term_lines(world));
    if (!bodies.empty()) panel["bodies"] = std::move(bodies);
    Json picture{{"out", "picture_" + exact(output_.pictures[next_picture_]) + ".png"}};
    picture["panels"].push_back(std::move(panel));
    pictures_.push_back(std::move(picture));
  }
}

std::filesystem::path FrameWriter::finish() const {
  write_pvd(directory_ / "series.pvd", frames_);
  for (const auto& [term, files] : lines_) write_pvd(directory_ / (term + ".pvd"), files);
  if (pictures_.empty()) return {};
  const std::filesystem::path file = directory_ / "pictures.json";
  const Json request{{"pictures", pictures_}};
  io::write_file(file, request.dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
  return file;
}

template void FrameWriter::record(World<float>&, const Mat3X<double>&, bool);
template void FrameWriter::record(World<double>&, const Mat3X<double>&, bool);

}  // namespace lobe
