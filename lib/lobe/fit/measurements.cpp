#include "lobe/fit/measurements.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "lobe/error.h"
#include "lobe/file/scanner.h"

namespace lobe {
namespace {

enum Column { quantity, at, component, value, unit, sigma, time, columns };
constexpr std::array<std::string_view, columns> column_names{"quantity", "at",    "component", "value",
                                                             "unit",     "sigma", "time"};

struct Unit {
  Quantity quantity;
  std::string_view name;
  double factor;  // to [m], [N] or [Hz]
};
constexpr Unit units[] = {{Quantity::displacement, "m", 1},
                          {Quantity::displacement, "cm", 1e-2},
                          {Quantity::displacement, "mm", 1e-3},
                          {Quantity::displacement, "um", 1e-6},
                          {Quantity::force, "N", 1},
                          {Quantity::force, "mN", 1e-3},
                          {Quantity::frequency, "Hz", 1},
                          {Quantity::frequency, "kHz", 1e3}};
constexpr std::array<std::string_view, 3> quantity_names{"displacement", "force", "frequency"};
constexpr std::array<std::string_view, 4> component_names{"x", "y", "z", "length"};

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t from = 0;;) {
    const auto to = text.find(separator, from);
    parts.push_back(trimmed(text.substr(from, to - from)));
    if (to == std::string_view::npos) return parts;
    from = to + 1;
  }
}

template <class List>
std::string list(const List& names) {
  std::string all;
  for (std::string_view name : names) all += (all.empty() ? "" : ", ") + std::string(name);
  return all;
}

template <class List>
int place_in(const List& names, std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return int(i);
  return -1;
}

// A line says everything that is wrong with it.
class Reader {
 public:
  Reader(const std::string& file, std::vector<Fault>& faults) : file_(file), faults_(faults) {}

  bool read_header(std::string_view line, int number) {
    const std::vector<std::string_view> names = split(line, ',');
    width_ = names.size();
    for (std::string_view name : names)
      if (place_in(column_names, name) < 0)
        fail(number, "the column \"" + std::string(name) + "\" is unknown; there are " + list(column_names));
    place_.fill(-1);
    for (int column = 0; column < columns; ++column) place_[column] = place_in(names, column_names[column]);
    for (int column = 0; column < sigma; ++column)
      if (place_[column] < 0)
        fail(number, "the first line has no column \"" + std::string(column_names[column]) + "\"; it needs " +
                         list(column_names) + " (sigma and time may be left out)");
    return faults_.empty();
  }

  std::optional<Measurement> read(std::string_view line, int number) {
    const std::size_t faults = faults_.size();
    cells_ = split(line, ',');
    line_ = number;
    if (cells_.size() > width_) {
      fail(number, "has more cells than the first line has names: decimals need a point");
      return {};
    }
    Measurement found;
    found.line = number;
    const int kind = place_in(quantity_names, cell(quantity));
    if (kind < 0) {
      fail(number,
           "\"" + std::string(cell(quantity)) + "\" is no quantity; there are " + list(quantity_names));
      return {};
    }
    found.quantity = Quantity(kind);
    read_place(found);
    read_component(found);
    const double factor = read_unit(found.quantity);
    found.value = factor * read_number(cell(value), "value");
    if (!cell(sigma).empty()) {
      found.sigma = factor * read_number(cell(sigma), "sigma");
      if (found.sigma <= 0) fail(number, "sigma must be positive; leave it out where it is not known");
    }
    if (!cell(time).empty()) read_time(found);
    if (faults_.size() > faults) return {};
    return found;
  }

 private:
  std::string_view cell(int column) const {
    const int place = place_[column];
    return place >= 0 && place < int(cells_.size()) ? cells_[std::size_t(place)] : std::string_view();
  }

