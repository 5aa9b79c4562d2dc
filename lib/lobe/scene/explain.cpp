#include "lobe/scene/explain.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "lobe/scene/json_text.h"
#include "lobe/scene/nearest_word.h"
#include "lobe/scene/schema.h"

namespace lobe {
namespace {

using nlohmann::json;

constexpr std::size_t max_faults = 100;

std::string in_quotes(const std::string& word) { return "\"" + word + "\""; }

// "a", "b" or "c"
std::string listed(const std::vector<std::string>& words, const char* last = " or ") {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? last : ", ";
    text += words[i];
  }
  return text;
}

std::vector<std::string> keys_of(const json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

std::vector<std::string> each_in_quotes(std::vector<std::string> words) {
  for (std::string& word : words) word = in_quotes(word);
  return words;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = nearest_word(word, known);
  return nearest.empty() ? "" : "; did you mean " + in_quotes(nearest) + "?";
}

bool is_of_type(const json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  if (type == "integer") return value.is_number_integer();
  return type == "number" && value.is_number();
}

class Explainer {
 public:
  explicit Explainer(const json& root) : root_(root) {}

  void check(const json& value, const json& schema_or_ref, const std::string& place) {
    const json& schema = resolved(schema_or_ref);
    if (!is_writable(value, place)) return;
    if (!type_fits(value, schema, place) || !listed_value_fits(value, schema, place)) return;
    if (value.is_number()) check_number(value, schema, place);
    if (value.is_string() && value.get_ref<const std::string&>().size() < schema.value("minLength", 0u)) {
      add(place, "must not be empty");
    }
    if (value.is_array()) check_array(value, schema, place);
    if (value.is_object()) check_object(value, schema, place);
  }

  std::vector<Fault> take() {
    if (count_ > max_faults) {
      faults_.push_back({"", "… and " + std::to_string(count_ - max_faults) + " more faults"});
    }
    return std::move(faults_);
  }

 private:
  void add(const std::string& place, const std::string& message) {
    if (++count_ <= max_faults) faults_.push_back({place, message});
  }

  const json& resolved(const json& schema) const {
    const auto ref = schema.find("$ref");
    if (ref == schema.end()) return schema;
    return root_.at(json::json_pointer(ref->get_ref<const std::string&>().substr(1)));
  }

  // Whether JSON text can have it, as parse_json() reads it.
  bool is_writable(const json& value, const std::string& place) {
    if (value.is_number_float() && !std::isfinite(value.get<double>())) {
      add(place,
          std::string(std::isnan(value.get<double>()) ? "not a number" : "infinite") + ", must be finite");
      return false;
    }
    if (!value.is_structured() ||
        std::count(place.begin(), place.end(), '/') < std::ptrdiff_t(max_json_depth))
      return true;
    add("", "nested more than " + std::to_string(max_json_depth) + " levels deep");
    return false;
  }

  bool type_fits(const json& value, const json& schema, const std::string& place) {
    const auto type = schema.find("type");
    if (type == schema.end()) return true;
    const auto fits = [&](const json& name) { return is_of_type(value, name.get_ref<const std::string&>()); };
    if (type->is_array() ? std::any_of(type->begin(), type->end(), fits) : fits(*type)) return true;
    std::vector<std::string> names;
    for (const std::string name : type->is_array() ? *type : json::array({*type})) {
      names.push_back((std::string("aeiou").find(name[0]) == std::string::npos ? "a " : "an ") + name);
    }
    add(place, excerpt(value) + ", must be " + listed(names));
    return false;
  }

  bool listed_value_fits(const json& value, const json& schema, const std::string& place) {
    json allowed = schema.value("enum", json::array());
    if (schema.contains("const")) allowed.push_back(schema["const"]);
    if (allowed.empty() || std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return true;
    std::vector<std::string> words, known;
    for (const json& item : allowed) {
      words.push_back(item.dump());
      if (item.is_string()) known.push_back(item);
    }
    add(place, excerpt(value) + ", must be " + listed(words) +
                   (value.is_string() ? did_you_mean(value, known) : ""));
    return false;
  }

  void check_number(const json& value, const json& schema, const std::string& place) {
    const double number = value;
    const auto refuse = [&](const char* keyword, const char* relation) {
      add(place, excerpt(value) + ", must be " + relation + " " + schema[keyword].dump());
    };
    const auto bound = [&](const char* keyword) -> std::optional<double> {
      const auto found = schema.find(keyword);
      return found == schema.end() ? std::nullopt : std::optional<double>(found->get<double>());
    };
    if (const auto limit = bound("minimum"); limit && number < *limit) refuse("minimum", "at least");
    if (const auto limit = bound("maximum"); limit && number > *limit) refuse("maximum", "at most");
    if (const auto limit = bound("exclusiveMinimum"); limit && number <= *limit) {
      refuse("exclusiveMinimum", "above");
    }
    if (const auto limit = bound("exclusiveMaximum"); limit && number >= *limit) {
      refuse("exclusiveMaximum", "below");
    }
  }

  void check_array(const json& array, const json& schema, const std::string& place) {
    const std::size_t least = schema.value("minItems", std::size_t{0});
    const std::size_t most = schema.value("maxItems", SIZE_MAX);
    if (array.size() < least || array.size() > most) {
      const std::string count = least == most          ? std::to_string(least)
                                : array.size() < least ? "at least " + std::to_string(least)
                                                       : "at most " + std::to_string(most);
      add(place, std::to_string(array.size()) + " items, must be " + count);
    }
    if (schema.value("uniqueItems", false)) check_unique(array, place);
    const auto items = schema.find("items");
    if (items == schema.end()) return;
    const std::size_t described = items->is_array() ? std::min(items->size(), array.size()) : array.size();
    for (std::size_t i = 0; i < described; ++i) {
      check(array[i], items->is_array() ? (*items)[i] : *items, child_pointer(place, i));
    }
  }

  void check_unique(const json& array, const std::string& place) {
    std::set<json> found;
    for (std::size_t i = 0; i < array.size(); ++i)
      if (!found.insert(array[i]).second) add(child_pointer(place, i), excerpt(array[i]) + " is given twice");
  }

  void check_object(const json& object, const json& schema, const std::string& place) {
    if (is_tagged_union(schema)) return check_tagged_union(object, schema, place);
    const json& properties = schema.contains("properties") ? schema["properties"] : empty_;
    const json& removed = schema.contains("removed") ? schema["removed"] : empty_;
    const std::vector<std::string> known = keys_of(properties);
    json meant = json::object();  // misspelt keys put right, so that none of them is also reported as missing
    for (const auto& [key, value] : object.items()) meant[key] = nullptr;
    for (const auto& [key, value] : object.items()) {
      if (properties.contains(key)) {
        check(value, properties[key], child_pointer(place, key));
      } else if (removed.contains(key)) {
        add(child_pointer(place, key), "is gone: " + removed[key].get<std::string>());
      } else if (schema.contains("additionalProperties")) {
        refuse_key(key, known, place);
        const std::string nearest = nearest_word(key, known);
        if (!nearest.empty()) meant[nearest] = nullptr;
      }
    }
    for (const std::string key : schema.value("required", json::array())) {
      if (!meant.contains(key)) add(place, "needs " + in_quotes(key));
    }
    check_number_of_keys(object, schema, known, place);
    if (alternatives_fit(meant, schema, place)) check_dependencies(meant, schema, place);
    check_any(meant, schema, place);
  }

  // `anyOf` of lists of one required key: [{"required": ["a"]}, …].
  void check_any(const json& object, const json& schema, const std::string& place) {
    std::vector<std::string> keys;
    for (const json& branch : schema.value("anyOf", json::array())) {
      keys.push_back(branch["required"][0]);
      if (object.contains(keys.back())) return;
    }
    if (!keys.empty()) add(place, "needs " + listed(each_in_quotes(keys)));
  }

  // A list of keys that a key needs, or `anyOf` of such lists with one key each.
  void check_dependencies(const json& object, const json& schema, const std::string& place) {
    const json& dependencies = schema.contains("dependencies") ? schema["dependencies"] : empty_;
    for (const auto& [key, partners] : dependencies.items()) {
      if (!object.contains(key)) continue;
      const auto needs = [&](const std::vector<std::string>& any) {
        if (std::none_of(any.begin(), any.end(), [&](const std::string& k) { return object.contains(k); }))
          add(place, in_quotes(key) + " also needs " + listed(each_in_quotes(any)));
      };
      if (partners.is_array()) {
        for (const std::string partner : partners) needs({partner});
        continue;
      }
      std::vector<std::string> any;
      for (const json& branch : partners["anyOf"]) any.push_back(branch["required"][0]);
      needs(any);
    }
  }

  void refuse_key(const std::string& key, const std::vector<std::string>& known, const std::string& place) {
    const std::string hint = did_you_mean(key, known);
    add(place, "unknown key " + excerpt(key) +
                   (hint.empty() ? "; known here: " + listed(each_in_quotes(known), ", ") : hint));
  }

  // A selector: one key out of many.
  void check_number_of_keys(const json& object, const json& schema, const std::vector<std::string>& known,
                            const std::string& place) {
    if (object.size() >= schema.value("minProperties", std::size_t{0}) &&
        object.size() <= schema.value("maxProperties", SIZE_MAX)) {
      return;
    }
    const std::string found = object.empty() ? "" : ", has " + std::to_string(object.size());
    add(place, "needs exactly one of " + listed(each_in_quotes(known)) + found);
  }

  // `oneOf` of lists of required keys: [{"required": ["a", "b"]}, …]. A branch is meant as soon as one of its
  // keys is there; what it lacks is the business of `dependencies`, so that nothing is said twice. A branch
  // with "not" is for what no other is meant by.
  bool alternatives_fit(const json& object, const json& schema, const std::string& place) {
    const auto branches = schema.find("oneOf");
    if (branches == schema.end()) return true;
    std::vector<std::string> words;
    std::size_t meant = 0;
    for (const json& branch : *branches) {
      std::string keys;
      for (const std::string key : branch["required"])
        keys += (keys.empty() ? "" : " with ") + in_quotes(key);
      words.push_back(keys);
      if (branch.contains("not") && meant > 0) continue;
      meant += std::any_of(branch["required"].begin(), branch["required"].end(),
                           [&](const json& key) { return object.contains(key); });
    }
    if (meant == 1) return true;
    add(place, "needs exactly one of " + listed(words) + (meant > 1 ? ", has " + std::to_string(meant) : ""));
    return false;
  }

  // `oneOf` of objects that differ in the constant value of "type".
  bool is_tagged_union(const json& schema) const {
    return schema.contains("oneOf") && !schema["oneOf"][0].contains("required");
  }

  void check_tagged_union(const json& object, const json& schema, const std::string& place) {
    std::vector<std::string> tags, words;
    for (const json& ref : schema["oneOf"]) {
      const json& branch = resolved(ref);
      const json& tag = branch["properties"]["type"]["const"];
      if (object.contains("type") && object["type"] == tag) return check(object, branch, place);
      tags.push_back(tag);
      words.push_back(tag.dump());
    }
    if (!object.contains("type")) return add(place, "needs \"type\": " + listed(words));
    const json& found = object["type"];
    add(child_pointer(place, "type"),
        excerpt(found) + ", must be " + listed(words) + (found.is_string() ? did_you_mean(found, tags) : ""));
  }

  const json& root_;
  const json empty_ = json::object();
  std::vector<Fault> faults_;
  std::size_t count_ = 0;
};

}  // namespace

std::vector<Fault> explain(const nlohmann::json& document, const nlohmann::json& schema) {
  Explainer explainer(schema);
  explainer.check(document, schema, "");
  return explainer.take();
}

std::vector<Fault> schema_faults(const nlohmann::json& document, const std::string& name) {
  static const json schema = json::parse(scene_schema());
  std::vector<Fault> faults = explain(document, schema);
  for (Fault& fault : faults)
    if (fault.place.empty()) fault.place = name;
  return faults;
}

}  // namespace lobe
