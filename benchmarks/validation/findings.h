// What the validation cases find: the rows of one table, and the points of the convergence studies.
#pragma once

#include <string>
#include <vector>

namespace lobe::validation {

struct Reference {
  double value = 0;
  const char* source = "";  // where it is from
};

struct Tolerance {
  double value = 0;
  const char* basis = "";  // why it is what it is
};

struct Row {
  std::string family, name, quantity, unit;
  Reference reference;
  double measured = 0;
  double error = 0;  // relative; absolute where the reference is 0; of an order: what is missing
  Tolerance tolerance;
  bool passed = false;  // error <= tolerance; never if the error is not a number
};

struct Point {  // of a convergence study
  std::string study;
  double size = 0;  // of a cell, or of a time step, relative to the coarsest
  double error = 0;
};

class Findings {
 public:
  explicit Findings(std::string family) : family_(std::move(family)) {}

  void value(const std::string& name, const std::string& quantity, const std::string& unit, double measured,
             const Reference& reference, const Tolerance& tolerance);
  // An order of convergence, which passes from `theory` − `slack` on.
  void order(const std::string& name, const std::string& quantity, double measured, double theory,
             const Tolerance& slack);
  void failure(const std::string& reason);  // the family ended early
  void study(const std::string& name, const std::vector<double>& sizes, const std::vector<double>& errors);

  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<Point>& points() const { return points_; }

 private:
  std::string family_;
  std::vector<Row> rows_;
  std::vector<Point> points_;
};

// Of errors e ~ hᵖ on two meshes: p = log(e₁/e₂)/log(h₁/h₂), from the last two of each list.
double observed_order(const std::vector<double>& sizes, const std::vector<double>& errors);

// Values f ~ f∞ + c hᵖ on three meshes that halve the size: p, f∞, and what the finest lacks of it.
struct Extrapolation {
  double order = 0, limit = 0;
  double mesh_error = 0;  // |finest/limit − 1|
};
Extrapolation extrapolate(double coarse, double middle, double fine);
// The same from two meshes, with an order that is known.
Extrapolation extrapolate_order(double coarse, double fine, double order);

// f∞ of f ~ f∞ + c₂ h² + c₄ h⁴ on three meshes that halve the size.
double romberg(double coarse, double middle, double fine);

}  // namespace lobe::validation
