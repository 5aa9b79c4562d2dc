// How structs of a scene are read and written by the tables of their keys (key_rows.h). Internal, not part of
// the public interface.
#pragma once

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lobe/scene/json_text.h"
#include "lobe/scene/key_rows.h"
#include "lobe/scene/scene.h"

namespace lobe::keys {

template <>
struct Form<Vec3d> {
  static constexpr const char* schema = R"({"$ref": "#/definitions/vector"})";
  static void read(const nlohmann::json& given, Vec3d& value) {
    for (int i = 0; i < 3; ++i)  // null: see Boundary::axes
      value[i] = given[std::size_t(i)].is_null() ? 0 : given[std::size_t(i)].get<double>();
  }
  static nlohmann::ordered_json write(const Vec3d& value) { return vector_json(value); }
};
template <>
struct Form<Eigen::Vector4d> {
  static constexpr const char* schema =
      R"({"type": "array", "minItems": 4, "maxItems": 4, "items": {"type": "number"}})";
  static void read(const nlohmann::json& given, Eigen::Vector4d& value) {
    for (int i = 0; i < 4; ++i) value[i] = given[std::size_t(i)].get<double>();
  }
  static nlohmann::ordered_json write(const Eigen::Vector4d& q) { return {q[0], q[1], q[2], q[3]}; }
};
template <>
struct Form<std::filesystem::path> {
  static constexpr const char* schema = R"({"type": "string"})";
  static void read(const nlohmann::json& given, std::filesystem::path& value) {
    const auto& text = given.get_ref<const std::string&>();
    value = std::u8string(text.begin(), text.end());
  }
  static nlohmann::ordered_json write(const std::filesystem::path& value) {
    const std::u8string text = value.u8string();
    return std::string(text.begin(), text.end());
  }
};

template <class Value>
struct ListOf : std::false_type {};
template <class Item>
struct ListOf<std::vector<Item>> : std::true_type {};

template <class... Rows, class Visit>
void for_each_key(const Table<Rows...>& table, const Visit& visit) {
  const auto each = [&](const auto& row) {
    if constexpr (requires { row.rows; })
      for_each_key(row, visit);  // a part of the table
    else
      visit(row);
  };
  std::apply([&](const auto&... row) { (each(row), ...); }, table.rows);
}

// ---- Reading, of a document that satisfies the schema.

template <class Struct>
void read_keys(const nlohmann::json& object, Struct& value, const std::string& place);

template <class Value>
void read_value(const nlohmann::json& given, Value& value, const std::string& place) {
  if constexpr (std::is_empty_v<Value>) {
    return;
  } else if constexpr (HasForm<Value>) {
    if constexpr (requires { Form<Value>::read(given, value, place); })
      Form<Value>::read(given, value, place);
    else
      Form<Value>::read(given, value);
  } else if constexpr (HasKeys<Value>) {
    read_keys(given, value, place);
  } else if constexpr (HasWords<Value>) {
    const auto word = std::find(words_of<Value>.begin(), words_of<Value>.end(), given.get<std::string>());
    value = Value(word - words_of<Value>.begin());
  } else if constexpr (requires { value.emplace(); }) {
    read_value(given, value.emplace(), place);
  } else if constexpr (ListOf<Value>::value) {
    value.clear();
    if (!given.is_array()) return read_value(given, value.emplace_back(), place);  // one by itself
    for (const nlohmann::json& item : given) {
      const std::string at = child_pointer(place, value.size());
      read_value(item, value.emplace_back(), at);
    }
  } else if constexpr (std::floating_point<Value>) {
    value = given.is_boolean() ? Value(given.get<bool>()) : given.get<Value>();
  } else {
    given.get_to(value);
  }
}

template <class Struct, class... Rows>
void read_rows(const Table<Rows...>& table, const nlohmann::json& object, Struct& value,
               const std::string& place) {
  for_each_key(table, [&](const auto& row) {
    const auto found = object.find(row.key);
    if (found == object.end()) return;
    const std::string at = child_pointer(place, row.key);
    if constexpr (requires { row.member.table; }) {
      value.*row.member.tag = row.member.said;
      read_rows(row.member.table, *found, value, at);
    } else if constexpr (!requires { row.member.is_not_kept; }) {
      read_value(*found, std::invoke(row.member, value), at);
    }
  });
}

template <class Struct>
void read_keys(const nlohmann::json& object, Struct& value, const std::string& place) {
  if constexpr (requires { value.pointer; }) value.pointer = place;
  read_rows(table_of<Struct>, object, value, place);
  if constexpr (requires { after_reading(object, value); }) after_reading(object, value);
}

template <class Value>
Value read_from(const nlohmann::json& given) {
  Value value;
  read_value(given, value, "");
  return value;
}

// ---- Writing.

template <class Struct>
void write_keys(const Struct& value, nlohmann::ordered_json& object);

template <class Value>
nlohmann::ordered_json write_value(const Value& value) {
  if constexpr (std::is_pointer_v<Value>) {
    return write_value(*value);
  } else if constexpr (HasForm<Value>) {
    return Form<Value>::write(value);
  } else if constexpr (std::is_empty_v<Value>) {
    if constexpr (HasWords<Value>) return words_of<Value>[0];
    return true;
  } else if constexpr (HasKeys<Value>) {
    nlohmann::ordered_json object = nlohmann::ordered_json::object();
    write_keys(value, object);
    return object;
  } else if constexpr (HasWords<Value>) {
    return words_of<Value>[std::size_t(value)];
  } else if constexpr (requires { value.has_value(); }) {
    return write_value(*value);
  } else if constexpr (ListOf<Value>::value) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const auto& item : value) list.push_back(write_value(item));
    return list;
  } else {
    return value;
  }
}

template <class Value>
bool is_default(const Value& value, const Value& standard) {
  if constexpr (std::is_pointer_v<Value>)
    return !value;
  else if constexpr (requires { value.has_value(); })
    return !value.has_value();
  else if constexpr (ListOf<Value>::value)
    return value.empty();
  else if constexpr (std::equality_comparable<Value>)
    return value == standard;
  else
    return false;
}

template <class Struct, class... Rows>
void write_rows(const Table<Rows...>& table, const Struct& value, nlohmann::ordered_json& object) {
  static const Struct standard{};
  for_each_key(table, [&](const auto& row) {
    if constexpr (requires { row.member.table; }) {
      if (value.*row.member.tag == row.member.said)
        write_rows(row.member.table, value, object[row.key] = nlohmann::ordered_json::object());
    } else {
      const auto& member = std::invoke(row.member, value);
      constexpr bool may_be_null = std::is_pointer_v<std::remove_cvref_t<decltype(member)>>;
      if ((may_be_null || row.takes.is_quiet) && is_default(member, std::invoke(row.member, standard)))
        return;
      object[row.key] = write_value(member);
    }
  });
}

template <class Struct>
void write_keys(const Struct& value, nlohmann::ordered_json& object) {
  write_rows(table_of<Struct>, value, object);
  if constexpr (requires { after_writing(value, object); }) after_writing(value, object);
}

}  // namespace lobe::keys