  double read_number(std::string_view text, const char* what) {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number))
      fail(line_, std::string(what) + " \"" + std::string(text) + "\" is no finite number");
    return number;
  }

  void read_place(Measurement& found) {
    if (found.quantity == Quantity::displacement) {
      std::vector<std::string_view> words;
      for (std::string_view word : split(cell(at), ' '))
        if (!word.empty()) words.push_back(word);
      if (words.size() != 3)
        return fail(line_, "\"at\" of a displacement must be the point at rest, \"x y z\" [m]");
      for (int axis = 0; axis < 3; ++axis) found.point[axis] = read_number(words[std::size_t(axis)], "at");
      return;
    }
    if (found.quantity == Quantity::force && is_name(cell(at))) {
      found.tool = cell(at);
      return;
    }
    const int lowest = found.quantity == Quantity::frequency ? 1 : 0;
    const double number = read_number(cell(at), "at");
    if (number != std::floor(number) || number < lowest || number > 1000)
      return fail(line_, found.quantity == Quantity::frequency
                             ? "\"at\" of a frequency must be its number, 1 for the lowest"
                             : "\"at\" of a force must be the number of an entry of \"boundary\", from "
                               "0, or the name of a tool");
    found.number = int(number);
  }

  static bool is_name(std::string_view text) {
    double number = 0;
    return std::from_chars(text.data(), text.data() + text.size(), number).ptr != text.data() + text.size();
  }

  void read_time(Measurement& found) {
    found.time = read_number(cell(time), "time");
    if (*found.time < 0) fail(line_, "time must be at least 0, when the scene begins");
    if (found.quantity == Quantity::frequency)
      fail(line_, "a frequency has no time: it is of small motions about the equilibrium");
  }

  void read_component(Measurement& found) {
    if (found.quantity == Quantity::frequency) return;
    found.component = place_in(component_names, cell(component));
    if (found.component < 0)
      fail(line_,
           "component \"" + std::string(cell(component)) + "\" must be one of " + list(component_names));
  }

  double read_unit(Quantity kind) {
    std::string known;
    for (const Unit& row : units) {
      if (row.quantity != kind) continue;
      if (row.name == cell(unit)) return row.factor;
      known += (known.empty() ? "" : ", ") + std::string(row.name);
    }
    fail(line_, "unit \"" + std::string(cell(unit)) + "\" of a " +
                    std::string(quantity_names[std::size_t(kind)]) + " must be one of " + known);
    return 0;
  }

  void fail(int line, const std::string& message) {
    faults_.push_back({file_ + ":" + std::to_string(line), message});
  }

  const std::string& file_;
  std::vector<Fault>& faults_;
  std::array<int, columns> place_{};
  std::vector<std::string_view> cells_;
  std::size_t width_ = 0;  // cells of the first line
  int line_ = 0;
};

}  // namespace

std::vector<Measurement> parse_measurements(std::string_view text, const std::string& file) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // as spreadsheets write it
  std::vector<Fault> faults;
  std::vector<Measurement> found;
  Reader reader(file, faults);
  bool any_line = false;
  int number = 0;
  for (std::string_view line : split(text, '\n')) {
    ++number;
    if (line.empty() || line.front() == '#') continue;
    if (!any_line) {
      any_line = true;
      if (!reader.read_header(line, number)) break;
    } else if (auto one = reader.read(line, number)) {
      found.push_back(*one);
    }
  }
  if (faults.empty() && found.empty()) faults.push_back({file, "has no measurement"});
  const auto expect_all_or_none = [&](const char* what, auto&& is_told) {
    const auto told = std::count_if(found.begin(), found.end(), is_told);
    if (faults.empty() && told > 0 && told < std::ptrdiff_t(found.size()))
      faults.push_back({file, std::string(what) + " must be told for every number, or for none"});
  };
  expect_all_or_none("sigma", [](const Measurement& m) { return m.sigma > 0; });
  expect_all_or_none("time", [](const Measurement& m) { return m.time.has_value(); });
  if (!faults.empty()) throw InputError(std::move(faults));
  return found;
}

std::vector<Measurement> read_measurements(const std::filesystem::path& file) {
  return parse_measurements(io::read_file(file), file.string());
}

}  // namespace lobe
