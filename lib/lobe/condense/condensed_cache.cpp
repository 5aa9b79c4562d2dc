#include "lobe/condense/condensed_cache.h"

#include <cmath>
#include <cstdio>
#include <span>

#include "lobe/error.h"
#include "lobe/file/sealed_file.h"

namespace lobe {
namespace {

constexpr io::Format format{"lobecond", 4, "condensed region"};

std::uint64_t key_of(const RegionFactor& region, const Eigen::MatrixXd& loads,
                     const Condensation::Dofs& interface, const char* method) {
  const SparseFactor::Matrix& K = region.K;
  const auto entries = std::size_t(K.nonZeros());
  std::uint64_t key = io::digest(method);
  key = io::digest_of(std::span(K.outerIndexPtr(), std::size_t(K.cols()) + 1), key);
  key = io::digest_of(std::span(K.innerIndexPtr(), entries), key);
  key = io::digest_of(std::span(K.valuePtr(), entries), key);
  key = io::digest_of(std::span(loads.data(), std::size_t(loads.size())), key);
  key = io::digest_of(std::span(region.springs.data(), region.springs.size()), key);
  return io::digest_of(std::span(interface.data(), interface.size()), key);
}

std::unique_ptr<Condensation> condense_afresh(const RegionFactor& region, const Eigen::MatrixXd& loads,
                                              const Condensation::Dofs& interface,
                                              const SparseFactorMaker& make_factor, CondensingLog& log) {
  auto factor = region.factorise(make_factor, log);
  return log.time(CondensingPhase::interface, [&] {
    auto condensed = std::make_unique<Condensation>(std::move(factor), loads);
    condensed->promote(interface);
    return condensed;
  });
}

// Checks that the numbers of a file belong to the region. If all loads and the whole interface act at once,
// the interior must be without a force, and the interface must have the force of S.
bool is_in_equilibrium(const Condensation& condensed, const RegionFactor& region,
                       const Eigen::MatrixXd& loads) {
  const Condensation::Dofs& interface = condensed.interface();
  const Eigen::VectorXd driven = Eigen::VectorXd::LinSpaced(condensed.stiffness().cols(), 1, 2);
  const Eigen::VectorXd u = condensed.field(driven), on_interface = condensed.stiffness() * driven;
  Eigen::VectorXd force = region.K.selfadjointView<Eigen::Lower>() * u - loads * driven.head(loads.cols());
  const double scale = force.norm();
  force(interface) -= on_interface.tail(Eigen::Index(interface.size()));
  return std::isfinite(scale) && force.norm() <= 1e-6 * scale;
}

}  // namespace

std::unique_ptr<Condensation> CondensedCache::condense(const RegionFactor& region,
                                                       const Eigen::MatrixXd& loads, const Dofs& interface,
                                                       const SparseFactorMaker& make_factor) {
  std::unique_ptr<Condensation> condensed = with_springs(region, loads, interface, make_factor);
  const auto count = Eigen::Index(interface.size());
  Eigen::MatrixXd springs = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    springs(i, i) = -region.springs[std::size_t(interface[std::size_t(i)])];
  condensed->change(interface, springs, Eigen::MatrixXd::Zero(count, loads.cols()));
  return condensed;
}

std::unique_ptr<Condensation> CondensedCache::with_springs(const RegionFactor& region,
                                                           const Eigen::MatrixXd& loads,
                                                           const Dofs& interface,
                                                           const SparseFactorMaker& make_factor) {
  if (folder_.empty()) return condense_afresh(region, loads, interface, make_factor, log_);
  std::unique_ptr<SparseFactor> factor = make_factor();
  char name[32];
  const std::uint64_t key = key_of(region, loads, interface, factor->name());
  std::snprintf(name, sizeof name, "%016llx.condensed", static_cast<unsigned long long>(key));
  const std::filesystem::path file = folder_ / name;
  if (std::filesystem::exists(file))
    if (auto kept = load(file, key, std::move(factor), loads, interface)) {
      if (is_in_equilibrium(*kept, region, loads)) return kept;
      notice_ = file.string() +
                ": holds another region's numbers; the region was condensed afresh, and the file replaced";
    }
  auto condensed = condense_afresh(region, loads, interface, make_factor, log_);
  save(file, key, *condensed);
  return condensed;
}

std::unique_ptr<Condensation> CondensedCache::load(const std::filesystem::path& file, std::uint64_t key,
                                                   std::unique_ptr<SparseFactor> factor,
                                                   const Eigen::MatrixXd& loads, const Dofs& interface) {
  try {
    const std::string contents = io::read_sealed(file, format);
    io::ByteReader in(file.string(), contents);
    in.expect(in.get<std::uint64_t>() == key);
    auto condensed = Condensation::load(in, std::move(factor), loads);
    in.expect(!condensed || condensed->interface() == interface);
    return condensed;
  } catch (const InputError& error) {
    notice_ = std::string(error.what()) + "; the region was condensed afresh, and the file replaced";
    return nullptr;
  }
}

void CondensedCache::save(const std::filesystem::path& file, std::uint64_t key,
                          const Condensation& condensed) {
  io::ByteWriter out;
  out.put(key);
  if (!condensed.save(out)) return;
  try {
    std::error_code ignored;  // the file reports it when it cannot be written
    std::filesystem::create_directories(folder_, ignored);
    io::write_sealed(file, format, out.bytes());
  } catch (const InputError& error) {
    notice_ = std::string(error.what()) + "; the condensed region was not stored";
  }
}

}  // namespace lobe
