// Tables of the keys that the structs of a scene have in JSON. Internal, not part of the public interface.
//
// A row says a key, its member, what values it takes, and in a sentence what it means. The default is that of
// the struct. Reader and writer follow the rows; scene.schema.json and the tables of docs/scene.md are
// compared with them by tests/scene/key_table_test.cpp, which writes the former.
#pragma once

#include <algorithm>
#include <concepts>
#include <filesystem>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/scene/json_text.h"
#include "lobe/scene/scene.h"

namespace lobe::keys {

// What a key takes: a range of numbers, their unit, and whether the key must be there.
struct Takes {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool is_above = false, is_below = false;  // without the limit itself
  const char* unit = "";
  const char* schema = "";      // as JSON, where neither type nor range says it
  const char* type = "";        // in words, where the type of the member does not say it
  std::size_t least_items = 0;  // of a list
  bool is_one_or_list = false;  // a list, or one item of it by itself
  bool is_or_false = false;     // a number, or false in place of 0
  bool is_required = false;
  bool has_default = true;  // that of the struct; else something depends on whether the key is there
  bool is_quiet = false;    // not written where it has its default

  template <class Value>
  constexpr Takes with(Value Takes::*member, Value value) const {
    Takes changed = *this;
    changed.*member = value;
    return changed;
  }
  constexpr Takes up_to(double limit) const { return with(&Takes::most, limit); }
  constexpr Takes below(double limit) const { return up_to(limit).with(&Takes::is_below, true); }
  constexpr Takes in(const char* symbol) const { return with(&Takes::unit, symbol); }
  constexpr Takes items(std::size_t count) const { return with(&Takes::least_items, count); }
  constexpr Takes or_one() const { return with(&Takes::is_one_or_list, true); }
  constexpr Takes or_false() const { return with(&Takes::is_or_false, true); }
  constexpr Takes required() const { return with(&Takes::is_required, true); }
  constexpr Takes quiet() const { return with(&Takes::is_quiet, true); }
  constexpr Takes derived() const { return with(&Takes::has_default, false); }
  constexpr Takes optional() const { return derived().quiet(); }
  constexpr Takes as(const char* json, const char* words) const {
    return with(&Takes::schema, json).with(&Takes::type, words);
  }
};
inline constexpr Takes any{};
constexpr Takes at_least(double limit) { return {.least = limit}; }
constexpr Takes above(double limit) { return {.least = limit, .is_above = true}; }
inline constexpr double most_index = std::numeric_limits<Index>::max();
inline constexpr Takes index = at_least(0).up_to(most_index);

template <class Member>  // pointer to a member, or a function that finds one
struct Key {
  const char* key;
  Member member;
  Takes takes;
  const char* sentence;
  constexpr Key(const char* k, Member m, Takes t, const char* s) : key(k), member(m), takes(t), sentence(s) {}
};

// ---- What else a row may have for a member. Reading calls it with a struct that changes, for what is set;
// writing with one that does not, for a pointer: null where the struct has something else.

// A member of a member.
template <class Struct, class Part, class Value>
struct In {
  Part Struct::*part;
  Value Part::*member;
  constexpr In(Part Struct::*p, Value Part::*m) : part(p), member(m) {}
  Value& operator()(Struct& whole) const { return whole.*part.*member; }
  const Value& operator()(const Struct& whole) const { return whole.*part.*member; }
};
// A member that means something where another one has a certain value, which reading sets.
template <class Struct, class Tag, class Value>
struct Case {
  Tag Struct::*tag;
  Tag required;
  Value Struct::*member;
  constexpr Case(Tag Struct::*t, Tag r, Value Struct::*m) : tag(t), required(r), member(m) {}
  Value& operator()(Struct& whole) const {
    whole.*tag = required;
    return whole.*member;
  }
  const Value* operator()(const Struct& whole) const {
    return whole.*tag == required ? &(whole.*member) : nullptr;
  }
};
// One of the types that a member may have, or the whole (std::identity); or a member of that type.
template <class Part, class What>
struct Alternative {
  What what;
  template <class Struct>
  Part& operator()(Struct& whole) const {
    return std::invoke(what, whole).template emplace<Part>();
  }
  template <class Struct>
  const Part* operator()(const Struct& whole) const {
    return std::get_if<Part>(&std::invoke(what, whole));
  }
};
template <class Part, class What>
constexpr auto alternative(What what) {
  return Alternative<Part, What>{what};
}
template <class What, class Part, class Value>
struct PartOfAlternative {
  Alternative<Part, What> part;
  Value Part::*member;
  template <class Struct>
  Value& operator()(Struct& whole) const {
    return part(whole).*member;
  }
  template <class Struct>
  const Value* operator()(const Struct& whole) const {
    const Part* found = part(whole);
    return found ? &(found->*member) : nullptr;
  }
};
template <class What, class Part, class Value>
constexpr auto alternative(What what, Value Part::*member) {
  return PartOfAlternative<What, Part, Value>{{what}, member};
}
// A member that is written only where a condition holds.
template <class Struct, class Value, class Condition>
struct When {
  Value Struct::*member;
  Condition holds;
  constexpr When(Value Struct::*m, Condition c) : member(m), holds(c) {}
  Value& operator()(Struct& whole) const { return whole.*member; }
  const Value* operator()(const Struct& whole) const { return holds(whole) ? &(whole.*member) : nullptr; }
};
inline constexpr auto never = [](const auto&) { return false; };
struct True {};  // a key that can only be true
inline True is_true;
// The value of a member, said by the key alone.
template <class Struct, class Tag>
struct Says {
  Tag Struct::*tag;
  Tag said;
  constexpr Says(Tag Struct::*t, Tag s) : tag(t), said(s) {}
  True& operator()(Struct& whole) const {
    whole.*tag = said;
    return is_true;
  }
  const True* operator()(const Struct& whole) const { return whole.*tag == said ? &is_true : nullptr; }
};

// What a hook reads, and nothing writes.
template <class Value>
struct NotKept {
  bool is_not_kept = true;
  template <class Struct>
  Value& operator()(Struct&) const;
  template <class Struct>
  const Value* operator()(const Struct&) const {
    return nullptr;
  }
};

template <class Struct, class Member>
using MemberType = std::remove_cvref_t<std::invoke_result_t<Member, Struct&>>;

template <class... Rows>
struct Table {
  const char* definition;  // its name in the schema
  const char* rules;       // what the schema says of keys that go together or are gone, as JSON; or ""
  std::tuple<Rows...> rows;
  constexpr Table(const char* d, const char* r, Rows... all) : definition(d), rules(r), rows(all...) {}
};
// For a member: an object with keys of the same struct, which has a certain value where the object is.
template <class Struct, class Tag, class... Rows>
struct Inner {
  Tag Struct::*tag;
  Tag said;
  Table<Rows...> table;
  constexpr Inner(Tag Struct::*t, Tag s, Table<Rows...> rows) : tag(t), said(s), table(rows) {}
};
struct NoTable {};
template <class Struct>
inline constexpr NoTable table_of{};
template <class Struct>
concept HasKeys = !std::same_as<std::remove_cvref_t<decltype(table_of<Struct>)>, NoTable>;
// The words for the values of an enumeration.
template <class Enum>
inline constexpr std::array<const char*, 0> words_of{};
template <class Enum>
concept HasWords = (words_of<Enum>.size() > 0);

// How a type is read and written that has a form of its own, and its schema.
template <class Value>
struct Form;
template <class Value>
concept HasForm = requires {
  Form<Value>::schema;
};

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
  std::apply([&](const auto&... row) { (visit(row), ...); }, table.rows);
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
