// METIS draws random numbers from the C library, and all threads share their state. Who holds this lock while
// METIS orders a matrix or divides a mesh gets the same result whatever other worlds do meanwhile.
#pragma once

#include <mutex>

namespace lobe {

inline std::unique_lock<std::mutex> lock_metis() {
  static std::mutex in_use;
  return std::unique_lock<std::mutex>(in_use);
}

}  // namespace lobe
