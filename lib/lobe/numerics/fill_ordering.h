// The order in which a sparse matrix is factorised, so that its factor has few entries.
#pragma once

#include <Eigen/SparseCore>
#include <mutex>

#ifdef LOBE_WITHOUT_METIS
#include <Eigen/OrderingMethods>
#else
#include <iostream>  // Eigen's MetisSupport needs it

#include <Eigen/MetisSupport>

#include "lobe/numerics/metis_lock.h"
#endif

namespace lobe {

// FillOrdering()(A, P): P.indices() are the columns of A in their order. LOBE_FILL_ORDERING is its name. Hold
// the lock meanwhile.
#ifdef LOBE_WITHOUT_METIS
using FillOrdering = Eigen::AMDOrdering<int>;
#define LOBE_FILL_ORDERING "approximate minimum degree"
inline std::unique_lock<std::mutex> lock_fill_ordering() { return {}; }
#else
using FillOrdering = Eigen::MetisOrdering<int>;
#define LOBE_FILL_ORDERING "METIS nested dissection"
inline std::unique_lock<std::mutex> lock_fill_ordering() { return lock_metis(); }
#endif

}  // namespace lobe
