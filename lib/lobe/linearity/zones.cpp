#include "lobe/linearity/zones.h"

#include <algorithm>
#include <numeric>

#include "lobe/error.h"

#ifdef LOBE_WITHOUT_METIS
#include "lobe/linearity/halving.h"
#else
#include <metis.h>

#include "lobe/numerics/metis_lock.h"
#endif

namespace lobe {
namespace {

// The part of each tetrahedron, 0 … count − 1.
std::vector<Index> parts_of(const Elements& elements, Index count) {
#ifdef LOBE_WITHOUT_METIS
  return parts_by_halving(elements, count);
#else
  const Index tet_count = elements.topology.tet_count();
  std::vector<idx_t> start, corners, part(static_cast<std::size_t>(tet_count)),
      vertex_part(std::size_t(elements.topology.vertex_count()));
  for (Index t = 0; t <= tet_count; ++t) start.push_back(4 * t);
  for (Index t = 0; t < tet_count; ++t)
    for (Index v : elements.topology.corners(t)) corners.push_back(v);
  idx_t size = tet_count, vertices = elements.topology.vertex_count(), shared = 3, parts = count, cut = 0;
  const auto metis = lock_metis();
  METIS_PartMeshDual(&size, &vertices, start.data(), corners.data(), nullptr, nullptr, &shared, &parts,
                     nullptr, nullptr, &cut, part.data(), vertex_part.data());
  return {part.begin(), part.end()};
#endif
}

}  // namespace

Zones::Zones(const Elements& elements, Index count) : of(std::size_t(elements.topology.tet_count()), 0) {
  const Index tet_count = elements.topology.tet_count();
  if (count < 1 || count > tet_count)
    throw InputError("zones", std::to_string(count) + ", must be 1 to the number of tetrahedra, " +
                                  std::to_string(tet_count));
  if (count == tet_count) {
    std::iota(of.begin(), of.end(), 0);
  } else if (count > 1) {
    of = parts_of(elements, count);
  }
  const Index first_copy = tet_count - elements.topology.tet_copy_count();
  for (Index t = first_copy; t < tet_count; ++t)
    of[std::size_t(t)] = of[std::size_t(elements.topology.parent(t))];
  tets.resize(std::size_t(count));
  for (Index t = 0; t < tet_count; ++t) tets[std::size_t(of[t])].push_back(t);
  std::erase_if(tets, [](const std::vector<Index>& zone) { return zone.empty(); });
  for (std::size_t z = 0; z < tets.size(); ++z) {
    double& sum = volume.emplace_back(0);
    for (Index t : tets[z]) {
      of[std::size_t(t)] = static_cast<Index>(z);
      sum += elements.volume(t);
    }
  }
}

void Zones::follow_copies(const Topology& topology) {
  const Index first_copy = topology.tet_count() - topology.tet_copy_count();
  of.resize(std::size_t(first_copy));
  for (std::vector<Index>& zone : tets) std::erase_if(zone, [&](Index t) { return t >= first_copy; });
  for (Index t = first_copy; t < topology.tet_count(); ++t) {
    of.push_back(of[std::size_t(topology.parent(t))]);
    tets[std::size_t(of.back())].push_back(t);
  }
}

double Zones::norm(const Eigen::VectorXd& u) const {
  double sum = 0;
  for (Index z = 0; z < count(); ++z) sum += volume[std::size_t(z)] * u.segment<3>(3 * z).squaredNorm();
  return std::sqrt(sum);
}

Index usual_zone_count(Index tets) { return std::min(std::max(tets / 60, std::min<Index>(tets, 8)), 96); }

}  // namespace lobe
