// Chains of a soft and a stiff part, linear, under the schemes of step_schemes.h: the exact growth of their
// modes, from the matrix of one large step.
#pragma once

#include "benchmarks/step_schemes.h"

namespace lobe::bench {

// A soft part of 14 unit springs, held at one end, and a stiff part of 6.
struct ChainCase {
  double stiffness = 50;  // of the stiff part's material
  double mass = 1;        // its mass per length
  double length = 1;      // of its springs
};

struct ChainFigures {
  double growth = 1;  // the largest entry of the matrix of 2^17 large steps, scaled by masses
  double cost = 1;    // evaluations of springs per time, as a share of those of one step for all
};

enum class ChainScheme { one_step, own_steps, two_levels, leapfrog_chebyshev };

// two_levels: the stiff part's springs at the short step, all others at the longest, so nothing in between.
// `damping`: per large step. Steps are `safety` × the limit.
ChainFigures play_chain(const ChainCase& chain, ChainScheme scheme, double safety, double damping,
                        double stabilisation);

}  // namespace lobe::bench
