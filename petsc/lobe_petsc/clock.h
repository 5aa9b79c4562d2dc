// Times in the report of a solution.
#pragma once

#include <chrono>

namespace lobe::petsc {

using Clock = std::chrono::steady_clock;
inline double since(Clock::time_point start) {  // [s]
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace lobe::petsc
