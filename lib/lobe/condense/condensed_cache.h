// Stores condensed regions on disk, one file per region. The name of the file is a digest of the input:
// stiffness (which depends on mesh, materials and boundary), loads, interface. So a changed input finds no
// file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "lobe/condense/condensation.h"
#include "lobe/condense/region_factor.h"

namespace lobe {

class CondensedCache {
 public:
  using Dofs = Condensation::Dofs;

  explicit CondensedCache(std::filesystem::path folder = {},  // none: nothing is stored
                          CondensingLog::Progress progress = {})
      : folder_(std::move(folder)), log_(std::move(progress)) {}

  // Returns the region condensed to its interface. It is read from the folder, or condensed from scratch and
  // stored there. A damaged file is replaced. If the file cannot be written, there is none. take_notice()
  // reports both.
  std::unique_ptr<Condensation> condense(const RegionFactor& region, const Eigen::MatrixXd& loads,
                                         const Dofs& interface, const SparseFactorMaker& make_factor);
  const CondensingLog& log() const { return log_; }
  std::string take_notice() { return std::exchange(notice_, {}); }

 private:
  // The condensed region as it is in the file: the springs of the factor still hold the interface.
  std::unique_ptr<Condensation> with_springs(const RegionFactor& region, const Eigen::MatrixXd& loads,
                                             const Dofs& interface, const SparseFactorMaker& make_factor);
  std::unique_ptr<Condensation> load(const std::filesystem::path& file, std::uint64_t key,
                                     std::unique_ptr<SparseFactor> factor, const Eigen::MatrixXd& loads,
                                     const Dofs& interface);
  void save(const std::filesystem::path& file, std::uint64_t key, const Condensation& condensed);

  std::filesystem::path folder_;
  CondensingLog log_;
  std::string notice_;
};

}  // namespace lobe
