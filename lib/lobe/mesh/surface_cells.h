// The cells whose boundary is a surface: the tetrahedra of a body, or the grains into which a blade has
// divided them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lobe/mesh/topology.h"

namespace lobe {

// Where a point is: at a vertex of the mesh, or within a tetrahedron.
struct SurfacePlace {
  Index vertex = -1;                                        // −1: it lies within a tetrahedron
  Eigen::Vector4i corners = Eigen::Vector4i::Constant(-1);  // corners of the tetrahedron, as vertices
  Eigen::Vector4d weights = Eigen::Vector4d::Zero();        // barycentric weights
};

class SurfaceCells {
 public:
  struct Cell {
    Index tet = -1;  // tetrahedron that it is part of; −1: it is gone
    Eigen::Vector4i points = Eigen::Vector4i::Constant(-1);  // oriented as a tetrahedron's corners
    unsigned outer = 0;                                      // one bit per face: nothing is behind it
  };

  virtual ~SurfaceCells() = default;
  virtual Index count() const = 0;
  virtual Index point_count() const = 0;
  virtual Cell cell(Index cell) const = 0;
  virtual std::vector<Index> outer_faces() const = 0;  // codes 4 × cell + face of all outer faces
  virtual std::span<const Index> around(Index point) const = 0;
  virtual void append_cells_of(Index tet, std::vector<Index>& cells) const = 0;
  // Whether an outer face was inside at the start; `was_cut` is what was known of it, true for a new one.
  virtual bool is_cut(Index code, bool was_cut) const = 0;
  virtual Index stroke_of(Index) const { return -1; }  // stroke that has opened the face; −1: none
  // Whether an opened face has lost what was behind it, to a cautery; else a blade has parted both.
  // `was_burnt` is what was known of it, false for a new one.
  virtual bool is_burnt(Index code, bool) const { return stroke_of(code) < 0; }
  virtual SurfacePlace place(Index point) const = 0;
  virtual bool are_tets() const { return false; }  // the cells are the tetrahedra, the points the vertices
};

// The tetrahedra themselves, where no blade has cut.
class TetCells : public SurfaceCells {
 public:
  // New faces of the boundary were inside before.
  explicit TetCells(const Topology& topology) : topology_(topology) {}
  // Cells after an edit that has removed these tetrahedra. O(n log n) in their number.
  TetCells(const Topology& topology, std::span<const Index> removed);
  // What was inside at the start follows from the tetrahedra that are gone. O(#tets), and O(n log n) in the
  // number of these.
  static TetCells since_start(const Topology& topology);

  Index count() const override { return topology_.tet_count(); }
  Index point_count() const override { return topology_.vertex_count(); }
  Cell cell(Index tet) const override;
  std::vector<Index> outer_faces() const override { return topology_.boundary_faces(); }
  std::span<const Index> around(Index point) const override { return topology_.around(point); }
  void append_cells_of(Index tet, std::vector<Index>& cells) const override { cells.push_back(tet); }
  bool is_cut(Index code, bool was_cut) const override;
  bool is_burnt(Index code, bool was_burnt) const override;
  SurfacePlace place(Index point) const override { return {point}; }
  bool are_tets() const override { return true; }

 private:
  using FaceAtStart = std::array<Index, 3>;  // vertices of the mesh at the start, ascending
  static FaceAtStart key_of(const Topology& topology, Index code);
  void add_gone(Index tet);
  bool is_behind_gone(Index code) const;

  const Topology& topology_;
  bool knows_start_ = false;
  std::vector<FaceAtStart> gone_;  // faces of tetrahedra that are gone: behind them was tissue
};

}  // namespace lobe
