// The equation of a small error e of the displacements of a body whose equations of motion were not quite
// satisfied (theory, section 18):
//   M ë + γ M ė + K e = r.
// K and M are those of the body at rest. e and r, 3 × #vertices, are in frames that turn with the tissue
// around each vertex. Steps are generalised-α ones (solve/implicit_step.h), with one cycle over two grids
// each.
#pragma once

#include <optional>

#include "lobe/linearity/two_grid.h"

namespace lobe {

class ErrorEquation {
 public:
  ErrorEquation(TwoGrid grid, double damping);  // γ [1/s]; the error begins at 0

  // The grid of the same mesh after cuts, prepared for a step as long as the last. It may be made in another
  // thread.
  std::function<TwoGrid(const Elements& elements, double edge, const HeldVertices& held)> grid_maker() const;
  // Takes a grid. New vertices have the error of the vertices that they are copies of.
  void use(TwoGrid grid, const Topology& topology);
  void restart();  // begins again with an error of 0

  // One step of h [s], to where r acts. What is held keeps its error.
  void step(const TwoGrid::Product& product, const HeldVertices& held, const Mat3X<double>& r, double h);
  // Adds a sudden loss to the error: 3 × #vertices. Vertices that the grid does not know are left out.
  void add(const Mat3X<double>& e);
  const Mat3X<double>& error() const { return e_; }  // [m]
  double norm() const;                               // √Σ m |e|² [√kg m]
  Eigen::VectorXd power() const;                     // e·r at the last step, per vertex [J]
  const TwoGrid& grid() const { return grid_; }

 private:
  static constexpr double radius = 0;  // spectral radius: residuals tell nothing of what steps do not resolve
  static constexpr double alpha_m = (2 * radius - 1) / (radius + 1), alpha_f = radius / (radius + 1);
  static constexpr double gamma = 0.5 - alpha_m + alpha_f,
                          beta = 0.25 * (1 - alpha_m + alpha_f) * (1 - alpha_m + alpha_f);

  void prepare(const HeldVertices& held, double h);
  static void prepare(TwoGrid& grid, const HeldVertices& held, double damping, double h);

  TwoGrid grid_;
  double damping_;
  Mat3X<double> e_, v_, a_, r_;  // [m], [m/s], [m/s²], [N]
  double h_ = 0;                 // the last step [s]
  bool is_prepared_ = false;     // whether the grid is prepared for it
  HeldVertices held_;            // held vertices for which the grid is prepared
};

}  // namespace lobe
