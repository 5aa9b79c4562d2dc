// Fields of a deformed body, per tetrahedron, for recordings and pictures.
#pragma once

#include "lobe/fem/elements.h"
#include "lobe/io/mesh_io.h"

namespace lobe {

struct TetFields {
  double volume_ratio = 1;  // det F
  Mat3<double> strain;      // non-linear region: Green-St Venant E; linear: ε
  Mat3<double> stress;      // Cauchy, volume term included; linear: σ [Pa]
  double von_mises = 0;     // [Pa]
};

// The fields of a tetrahedron, by the model of its region.
TetFields tet_fields(const Elements& elements, Index tet,
                     const Mat34<double>& u,  // displacements of the four corners [m]
                     double pressure);        // p_T of tet_pressures(), 0 without nodal pressure [Pa]

// Writes the body as it is cut now: all vertices at rest positions and the tetrahedra that are left, in the
// order of the input. It has the point data displacement [m], velocity [m/s], reaction [N] (if `reactions`
// has columns: what holds the body acts on it with these forces), and the cell data region,
// volume_ratio, strain, stress (xx, yy, zz, xy, yz, xz) [Pa], von_mises [Pa], density [kg/m³], source (the
// input's tetrahedron), and the labels; of a mesh of several bodies also body. Throws InputError if the file
// cannot be written.
// `is_embedded`: per vertex, whether the lattice of a reduced region moves it. If it is not empty, the cell
// data embedded is 1 where the lattice moves all corners.
void write_frame(const std::filesystem::path& file, const Elements& elements, const Mat3X<double>& u,
                 const Mat3X<double>& v, const std::vector<std::uint8_t>& is_embedded = {},
                 const Mat3X<double>& reactions = {});

// The cell data body of tetrahedra, in this order: the place of its body among those of the mesh.
DataArray body_cells(const Elements& elements, const std::vector<Index>& tets);
// The cell data embedded of tetrahedra, in this order.
DataArray embedded_cells(const Elements& elements, const std::vector<Index>& tets,
                         const std::vector<std::uint8_t>& is_embedded);

// Volume of the deformed body [m³].
double current_volume(const Elements& elements, const Mat3X<double>& u);

}  // namespace lobe
