// A viewer of a small body and its pages, without a network.
#pragma once

#include <doctest/doctest.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "folder.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/run/recording.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/read_scene.h"
#include "lobe/sim/world.h"
#include "lobe/skin/skin.h"
#include "viewer.h"

namespace lobe::test {

using Json = nlohmann::json;

inline const char* const block_scene = R"({
  "name": "block", "mesh": "block.vtu",
  "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
  "regions": [{"model": "tensor-mass", "where": {"box": {"min": [0, 0, 0], "max": [1, 1, 0.02]}}}],
  "boundary": [{"fix": true, "where": {"plane": {"point": [0, 0, 0.001], "normal": [0, 0, 1], "side": "below"}}}],
  "time": {"duration": 9, "damping": 15}})";

// Whether it is so within some seconds.
template <class Condition>
bool comes_to(const Condition& condition) {
  for (int i = 0; i < 2000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return condition();
}

// A viewer of a block of 6 cm that stands on z = 0, and its pages.
struct Viewed {
  Folder folder;
  std::optional<view::Viewer> viewer;

  // `has_skin`: the boundary of its tetrahedra.
  explicit Viewed(bool has_skin = false, const std::string& haptic = "none", const Json& more = {},
                  const std::function<void(view::ViewerOptions&)>& change = {}) {
    const TetMesh mesh = box_mesh({0.06, 0.06, 0.06}, 6, 6, 6);
    write_vtu(folder.path / "block.vtu", mesh);
    Json document = Json::parse(block_scene);
    document.update(more.is_null() ? Json::object() : more);
    Scene scene = read_scene(folder.write("block.json", document.dump()));
    if (has_skin) {
      scene.skin = "block.obj";
      write_obj(mesh);
    }
    view::ViewerOptions options;
    options.folder = folder.path;
    options.record = folder.path / "all.lobe";
    options.haptic.device = haptic;
    if (change) change(options);
    viewer.emplace(scene, resolve(scene, read_mesh(mesh_path(scene)).mesh), options);
  }

  void write_obj(const TetMesh& mesh) const {
    std::ofstream out(folder.path / "block.obj");
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      out << "v " << mesh.points(0, v) << ' ' << mesh.points(1, v) << ' ' << mesh.points(2, v) << '\n';
    const Triangles triangles = textured_boundary(mesh).triangles;
    for (Index t = 0; t < triangles.cols(); ++t)
      out << "f " << triangles(0, t) + 1 << ' ' << triangles(1, t) + 1 << ' ' << triangles(2, t) + 1 << '\n';
  }

  void ask(view::ClientId page, const Json& request) { viewer->received(page, request.dump()); }

  // The next frame that the page is sent, within a minute.
  std::string message(view::ClientId page) {
    std::string message;
    for (int i = 0; i < 12000 && message.empty(); ++i) {
      message = viewer->next_frame(page);
      if (message.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    REQUIRE(!message.empty());
    return message;
  }
  std::vector<Json> frame(view::ClientId page) {
    const std::string message = this->message(page);
    Json tools = Json::array(), status;
    for (const view::Block& block : view::read_blocks(message)) {
      if (block.tag == view::tools_tag) tools = Json::parse(block.bytes);
      if (block.tag == view::status_tag) status = Json::parse(block.bytes);
    }
    return {status, tools};
  }
  using Condition = std::function<bool(const Json& status, const Json& tools)>;
  bool comes_to(view::ClientId page, const Condition& condition) {
    for (int i = 0; i < 3000; ++i) {
      const std::vector<Json> seen = frame(page);
      if (condition(seen[0], seen[1])) return true;
    }
    return false;
  }
  bool holds(view::ClientId page, std::size_t tools) {
    return comes_to(page, [&](const Json&, const Json& shown) { return shown.size() == tools; });
  }

  // What the present session has done so far: once.
  void record(const std::string& name) {
    std::filesystem::rename(viewer->write_recordings().back().recording, folder.path / name);
  }

  // Through the top at a place of it.
  void take(view::ClientId page, int hand, double x, double y) {
    ask(page,
        {{"do", "take"}, {"hand", hand}, {"from", {x, y, 1.0}}, {"along", {0, 0, -1}}, {"radius", 0.012}});
  }
  void bring(view::ClientId page, int hand, const Json& tool, bool on = false) {
    ask(page, {{"do", "bring"}, {"hand", hand}, {"tool", tool}});
    if (on) ask(page, {{"do", "turn_on"}, {"hand", hand}, {"on", true}});
  }
  void lead(view::ClientId page, int hand, double x, double y, double z) {
    ask(page, {{"do", "lead"}, {"hand", hand}, {"to", {x, y, z}}});
  }
  void pause(view::ClientId page) {
    ask(page, {{"do", "pause"}, {"on", true}});
    REQUIRE(comes_to(page, [](const Json& status, const Json&) { return !status["running"].get<bool>(); }));
  }
};

// Played as `lobe run` does.
inline std::uint64_t played(const std::filesystem::path& file) {
  const Scene scene = read_scene(file);
  World<float> world(resolve(scene, read_mesh(mesh_path(scene)).mesh).setup, 2);
  const Frames frames = frames_of(scene.time);
  for (int i = 0; i < frames.count; ++i) REQUIRE(world.advance(frames.length).ok);
  return digest(world);
}

}  // namespace lobe::test
