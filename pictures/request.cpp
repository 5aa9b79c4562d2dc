#include "request.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace picture {
namespace {

using nlohmann::json;
using Place = std::string;  // a JSON pointer, for messages

[[noreturn]] void fail(const std::string& place, const std::string& message) {
  throw std::runtime_error((place.empty() ? "/" : place) + ": " + message);
}

void check_keys(const json& object, const std::string& place, std::initializer_list<const char*> known) {
  if (!object.is_object()) fail(place, "must be an object");
  std::string list;
  for (const char* key : known) list += (list.empty() ? "" : ", ") + std::string(key);
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end())
      fail(place + "/" + key, "unknown key; known: " + list);
  }
}

double number(const json& value, const std::string& place) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) fail(place, "must be a number");
  return value.get<double>();
}

double positive(const json& value, const std::string& place) {
  const double x = number(value, place);
  if (!(x > 0)) fail(place, "must be above 0");
  return x;
}

std::string text(const json& value, const std::string& place) {
  if (!value.is_string()) fail(place, "must be a string");
  return value.get<std::string>();
}

template <int size>
Eigen::Matrix<double, size, 1> numbers(const json& value, const std::string& place) {
  if (!value.is_array() || value.size() != size)
    fail(place, "must be an array of " + std::to_string(size) + " numbers");
  Eigen::Matrix<double, size, 1> result;
  for (int i = 0; i < size; ++i) result[i] = number(value[i], place + "/" + std::to_string(i));
  return result;
}

Vec3 direction(const json& value, const std::string& place) {
  const Vec3 v = numbers<3>(value, place);
  if (v.norm() == 0) fail(place, "must not be zero");
  return v.normalized();
}

// Calls read(value, place) if the object has the key.
void optional_key(const json& object, const std::string& place, const char* key, const auto& read) {
  if (const auto found = object.find(key); found != object.end()) read(*found, place + "/" + key);
}

const json& required_key(const json& object, const std::string& place, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) fail(place + "/" + key, "is missing");
  return *found;
}

// Calls read(element, place) for each element of an array.
void for_each(const json& array, const std::string& place, const auto& read) {
  if (!array.is_array()) fail(place, "must be an array");
  for (std::size_t i = 0; i < array.size(); ++i) read(array[i], place + "/" + std::to_string(i));
}

ToolType tool_type(const std::string& name) {
  if (name == "cautery") return ToolType::cautery;
  if (name == "grasp") return ToolType::grasp;
  if (name == "scalpel") return ToolType::scalpel;
  return ToolType::probe;  // as which all other kinds are drawn
}

Tool read_tool(const json& object, const std::string& place) {
  check_keys(object, place, {"type", "position", "radius", "points", "direction"});
  Tool tool;
  tool.type = tool_type(text(required_key(object, place, "type"), place + "/type"));
  tool.position = numbers<3>(required_key(object, place, "position"), place + "/position");
  optional_key(object, place, "radius",
               [&](const json& v, const Place& at) { tool.radius = positive(v, at); });
  optional_key(object, place, "direction",
               [&](const json& v, const Place& at) { tool.direction = direction(v, at); });
  optional_key(object, place, "points", [&](const json& v, const Place& at) {
    for_each(v, at,
             [&](const json& point, const Place& there) { tool.points.push_back(numbers<3>(point, there)); });
  });
  return tool;
}

Body read_body(const json& object, const std::string& place) {
  check_keys(object, place, {"box", "capsule", "position", "orientation"});
  if (object.contains("box") == object.contains("capsule")) fail(place, "needs \"box\" or \"capsule\"");
  Body body;
  optional_key(object, place, "box", [&](const json& v, const Place& at) {
    body.box = numbers<3>(v, at);
    if (!(body.box.minCoeff() > 0)) fail(at, "must be above 0");
  });
  optional_key(object, place, "capsule", [&](const json& v, const Place& at) {
    const auto size = numbers<2>(v, at);
    if (!(size[0] > 0) || size[1] < 0) fail(at, "must be [radius, length], above 0 and at least 0");
    body.radius = size[0];
    body.length = size[1];
  });
  body.position = numbers<3>(required_key(object, place, "position"), place + "/position");
  optional_key(object, place, "orientation", [&](const json& v, const Place& at) {
    body.orientation.coeffs() = numbers<4>(v, at);
    if (!(body.orientation.norm() > 0)) fail(at, "must not be zero");
    body.orientation.normalize();
  });
  return body;
}

std::filesystem::path mesh_path(const json& value, const std::string& place,
                                const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / text(value, place);
  if (!std::filesystem::is_regular_file(file)) fail(place, file.string() + ": no such file");
  return file;
}

