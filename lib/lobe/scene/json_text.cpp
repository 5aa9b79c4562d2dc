#include "lobe/scene/json_text.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lobe/error.h"

namespace lobe {
namespace {

using nlohmann::json;

std::string line_and_column(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 = 0
  const auto column = 1 + std::count_if(before.begin() + static_cast<std::ptrdiff_t>(line_start),
                                        before.end(), [](char c) { return (c & 0xC0) != 0x80; });
  return std::to_string(line) + ":" + std::to_string(column);
}

// The reason in nlohmann's "[json.exception…] parse error at line 1, column 2: syntax error while …".
std::string reason(const std::string& what) {
  std::string text = what.substr(std::min(what.size(), what.find("] ") + 2));
  if (text.starts_with("parse error")) text.erase(0, std::min(text.size(), text.find(": ") + 2));
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  return text;
}

// Builds the document from the parser's events; the parser itself does not recurse.
class DocumentBuilder : public nlohmann::json_sax<json> {
 public:
  DocumentBuilder(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  json take() {
    if (!faults_.empty()) throw InputError(std::move(faults_));
    return std::move(root_);
  }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  // A number too large for a signed integer becomes a floating-point number; the validator would take it as
  // negative.
  bool number_unsigned(number_unsigned_t value) override {
    return value > INT64_MAX ? add(static_cast<double>(value)) : add(value);
  }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& key) override {
    Level& level = levels_.back();
    if (level.value->contains(key) && faults_.size() < 20) {
      faults_.push_back({child_pointer(pointer(levels_.size()), key), "given twice"});
    }
    level.key = std::move(key);
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    // `position` counts what was read, the offending byte included.
    const std::string where = line_and_column(text_, position == 0 ? 0 : position - 1);
    faults_.assign(1, {name_ + ":" + where, reason(error.what())});
    return false;
  }

 private:
  struct Level {
    json* value;
    std::string key;
  };

  json* add(json value) {
    if (levels_.empty()) return &(root_ = std::move(value));
    json& parent = *levels_.back().value;
    if (parent.is_array()) {
      parent.push_back(std::move(value));
      return &parent.back();
    }
    return &(parent[levels_.back().key] = std::move(value));
  }

  bool open(json container) {
    if (levels_.size() == max_json_depth) {
      faults_.assign(1, {name_, "nested more than " + std::to_string(max_json_depth) + " levels deep"});
      return false;
    }
    levels_.push_back({add(std::move(container)), ""});
    return true;
  }

  bool close() {
    levels_.pop_back();
    return true;
  }

  // Of the container `depth` levels down; an array's open element is its last.
  std::string pointer(std::size_t depth) const {
    std::string text;
    for (std::size_t i = 0; i + 1 < depth; ++i) {
      const Level& level = levels_[i];
      text = level.value->is_array() ? child_pointer(text, level.value->size() - 1)
                                     : child_pointer(text, level.key);
    }
    return text;
  }

  std::string_view text_;
  const std::string& name_;
  json root_;
  std::vector<Level> levels_;
  std::vector<Fault> faults_;
};

}  // namespace

nlohmann::json parse_json(std::string_view text, const std::string& name) {
  if (text.size() > max_json_bytes) {
    throw InputError(name, "longer than " + std::to_string(max_json_bytes >> 20) + " MB");
  }
  DocumentBuilder builder(text, name);
  json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

std::string child_pointer(const std::string& pointer, std::string_view key) {
  std::string text = pointer + "/";
  for (const char c : key.substr(0, 64)) {
    if (c == '~') {
      text += "~0";
    } else if (c == '/') {
      text += "~1";
    } else {
      text += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
    }
  }
  return text;
}

std::string child_pointer(const std::string& pointer, std::size_t index) {
  return pointer + "/" + std::to_string(index);
}

std::string excerpt(const nlohmann::json& value) {
  constexpr std::size_t limit = 40;
  if (value.is_array() && value.size() > limit)
    return "an array of " + std::to_string(value.size()) + " items";
  if (value.is_object() && value.size() > limit)
    return "an object of " + std::to_string(value.size()) + " keys";
  std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (text.size() <= limit) return text;
  std::size_t end = limit;
  while (end > 0 && (text[end] & 0xC0) == 0x80) --end;  // not inside a UTF-8 sequence
  return text.substr(0, end) + "…";
}

}  // namespace lobe
