// What lobe-picture is asked to draw: one JSON file, read into plain structs.
//
//   {"pictures": [{
//      "out": "picture_0.50.png", "size": [1280, 960],
//      "panels": [{"mesh": "frame_0015.vtu", "title": "t = 0.50 s", "color": "region",
//                  "edges": true, "fibres": true, "first": "frame_0000.vtu", "range": [0, 1],
//                  "tools": [{"type": "cautery", "position": [0, 0, 0.05], "radius": 0.006}],
//                  "bodies": [{"box": [0.01, 0.02, 0.03], "position": [0, 0, 0.1]}]}],
//      "camera": {"direction": [0.3, -1, 0.4], "up": [0, 0, 1], "zoom": 1},
//      "clip": {"point": [0, 0, 0], "normal": [0, -1, 0]}}]}
//
// Only `out`, `panels` and each panel's `mesh` are required. Paths are relative to the request; unknown keys
// are refused.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace picture {

using Vec3 = Eigen::Vector3d;

enum class ToolType { cautery, grasp, scalpel, probe };

struct Tool {
  ToolType type = ToolType::probe;
  Vec3 position = Vec3::Zero();   // of the tip [m]
  double radius = 0.005;          // [m]
  std::vector<Vec3> points;       // vertices it holds [m]
  std::optional<Vec3> direction;  // from the tip along the shaft; default: up and out of the picture
};

// A rigid body of the scenes: jaws, an obstacle.
struct Body {
  Vec3 box = Vec3::Zero();  // edges of a box about its position [m]; 0: it is a capsule
  double radius = 0;        // of a capsule [m]
  double length = 0;        // of its axis, from its position along z [m]
  Vec3 position = Vec3::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

struct Panel {
  std::filesystem::path mesh;  // VTU, VTP, OBJ, STL or PLY
  std::filesystem::path
      first;  // the mesh before any cut: faces that it has inside are drawn as cut; or empty
  std::string title;
  std::string color = "none";  // "none" (organ), "region", "body", or the name of a point or cell array
  std::optional<Eigen::Vector2d>
      range;  // of the colours; default: of the array, over all panels that show it
  bool edges = false;
  bool fibres = false;  // short lines along the cell array `fibre`, as far as it lies in the surface
  std::vector<Tool> tools;
  std::vector<Body> bodies;
};

struct Camera {
  Vec3 direction{0.3, -1, 0.4};  // from the organ to the eye
  Vec3 up{0, 0, 1};
  double zoom = 1;  // 1: all panels' meshes and tool tips just fit
};

// Tetrahedra whose rest position lies wholly beyond the plane, on the side its normal points to, are left
// out.
struct Clip {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitX();
};

struct Picture {
  std::filesystem::path out;
  Eigen::Vector2i size{1280, 960};  // width, height [pixels]
  std::vector<Panel> panels;        // side by side, with the same camera and scale
  Camera camera;
  std::optional<Clip> clip;
};

// Throws std::runtime_error with one line that names the place: "/pictures/0/panels/1/mesh: …".
std::vector<Picture> read_request(const std::filesystem::path& file);

}  // namespace picture
