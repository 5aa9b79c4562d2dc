#include "protocol.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "lobe/error.h"
#include "lobe/file/lists_all.h"
#include "lobe/scene/nearest_word.h"

namespace lobe::view {
namespace {

using Json = nlohmann::json;

constexpr double largest_number = 1e9;           // of coordinates, seconds, moduli …
constexpr std::size_t longest_text = 100;        // [bytes]
constexpr double largest_request_number = 9e15;  // that a double counts exactly

double number_in(const Json& json, const std::string& place, double largest) {
  if (!json.is_number()) throw InputError(place, "must be a number");
  const double value = json.get<double>();
  if (!std::isfinite(value) || std::abs(value) > largest) throw InputError(place, "is out of range");
  return value;
}

void read(const Json& json, const std::string& place, double& value) {
  value = number_in(json, place, largest_number);
}

void read(const Json& json, const std::string& place, int& hand) {
  if (!json.is_number_integer()) throw InputError(place, "must be an integer");
  const double number = json.get<double>();
  if (number < 0 || number >= hand_count) throw InputError(place, "must be 0 to 7");
  hand = static_cast<int>(number);
}

void read(const Json& json, const std::string& place, request::Whole& value) {
  constexpr double most = 1e6;
  if (!json.is_number_integer()) throw InputError(place, "must be an integer");
  value.value = static_cast<int>(number_in(json, place, most));
}

void read(const Json& json, const std::string& place, bool& value) {
  if (!json.is_boolean()) throw InputError(place, "must be true or false");
  value = json.get<bool>();
}

void read(const Json& json, const std::string& place, std::string& value) {
  if (!json.is_string() || json.get_ref<const std::string&>().size() > longest_text)
    throw InputError(place, "must be a text of at most 100 bytes");
  value = json.get<std::string>();
}

void read(const Json& json, const std::string& place, std::vector<std::string>& values) {
  constexpr std::size_t most = 100;
  if (!json.is_array() || json.size() > most) throw InputError(place, "must be a list of at most 100 texts");
  for (std::size_t i = 0; i < json.size(); ++i)
    read(json[i], place + "/" + std::to_string(i), values.emplace_back());
}

void read(const Json& json, const std::string& place, Vec3d& value) {
  if (!json.is_array() || json.size() != 3) throw InputError(place, "must be three numbers");
  for (int k = 0; k < 3; ++k)
    value[k] = number_in(json[std::size_t(k)], place + "/" + std::to_string(k), largest_number);
}

void read(const Json& json, const std::string& place, std::vector<Vec3d>& values) {
  constexpr std::size_t most = 100;
  if (!json.is_array() || json.size() > most) throw InputError(place, "must be a list of at most 100 points");
  for (std::size_t i = 0; i < json.size(); ++i)
    read(json[i], place + "/" + std::to_string(i), values.emplace_back());
}

// What a page says of a tool has numbers and texts like all that it says, and names no file of this machine.
void check_words(const Json& json, const std::string& place, int depth = 0) {
  constexpr std::size_t most = 100;
  constexpr int deepest = 8;
  if (json.size() > most || depth > deepest)
    throw InputError(place, "must have at most 100 entries, and lists in lists at most 8 deep");
  if (json.is_number()) number_in(json, place, largest_number);
  if (json.is_string() && json.get_ref<const std::string&>().size() > longest_text)
    throw InputError(place, "must be a text of at most 100 bytes");
  if (json.is_object() && json.contains("mesh"))
    throw InputError(place + "/mesh", "a page cannot name a file of the server");
  if (json.is_structured())
    for (const auto& [key, value] : json.items()) check_words(value, place + "/" + key, depth + 1);
}

void read(const Json& json, const std::string& place, ParsedTool& tool) {
  check_words(json, place);
  try {
    tool = parse_tool(json.dump());
  } catch (const InputError& error) {
    std::vector<Fault> faults = error.faults();
    for (Fault& fault : faults) fault.place = fault.place.starts_with('/') ? place + fault.place : place;
    throw InputError(std::move(faults));
  }
}

// In 16 bytes, filled up with zeros.
void put_name(std::string_view name, BlockWriter& out) {
  char label[16] = {};
  std::copy_n(name.begin(), std::min<std::size_t>(name.size(), sizeof label), label);
  out.put(std::span<const char>(label));
}

template <class T>
T read_fields(const Json& json) {
  T result;
  std::set<std::string> known = {"do", "number"};
  const auto read_one = [&](const auto& field) {
    known.insert(field.key);
    const std::string place = "/" + std::string(field.key);
    if (!json.contains(field.key)) throw InputError(place, std::string("is missing from ") + T::name);
    read(json[field.key], place, result.*(field.value));
  };
  static_assert(std::tuple_size_v<decltype(T::fields)> == io::member_count<T>(), "a member is never read");
  std::apply([&](const auto&... field) { (read_one(field), ...); }, T::fields);
  for (const auto& [key, value] : json.items())
    if (!known.contains(key)) throw InputError("/" + key, std::string("is no field of ") + T::name);
  return result;
}

template <class... T>
request::Any read_request(const Json& json, const std::string& name, std::variant<T...>*) {
  request::Any result;
  const bool is_known = ((name == T::name && (result = read_fields<T>(json), true)) || ...);
  if (is_known) return result;
  const std::string near = nearest_word(name, {T::name...});
  throw InputError(
      "/do", "\"" + name + "\" is no request" + (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
}

}  // namespace

void BlockWriter::begin(std::uint32_t block_tag) {
  begin_ = bytes_.size();
  put(block_tag);
  put(std::uint32_t(0));
}

// The size is that of the content, without padding.
void BlockWriter::end() {
  const auto size = static_cast<std::uint32_t>(bytes_.size() - begin_ - 8);
  std::memcpy(bytes_.data() + begin_ + 4, &size, sizeof size);
  fill_up();
}

std::vector<Block> read_blocks(std::string_view message) {
  std::vector<Block> blocks;
  for (std::size_t at = 0; at < message.size();) {
    const std::string place = "byte " + std::to_string(at);
    if (message.size() - at < 8) throw InputError(place, "the head of a block is cut off");
    std::uint32_t head[2];
    std::memcpy(head, message.data() + at, sizeof head);
    const std::size_t filled = (std::size_t(head[1]) + 3) / 4 * 4;
    if (message.size() - at - 8 < filled) throw InputError(place, "a block is longer than the message");
    blocks.push_back({head[0], message.substr(at + 8, head[1])});
    at += 8 + filled;
  }
  return blocks;
}

void write_topology(const SurfaceMesh& surface, const Mat3X<float>& rest, BlockWriter& out) {
  out.begin(topology_tag);
  out.put(static_cast<std::uint32_t>(surface.revision));
  out.put(static_cast<std::uint32_t>(surface.vertex_count()));
  out.put(static_cast<std::uint32_t>(surface.triangle_count()));
  out.put(std::span<const int>(surface.triangles.empty() ? nullptr : surface.triangles.data()->data(),
                               3 * surface.triangles.size()));
  out.put(std::span<const float>(rest.data(), std::size_t(rest.size())));
  out.put(std::span<const RegionModel>(surface.region));
  out.put(std::span<const std::uint8_t>(surface.cut));
  out.end();
}

void write_fibres(const SurfaceMesh& surface, const Mat3X<float>& rest, const Mat3X<double>& fibres,
                  BlockWriter& out) {
  if (fibres.cols() == 0) return;
  out.begin(fibres_tag);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Eigen::Vector3i& corner = surface.triangles[t];
    const Vec3d first = rest.col(corner[0]).cast<double>(), fibre = fibres.col(surface.owner[t].tet);
    Eigen::Matrix<double, 3, 2> sides;
    for (int k : {0, 1}) sides.col(k) = rest.col(corner[k + 1]).cast<double>() - first;
    const Eigen::Matrix2d products = sides.transpose() * sides;
    const Eigen::Vector2f parts = (products.inverse() * (sides.transpose() * fibre)).cast<float>();
    out.put(std::span<const float>(parts.data(), 2));
  }
  out.end();
}

void write_bodies(const SurfaceMesh& surface, const MeshBodies& bodies, BlockWriter& out) {
  if (!bodies.any()) return;
  out.begin(bodies_tag);
  out.put(std::span<const std::uint8_t>(surface.body));
  out.end();
}

void write_lines(std::span<const LinesSnapshot> lines, BlockWriter& out) {
  if (lines.empty()) return;
  out.begin(lines_tag);
  out.put(static_cast<std::uint32_t>(lines.size()));
  for (const LinesSnapshot& line : lines) {
    put_name(line.term, out);
    out.put(static_cast<std::uint32_t>(line.tensions.size()));
  }
  for (const LinesSnapshot& line : lines)
    out.put(std::span<const float>(line.ends.data(), std::size_t(line.ends.size())));
  for (const LinesSnapshot& line : lines) out.put(std::span<const float>(line.tensions));
  for (const LinesSnapshot& line : lines)
    for (std::size_t i = 0; i < line.tensions.size(); ++i)
      out.put(line.damages.empty() ? 0.0f : line.damages[i]);
  out.end();
}

void write_positions(const SurfaceMesh& surface, const Mat3X<float>& x, BlockWriter& out) {
  out.begin(positions_tag);
  out.put(static_cast<std::uint32_t>(surface.revision));
  out.put(std::span<const float>(x.data(), std::size_t(x.size())));
  out.end();
}

void write_skin(std::uint64_t revision, std::span<const Eigen::Vector3i> triangles, const Mat3X<float>& rest,
                BlockWriter& out) {
  out.begin(skin_tag);
  out.put(static_cast<std::uint32_t>(revision));
  out.put(static_cast<std::uint32_t>(rest.cols()));
  out.put(static_cast<std::uint32_t>(triangles.size()));
  out.put(std::span<const int>(triangles.empty() ? nullptr : triangles.data()->data(), 3 * triangles.size()));
  out.put(std::span<const float>(rest.data(), std::size_t(rest.size())));
  out.end();
}

void write_skin_positions(std::uint64_t revision, const Mat3X<float>& x, BlockWriter& out) {
  out.begin(skin_positions_tag);
  out.put(static_cast<std::uint32_t>(revision));
  out.put(std::span<const float>(x.data(), std::size_t(x.size())));
  out.end();
}

void write_scalar(std::string_view name, std::span<const float> values, BlockWriter& out) {
  float low = 0, high = 1;
  if (!values.empty()) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    low = *least;
    high = *most;
  }
  std::vector<std::uint16_t> steps(values.size());
  const float scale = high > low ? 65535 / (high - low) : 0;
  std::transform(values.begin(), values.end(), steps.begin(),
                 [&](float value) { return static_cast<std::uint16_t>(std::lround((value - low) * scale)); });
  out.begin(scalar_tag);
  put_name(name, out);
  out.put(low);
  out.put(high);
  out.put(std::span<const std::uint16_t>(steps));
  out.end();
}

void write_json(std::uint32_t block_tag, const std::string& json, BlockWriter& out) {
  out.begin(block_tag);
  out.put_text(json);
  out.end();
}

Request parse_request(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw InputError("request", "is no JSON");
  if (!json.is_object()) throw InputError("request", "must be an object");
  if (!json.contains("do") || !json["do"].is_string()) throw InputError("/do", "must name the request");
  Request request;
  if (json.contains("number")) request.number = number_in(json["number"], "/number", largest_request_number);
  request.what = read_request(json, json["do"].get<std::string>(), static_cast<request::Any*>(nullptr));
  return request;
}

}  // namespace lobe::view
