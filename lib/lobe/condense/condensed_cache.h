// What was condensed, on disk: a file per region, named and keyed by all that condensing starts from
// (stiffness, which has mesh, materials and boundary in it; loads; interface), so that a changed input finds
// nothing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "lobe/condense/condensed.h"
#include "lobe/condense/region_factor.h"

namespace lobe {

class CondensedCache {
 public:
  using Dofs = Condensed::Dofs;

  explicit CondensedCache(std::filesystem::path folder = {},  // none: keeps nothing
                          CondensingLog::Progress progress = {})
      : folder_(std::move(folder)), log_(std::move(progress)) {}

  // The region condensed to its interface: from the folder, or else from scratch, and then kept there. A file that
  // is damaged is replaced, one that cannot be written is left: take_notice() says so.
  std::unique_ptr<Condensed> condense(const RegionFactor& region, const Eigen::MatrixXd& loads,
                                      const Dofs& interface, const SparseFactorMaker& make_factor);
  const CondensingLog& log() const { return log_; }
  std::string take_notice() { return std::exchange(notice_, {}); }

 private:
  // Where springs of the region's factor still hold the interface: what is kept.
  std::unique_ptr<Condensed> with_springs(const RegionFactor& region, const Eigen::MatrixXd& loads,
                                          const Dofs& interface, const SparseFactorMaker& make_factor);
  std::unique_ptr<Condensed> load(const std::filesystem::path& file, std::uint64_t key,
                                  std::unique_ptr<SparseFactor> factor, const Eigen::MatrixXd& loads,
                                  const Dofs& interface);
  void save(const std::filesystem::path& file, std::uint64_t key, const Condensed& condensed);

  std::filesystem::path folder_;
  CondensingLog log_;
  std::string notice_;
};

}  // namespace lobe
