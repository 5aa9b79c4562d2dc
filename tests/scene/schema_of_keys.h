// The schema, and rows of the tables of docs/scene.md, that the tables of keys (scene/key_table.h) stand for.
#pragma once

#include <cmath>
#include <regex>

#include "lobe/scene/key_table.h"

namespace lobe::test {

using keys::Takes;
using nlohmann::ordered_json;

// A limit as short as it can be said: 0, not 0.0.
inline ordered_json number(double value) {
  return value == std::floor(value) && std::abs(value) < 1e15 ? ordered_json(std::int64_t(value))
                                                              : ordered_json(value);
}

inline ordered_json shortened(ordered_json value) {
  if (value.is_number_float()) return number(value);
  if (value.is_array())
    for (ordered_json& item : value) item = shortened(item);
  return value;
}

inline void add_range(const Takes& takes, ordered_json& schema) {
  if (std::isfinite(takes.least))
    schema[takes.is_above ? "exclusiveMinimum" : "minimum"] = number(takes.least);
  if (std::isfinite(takes.most)) schema[takes.is_below ? "exclusiveMaximum" : "maximum"] = number(takes.most);
}

inline ordered_json list_of(const ordered_json& items, std::size_t least, std::size_t most = 0) {
  ordered_json schema = {{"type", "array"}};
  if (least > 0) schema["minItems"] = least;
  if (most > 0) schema["maxItems"] = most;
  schema["items"] = items;
  return schema;
}

inline ordered_json reference(const std::string& name) { return {{"$ref", "#/definitions/" + name}}; }

// An item by itself has the keys of its definition.
template <class Item>
ordered_json one_or_list() {
  if constexpr (!keys::HasKeys<Item>)
    return {};
  else {
    const std::string name = keys::table_of<Item>.definition;
    ordered_json schema = {
        {"type", {"array", "object"}}, {"items", reference(name)}, {"additionalProperties", false}};
    keys::for_each_key(keys::table_of<Item>, [&](const auto& row) {
      if (row.takes.is_required) schema["required"].push_back(row.key);
      schema["properties"][row.key] = reference(name + "/properties/" + row.key);
    });
    return schema;
  }
}

template <class Struct>
ordered_json schema_of();

inline ordered_json of_type(const ordered_json& type, const Takes& takes) {
  ordered_json schema = {{"type", type}};
  if (takes.least_items > 0) schema["minLength"] = takes.least_items;
  add_range(takes, schema);
  return schema;
}

inline ordered_json of_form(const char* form, const Takes& takes) {
  ordered_json schema = ordered_json::parse(form);
  if (takes.least_items > 0 && schema.value("type", "") == "string") schema["minLength"] = takes.least_items;
  return schema;
}

template <class Value>
ordered_json schema_of_value(const Takes& takes) {
  if (*takes.schema) return ordered_json::parse(takes.schema);
  if constexpr (keys::HasForm<Value>)
    return of_form(keys::Form<Value>::schema, takes);
  else if constexpr (keys::HasKeys<Value>)
    return *keys::table_of<Value>.definition ? reference(keys::table_of<Value>.definition)
                                             : schema_of<Value>();
  else if constexpr (std::is_empty_v<Value> && !keys::HasWords<Value>)
    return {{"enum", {true}}};
  else if constexpr (std::same_as<Value, std::array<Index, 2>>)
    return list_of(reference("index"), 2, 2);
  else if constexpr (keys::HasWords<Value>)
    return {{"enum", keys::words_of<Value>}};
  else if constexpr (requires(Value v) { v.has_value(); })
    return schema_of_value<typename Value::value_type>(takes);
  else if constexpr (keys::ListOf<Value>::value)
    return takes.is_one_or_list
               ? one_or_list<typename Value::value_type>()
               : list_of(schema_of_value<typename Value::value_type>(takes), takes.least_items);
  else if constexpr (std::same_as<Value, bool>)
    return {{"type", "boolean"}};
  else if constexpr (std::integral<Value>)
    return takes.least == 0 && takes.most == keys::most_index ? reference("index")
                                                              : of_type("integer", takes);
  else if constexpr (std::floating_point<Value>)
    return of_type(takes.is_or_false ? ordered_json{"number", "boolean"} : ordered_json("number"), takes);
  else
    return of_type("string", takes);
}

// "Mass-proportional damping [1/s]."
inline std::string description(const Takes& takes, std::string sentence) {
  if (*takes.unit) sentence += std::string(sentence.empty() ? "[" : " [") + takes.unit + "]";
  if (sentence.empty()) return "";
  sentence[0] = char(std::toupper(sentence[0]));
  return sentence + (sentence.front() == '[' ? "" : ".");
}

template <class Struct, class Rows>
ordered_json schema_of_table(const Rows& table) {
  ordered_json schema = {{"type", "object"}, {"additionalProperties", false}}, required, properties;
  const Struct standard{};
  keys::for_each_key(table, [&](const auto& row) {
    ordered_json& property = properties[row.key];
    if (row.takes.is_required) required.push_back(row.key);
    if constexpr (requires { row.member.table; }) {
      property = schema_of_table<Struct>(row.member.table);
    } else {
      using Value = keys::MemberType<Struct, decltype(row.member)>;
      property = schema_of_value<Value>(row.takes);
      if (!row.takes.is_required && row.takes.has_default)
        property["default"] = shortened(keys::write_value(std::invoke(row.member, standard)));
    }
    const std::string text = description(row.takes, row.sentence);
    if (!text.empty()) property["description"] = text;
  });
  if (!required.empty()) schema["required"] = required;
  if (const std::string rules = table.rules; !rules.empty()) schema.update(ordered_json::parse(rules));
  if (!properties.is_null()) schema["properties"] = properties;
  return schema;
}

template <class Struct>
ordered_json schema_of() {
  return schema_of_table<Struct>(keys::table_of<Struct>);
}

// The definition of a table that has only some of its keys: the others, and the rules, stay.
template <class Struct, class Rows>
ordered_json completed(ordered_json definition, const Rows& table) {
  const ordered_json schema = schema_of_table<Struct>(table);
  for (const auto& [key, property] : schema["properties"].items()) definition["properties"][key] = property;
  for (const auto& key : schema.value("required", ordered_json::array()))
    if (auto& required = definition["required"];
        std::find(required.begin(), required.end(), key) == required.end())
      required.push_back(key);
  return definition;
}

// All that a scene says of a tool of a kind.
template <class Said>
ordered_json schema_of_tool() {
  const ordered_json start = {{"type", "object"},
                              {"additionalProperties", false},
                              {"required", {"type"}},
                              {"properties",
                               {{"name", {{"type", "string"}, {"description", "Default: the type."}}},
                                {"type", {{"const", Said::type}}}}}};
  return completed<Said>(start, keys::table_of<Said>);
}

// ---- JSON as people write it.

inline std::string in_one_line(const ordered_json& value) {
  if (!value.is_structured()) return value.dump();
  std::string text;
  for (const auto& [key, item] : value.items()) {
    if (!text.empty()) text += ", ";
    if (value.is_object()) text += ordered_json(key).dump() + ": ";
    text += in_one_line(item);
  }
  return value.is_object() ? "{" + text + "}" : "[" + text + "]";
}

// ---- Rows of the tables: | `damping` | number ≥ 0 [1/s] | 0 | mass-proportional damping

inline std::string range_in_words(const Takes& takes) {
  const auto limit = [](double value) { return number(value).dump(); };
  if (std::isfinite(takes.least) && std::isfinite(takes.most))
    return " in " + std::string(takes.is_above ? "(" : "[") + limit(takes.least) + ", " + limit(takes.most) +
           (takes.is_below ? ")" : "]");
  if (std::isfinite(takes.least)) return (takes.is_above ? " > " : " ≥ ") + limit(takes.least);
  return "";
}

template <class Item>
std::string item_in_words() {
  if (std::same_as<Item, double>) return " of numbers";
  return std::same_as<Item, Vec3d> ? " of [x, y, z]" : "";
}

template <class Value>
std::string type_in_words(const Takes& takes) {
  if (*takes.type) return takes.type;
  if constexpr (std::same_as<Value, RigidShape>) return "shape";
  if constexpr (keys::HasWords<Value>) {
    std::string words;
    for (const char* word : keys::words_of<Value>)
      words += (words.empty() ? "`\"" : ", `\"") + std::string(word) + "\"`";
    return words;
  } else if constexpr (std::same_as<Value, Selector>)
    return "selector";
  else if constexpr (keys::HasKeys<Value>)
    return "object";
  else if constexpr (requires { keys::Form<Value>::type; })
    return keys::Form<Value>::type;
  else if constexpr (std::is_empty_v<Value>)
    return "`true`";
  else if constexpr (std::same_as<Value, std::array<Index, 2>>)
    return "two integers";
  else if constexpr (std::same_as<Value, Vec3d>)
    return "[x, y, z]";
  else if constexpr (std::same_as<Value, Eigen::Vector4d>)
    return "[x, y, z, w]";
  else if constexpr (requires(Value v) { v.has_value(); })
    return type_in_words<typename Value::value_type>(takes);
  else if constexpr (keys::ListOf<Value>::value)
    return std::string(takes.is_one_or_list ? "object or " : "") + "list" +
           item_in_words<typename Value::value_type>();
  else if constexpr (std::same_as<Value, bool>)
    return "boolean";
  else if constexpr (std::integral<Value>)
    return "integer" + range_in_words(takes);
  else if constexpr (std::floating_point<Value>)
    return "number" + range_in_words(takes);
  else
    return "string";
}

// 1/30 rather than 0.03333333333333333; words and lists in backquotes.
inline std::string default_in_words(const ordered_json& value) {
  const std::string text = in_one_line(shortened(value));
  if (!value.is_number()) return "`" + text + "`";
  const double inverse = 1 / value.get<double>();
  if (text.size() > 8 && std::abs(inverse - std::round(inverse)) < 1e-9) return "1/" + number(inverse).dump();
  return number(value.get<double>()).dump();
}

// What a row of a page says. The page may go on behind the sentence, has links, and says its own where there
// is no default.
struct PageRow {
  std::string start, sentence;
  bool has_default;
  bool is_on(const std::string& page) const {
    for (std::size_t at = page.find(start); at != std::string::npos; at = page.find(start, at + 1)) {
      const std::size_t meaning =
          has_default ? at + start.size() : page.find(" | ", at + start.size() - 1) + 3;
      if (page.compare(meaning, sentence.size(), sentence) == 0) return true;
    }
    return false;
  }
};

template <class Struct, class Row>
PageRow row_in_words(const Row& row) {
  const Struct standard{};
  using Value = keys::MemberType<Struct, decltype(row.member)>;
  std::string start = "\n| `" + std::string(row.key) + "` | " + type_in_words<Value>(row.takes) +
                      (*row.takes.unit ? " [" + std::string(row.takes.unit) + "]" : "") +
                      (row.takes.is_or_false ? ", or `false`" : "") + " | ";
  if (row.takes.is_required)
    start += "required | ";
  else if (row.takes.has_default)
    start += default_in_words(keys::write_value(std::invoke(row.member, standard))) + " | ";
  return {start, row.sentence, row.takes.is_required || row.takes.has_default};
}

inline std::string without_links(const std::string& page) {
  return std::regex_replace(page, std::regex(R"(\[([^\[\]\n]*)\]\([^)\n]*\))"), "$1");
}

// ---- The file: one line per key.

// Long objects other than keys that are described in their line.
inline bool is_nested(const ordered_json& value) {
  if (!value.is_object()) return false;
  if (value.contains("properties") || std::any_of(value.begin(), value.end(), is_nested)) return true;
  return !value.contains("description") && in_one_line(value).size() > 110;
}

inline std::string as_text(const ordered_json& value, const std::string& indent = "") {
  if (!is_nested(value)) return in_one_line(value);
  std::string text;
  for (const auto& [key, item] : value.items())
    text += (text.empty() ? "\n" : ",\n") + indent + "  " + ordered_json(key).dump() + ": " +
            as_text(item, indent + "  ");
  return "{" + text + "\n" + indent + "}";
}

}  // namespace lobe::test
