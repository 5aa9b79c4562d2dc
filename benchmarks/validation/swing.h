// What is read off the motion of a body that swings and comes to rest: peak, half period, damping ratio.
#pragma once

#include <span>

namespace lobe::validation {

struct Swing {
  double first_peak = 0;   // displacement at the first extremum [m]
  double half_period = 0;  // mean time between extrema [s]
  // ζ = δ/√(π² + δ²), δ = ln(A₁/Aₙ)/(n − 1), for the n swings A from one extremum to the next
  double damping_ratio = 0;
};

inline constexpr int swings_read = 7;  // n

// Extrema are the highest or lowest samples of ±20 ms, moved to the top of a parabola through those of
// ±10 ms. They are sought later than 20 ms after the start. A slow drift of the middle hardly matters, since
// A is the distance of two extrema. Throws std::runtime_error if there are fewer than n + 1 of them.
Swing swing(std::span<const double> x,  // displacements at 0, interval, 2 · interval … [m]
            double interval);           // [s], at most 10 ms

// Whether they are enough for that.
bool shows_swings(std::span<const double> x, double interval);

}  // namespace lobe::validation
