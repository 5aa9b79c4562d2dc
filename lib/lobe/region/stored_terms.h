// The paper's non-linear tensor-mass model ([PDA] section 3.2, table 1): the SVK force as a polynomial whose
// coefficients are stored on vertices, edges, triangles and tetrahedra. About 65 numbers per tetrahedron.
//
// The polynomial is in the displacements themselves, not in their differences: the terms of a body that has moved far
// cancel, and lose (|u| / edge)³ roundings. Coefficients and terms are therefore always in double precision.
#pragma once

#include <array>
#include <cstddef>
#include <unordered_map>
#include <vector>

#include "lobe/fem/nonlinear_tensor_mass.h"
#include "lobe/mesh/vertex_lists.h"
#include "lobe/parallel.h"
#include "lobe/region/elements.h"

namespace lobe {

// All vertices, or edges, triangles, tetrahedra, of the region and the coefficients they carry.
template <class Terms>
class TermSet {
 public:
  static constexpr int n = Terms::vertices;
  using Key = std::array<Index, std::size_t(n)>;  // ascending

  void add_vertices(Index count) {
    while (outputs_of_.vertex_count() < count) outputs_of_.add_vertex();
  }
  void add(const Key& key, const Terms& terms);
  void erase_around(Index vertex);
  Index count() const { return static_cast<Index>(keys_.size()); }
  void add_forces(const Mat3X<double>& u, Mat3X<double>& f, Parallel& parallel);

 private:
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  void erase(Index slot);
  void evaluate(const Mat3X<double>& u, Index slot);

  std::vector<Key> keys_;
  std::vector<std::array<double, std::size_t(Terms::size)>> values_;
  std::unordered_map<Key, Index, Hash> slot_of_;
  VertexLists<Index> outputs_of_;  // per vertex: columns of forces_, n × slot + position in the key
  Mat3X<double> forces_;           // scratch
};

class StoredTerms {
 public:
  // Gathers anew everything that touches one of the vertices of an edit; at first, all vertices.
  void follow(const Elements& elements, const std::vector<Index>& vertices);
  template <class Real>
  void add_forces(const Mat3X<Real>& u,  // 3 × #vertices [m]
                  Mat3X<Real>& f,        // 3 × #vertices [N]
                  Parallel& parallel);
  std::size_t bytes() const;  // of coefficients and vertex numbers

 private:
  TermSet<VertexTerms> vertices_;
  TermSet<EdgeTerms> edges_;
  TermSet<TriangleTerms> triangles_;
  TermSet<TetTerms> tets_;
  Mat3X<double> u_, f_;  // scratch
};

}  // namespace lobe
