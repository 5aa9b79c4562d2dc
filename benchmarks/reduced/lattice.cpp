#include "benchmarks/reduced/lattice.h"

#include <cmath>
#include <cstdlib>
#include <map>

namespace lobe::reduced {
namespace {

using Place = std::array<Index, 3>;

Place place_of(const Vec3d& X, double spacing) {
  Place place;
  for (int d = 0; d < 3; ++d) place[d] = static_cast<Index>(std::floor(X[d] / spacing));
  return place;
}

void number_nodes(const std::map<Place, Index>& cells, Lattice& lattice) {
  std::map<Place, Index> numbers;
  lattice.nodes.resize(cells.size());
  lattice.centres.resize(cells.size());
  for (const auto& [place, cell] : cells) {
    for (int k = 0; k < 8; ++k) {
      const Place at{place[0] + (k & 1), place[1] + (k >> 1 & 1), place[2] + (k >> 2)};
      lattice.nodes[cell][k] = numbers.try_emplace(at, static_cast<Index>(numbers.size())).first->second;
    }
    lattice.centres[cell] = lattice.spacing * Vec3d(place[0] + 0.5, place[1] + 0.5, place[2] + 0.5);
  }
  lattice.node_count = static_cast<Index>(numbers.size());
}

// Where its own cell is empty: of those of its tetrahedra the one that it is the least outside of.
void embed_vertices(const Elements& elements, const std::map<Place, Index>& cells, Lattice& lattice) {
  const Index vertices = elements.topology.vertex_count();
  lattice.cell_of_vertex.assign(vertices, -1);
  lattice.weights.resize(vertices);
  std::vector<double> outside(vertices, 1e300);
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    for (int c = 0; c < 4; ++c) {
      const Index v = elements.topology.tets()(c, t), cell = lattice.cell_of_tet[t];
      const double distance = lattice.local(cell, elements.points.col(v)).cwiseAbs().maxCoeff();
      if (distance < outside[v]) outside[v] = distance, lattice.cell_of_vertex[v] = cell;
    }
  for (Index v = 0; v < vertices; ++v) {
    const auto own = cells.find(place_of(elements.points.col(v), lattice.spacing));
    if (own != cells.end()) lattice.cell_of_vertex[v] = own->second;
    if (lattice.cell_of_vertex[v] < 0) continue;
    const auto phi = trilinear_functions(lattice.local(lattice.cell_of_vertex[v], elements.points.col(v)));
    for (int n = 0; n < 8; ++n) {
      double sum = 0;
      for (int m = 0; m < 8; ++m) sum += sign(m, n) * phi[m];
      lattice.weights[v][n] = sum / 8;
    }
  }
}

// Tetrahedra by place; those of cells that are nearly empty are given to a neighbour that is not.
std::map<Place, std::vector<Index>> sorted_tets(const Elements& elements, double spacing, double least_fill) {
  std::map<Place, std::vector<Index>> places;
  std::map<Place, double> volumes;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Place place = place_of(elements.corner_points(t).rowwise().mean(), spacing);
    places[place].push_back(t);
    volumes[place] += elements.volume(t) / (spacing * spacing * spacing);
  }
  for (const auto& [place, fill] : volumes) {
    if (fill >= least_fill) continue;
    const Place* best = nullptr;
    double most = 0;
    for (const auto& [other, other_fill] : volumes) {
      const int distance =
          std::abs(other[0] - place[0]) + std::abs(other[1] - place[1]) + std::abs(other[2] - place[2]);
      if (distance == 1 && other_fill >= least_fill && other_fill > most) best = &other, most = other_fill;
    }
    if (!best) continue;
    std::vector<Index>& own = places[place];
    places[*best].insert(places[*best].end(), own.begin(), own.end());
    own.clear();
  }
  std::erase_if(places, [](const auto& entry) { return entry.second.empty(); });
  return places;
}

}  // namespace

std::array<double, 8> trilinear_functions(const Vec3d& xi) {
  return {1, xi[0], xi[1], xi[2], xi[1] * xi[2], xi[2] * xi[0], xi[0] * xi[1], xi[0] * xi[1] * xi[2]};
}

Lattice make_lattice(const Elements& elements, double spacing, double least_fill) {
  Lattice lattice;
  lattice.spacing = spacing;
  std::map<Place, Index> cells;
  lattice.cell_of_tet.resize(elements.topology.tet_count());
  for (const auto& [place, tets] : sorted_tets(elements, spacing, least_fill)) {
    const auto cell = static_cast<Index>(lattice.tets.size());
    cells[place] = cell;
    lattice.tets.push_back(tets);
    for (Index t : tets) lattice.cell_of_tet[t] = cell;
  }
  number_nodes(cells, lattice);
  embed_vertices(elements, cells, lattice);
  return lattice;
}

}  // namespace lobe::reduced