Panel read_panel(const json& object, const std::string& place, const std::filesystem::path& folder) {
  check_keys(object, place,
             {"mesh", "first", "title", "color", "range", "edges", "fibres", "tools", "bodies"});
  Panel panel;
  panel.mesh = mesh_path(required_key(object, place, "mesh"), place + "/mesh", folder);
  optional_key(object, place, "first",
               [&](const json& v, const Place& at) { panel.first = mesh_path(v, at, folder); });
  optional_key(object, place, "title", [&](const json& v, const Place& at) { panel.title = text(v, at); });
  optional_key(object, place, "color", [&](const json& v, const Place& at) { panel.color = text(v, at); });
  optional_key(object, place, "range", [&](const json& v, const Place& at) {
    panel.range = numbers<2>(v, at);
    if ((*panel.range)[0] >= (*panel.range)[1]) fail(at, "must be [smallest, largest]");
  });
  const auto read_flag = [&](const char* key, bool& flag) {
    optional_key(object, place, key, [&](const json& v, const Place& at) {
      if (!v.is_boolean()) fail(at, "must be true or false");
      flag = v.get<bool>();
    });
  };
  read_flag("edges", panel.edges);
  read_flag("fibres", panel.fibres);
  optional_key(object, place, "tools", [&](const json& v, const Place& at) {
    for_each(v, at,
             [&](const json& tool, const Place& there) { panel.tools.push_back(read_tool(tool, there)); });
  });
  optional_key(object, place, "bodies", [&](const json& v, const Place& at) {
    for_each(v, at,
             [&](const json& body, const Place& there) { panel.bodies.push_back(read_body(body, there)); });
  });
  return panel;
}

Camera read_camera(const json& object, const std::string& place) {
  check_keys(object, place, {"direction", "up", "zoom"});
  Camera camera;
  optional_key(object, place, "direction",
               [&](const json& v, const Place& at) { camera.direction = direction(v, at); });
  optional_key(object, place, "up", [&](const json& v, const Place& at) { camera.up = direction(v, at); });
  optional_key(object, place, "zoom", [&](const json& v, const Place& at) { camera.zoom = positive(v, at); });
  if (camera.direction.cross(camera.up).norm() < 1e-6 * camera.direction.norm())
    fail(place, "direction and up must not be parallel");
  return camera;
}

Clip read_clip(const json& object, const std::string& place) {
  check_keys(object, place, {"point", "normal"});
  return {numbers<3>(required_key(object, place, "point"), place + "/point"),
          direction(required_key(object, place, "normal"), place + "/normal")};
}

Eigen::Vector2i read_size(const json& value, const std::string& place) {
  const Eigen::Vector2d size = numbers<2>(value, place);
  if (size.minCoeff() < 16 || size.maxCoeff() > 8192 || size != size.array().round().matrix())
    fail(place, "must be two whole numbers of pixels from 16 to 8192");
  return size.cast<int>();
}

Picture read_picture(const json& object, const std::string& place, const std::filesystem::path& folder) {
  check_keys(object, place, {"out", "size", "panels", "camera", "clip"});
  Picture picture;
  picture.out = folder / text(required_key(object, place, "out"), place + "/out");
  if (picture.out.extension() != ".png") fail(place + "/out", "must end in .png");
  optional_key(object, place, "size",
               [&](const json& v, const Place& at) { picture.size = read_size(v, at); });
  for_each(required_key(object, place, "panels"), place + "/panels", [&](const json& panel, const Place& at) {
    picture.panels.push_back(read_panel(panel, at, folder));
  });
  if (picture.panels.empty()) fail(place + "/panels", "must not be empty");
  optional_key(object, place, "camera",
               [&](const json& v, const Place& at) { picture.camera = read_camera(v, at); });
  optional_key(object, place, "clip",
               [&](const json& v, const Place& at) { picture.clip = read_clip(v, at); });
  return picture;
}

std::string without_newlines(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  return message;
}

}  // namespace

std::vector<Picture> read_request(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in || std::filesystem::is_directory(file))
    throw std::runtime_error(file.string() + ": cannot be read");
  json request;
  try {
    request = json::parse(in);
  } catch (const json::exception& error) {
    throw std::runtime_error(file.string() + ": " + without_newlines(error.what()));
  }
  check_keys(request, "", {"pictures"});
  std::vector<Picture> pictures;
  for_each(required_key(request, "", "pictures"), "/pictures", [&](const json& picture, const Place& at) {
    pictures.push_back(read_picture(picture, at, file.parent_path()));
  });
  return pictures;
}

}  // namespace picture
