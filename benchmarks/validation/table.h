// The one table of all rows: on the terminal, as CSV, as Markdown for the documentation.
#pragma once

#include <span>
#include <string>

#include "benchmarks/validation/findings.h"

namespace lobe::validation {

std::string text_header();
std::string text_line(const Row& row);
std::string csv(std::span<const Row> rows);
std::string markdown(std::span<const Row> rows);
std::string study_script(std::span<const Point> points);  // for gnuplot, data included: validation.png

}  // namespace lobe::validation
