#include "benchmarks/validation/table.h"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "lobe/text.h"

namespace lobe::validation {
namespace {

// printf's widths count bytes; a column counts characters.
std::string padded(const std::string& text, std::size_t width) {
  std::size_t characters = 0;
  for (char c : text) characters += (c & 0xC0) != 0x80;
  return characters < width ? text + std::string(width - characters, ' ') : text;
}

std::string number(double value, const char* format) {
  if (std::isnan(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

// A bar would begin another cell.
std::string cell_text(const std::string& text) {
  std::string out;
  for (char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

std::string line(const std::string& family, const std::string& name, const std::string& quantity,
                 const std::string& unit, const std::string& reference, const std::string& measured,
                 const std::string& error, const std::string& tolerance, const std::string& result) {
  return padded(family, 22) + ' ' + padded(name, 46) + ' ' + padded(quantity, 42) + ' ' + padded(unit, 5) +
         ' ' + padded(reference, 14) + ' ' + padded(measured, 14) + ' ' + padded(error, 9) + ' ' +
         padded(tolerance, 9) + ' ' + result + '\n';
}

}  // namespace

std::string text_header() {
  return line("family", "case", "quantity", "unit", "reference", "measured", "error", "tolerance", "");
}

std::string text_line(const Row& row) {
  return line(row.family, row.name, row.quantity, row.unit, number(row.reference.value, "%.8g"),
              number(row.measured, "%.8g"), number(row.error, "%.1e"), number(row.tolerance.value, "%.1e"),
              row.passed ? "passed" : "FAILED");
}

std::string csv(std::span<const Row> rows) {
  std::ostringstream out;
  out << "family,case,quantity,unit,reference,source,measured,error,tolerance,basis,passed\n";
  for (const Row& r : rows)
    out << quoted(r.family) << ',' << quoted(r.name) << ',' << quoted(r.quantity) << ',' << r.unit << ','
        << exact(r.reference.value) << ',' << quoted(r.reference.source) << ',' << exact(r.measured) << ','
        << exact(r.error) << ',' << exact(r.tolerance.value) << ',' << quoted(r.tolerance.basis) << ','
        << (r.passed ? "yes" : "no") << '\n';
  return out.str();
}

std::string markdown(std::span<const Row> rows) {
  std::ostringstream out;
  std::string family;
  for (const Row& r : rows) {
    if (r.family != family)
      out << "\n### " << r.family
          << "\n\n| case | quantity | unit | reference | from | measured | error | tolerance | because | |\n"
             "|---|---|---|---|---|---|---|---|---|---|\n";
    family = r.family;
    out << "| " << cell_text(r.name) << " | " << cell_text(r.quantity) << " | " << r.unit << " | "
        << number(r.reference.value, "%.8g") << " | " << cell_text(r.reference.source) << " | "
        << number(r.measured, "%.8g") << " | " << number(r.error, "%.1e") << " | "
        << number(r.tolerance.value, "%.1e") << " | " << cell_text(r.tolerance.basis) << " | "
        << (r.passed ? "passed" : "**failed**") << " |\n";
  }
  return out.str();
}

std::string study_script(std::span<const Point> points) {
  std::ostringstream data, plot;
  std::string last;
  int studies = 0;
  for (const Point& p : points) {
    if (p.study != last) {
      const std::string name = "$study" + std::to_string(studies);
      data << (studies > 0 ? "end\n" : "") << name << " << end\n";
      plot << ", \\\n  " << name << " with linespoints lw 1.5 pt " << 1 + studies % 13 << " title \""
           << p.study << '"';
      last = p.study;
      ++studies;
    }
    data << exact(p.size) << ' ' << exact(p.error) << '\n';
  }
  if (studies > 0) data << "end\n";
  return data.str() + R"(set terminal pngcairo size 1200,760 font 'sans,10'
set output 'validation.png'
set logscale xy
set format y '10^{%T}'
set grid
set key outside right noenhanced
set xlabel 'size of cell or time step, relative to the coarsest'
set ylabel 'relative error'
plot [0.2:1.1] 1e-2*x with lines lw 2 lc 'gray' dt 2 title 'order 1', \
  1e-3*x**2 with lines lw 2 lc 'gray' dt 3 title 'order 2')" +
         plot.str() + '\n';
}

}  // namespace lobe::validation
