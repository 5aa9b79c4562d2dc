#include "benchmarks/validation/findings.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lobe::validation {

void Findings::value(const std::string& name, const std::string& quantity, const std::string& unit,
                     double measured, const Reference& reference, const Tolerance& tolerance) {
  const double error =
      std::abs(reference.value == 0 ? measured : (measured - reference.value) / reference.value);
  rows_.push_back(
      {family_, name, quantity, unit, reference, measured, error, tolerance, error <= tolerance.value});
}

void Findings::order(const std::string& name, const std::string& quantity, double measured, double theory,
                     const Tolerance& slack) {
  const double missing =
      std::isfinite(measured) ? std::max(0.0, theory - measured) : std::numeric_limits<double>::quiet_NaN();
  rows_.push_back({family_,
                   name,
                   "order of " + quantity,
                   "-",
                   {theory, "theory"},
                   measured,
                   missing,
                   slack,
                   missing <= slack.value});
}

void Findings::failure(const std::string& reason) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  rows_.push_back({family_, "ended early", reason, "-", {none, "-"}, none, none, {0, "-"}, false});
}

void Findings::study(const std::string& name, const std::vector<double>& sizes,
                     const std::vector<double>& errors) {
  for (std::size_t i = 0; i < sizes.size(); ++i)
    points_.push_back({family_ + ": " + name, sizes[i] / sizes.front(), errors[i]});
}

double observed_order(const std::vector<double>& sizes, const std::vector<double>& errors) {
  const std::size_t n = sizes.size();
  return std::log(errors[n - 2] / errors[n - 1]) / std::log(sizes[n - 2] / sizes[n - 1]);
}

Extrapolation extrapolate(double coarse, double middle, double fine) {
  return extrapolate_order(middle, fine, std::log2((coarse - middle) / (middle - fine)));
}

Extrapolation extrapolate_order(double coarse, double fine, double order) {
  const double limit = fine + (fine - coarse) / (std::exp2(order) - 1);
  return {order, limit, std::abs(fine / limit - 1)};
}

double romberg(double coarse, double middle, double fine) {
  return extrapolate_order(extrapolate_order(coarse, middle, 2).limit,
                           extrapolate_order(middle, fine, 2).limit, 4)
      .limit;
}

}  // namespace lobe::validation
