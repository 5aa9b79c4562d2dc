// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// From closed surfaces or a label image to tetrahedra that an explicit time integration can use.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lobe/mesh/quality.h"
#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/label_image.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {

enum class Mesher {
  cgal,    // Delaunay refinement of the surface and what is inside; follows a sizing
  tetgen,  // remeshed surface, filled by TetGen: keeps creases of a coarse surface
};

// Shorter edges in a ball, such as where an instrument will cut.
struct SizeBall {
  Vec3d centre = Vec3d::Zero();  // [m]
  double radius = 0;             // [m]
  double edge = 0;               // [m]
};

struct MeshOptions {
  double edge = 0;  // edge of the regular tetrahedron of mean volume to aim at [m]; 0: diagonal / 25
  std::map<int, double> label_edges = {};  // edges in single labels, in place of `edge` [m] (cgal only)
  std::vector<SizeBall> balls = {};        // balls with edges of their own (cgal only)
  double growth = 0.3;                     // growth of the edge per distance, where it changes
  // Whether edges are shorter along parts of the surface that a mesh would lose, and in labels whose volume
  // it would not keep (cgal only). With `edge` 0 they are in any case.
  bool keep_thin = false;
  // Whether voxels that lose much of a surface's volume are meshed all the same (voxels.h), and a mesh that
  // has lost so much of a label's counts as done for the program (quality_gate.lost_volume).
  bool accepts_loss = false;
  Mesher mesher = Mesher::cgal;
  // Number of surfaces, the last ones, that bound cavities: what they enclose is not meshed.
  std::size_t cavities = 0;

  double smoothing = 1;  // width of the Gaussian on a label image's staircase [voxels], see label_grid.h

  int tries = 1;              // meshes of slightly different edges, of which the best is kept
  double feature_angle = 60;  // turn above which an edge is kept sharp [degrees]
  double time_limit = 600;    // wall-clock time for all tries of the mesher [s]
  double memory_limit = 8e9;  // memory of TetGen's process [bytes]
  double lambda = 4e4;        // moduli of the material that the stable time step is reported for [Pa]
  double mu = 1e4;            // [Pa]
  double density = 1000;      // [kg/m³]
  // Called now and then with what is being done, and how much of it: 0 … 1, or −1 where that is unknown.
  std::function<void(const std::string& phase, double done)> progress = [](const std::string&, double) {};
  std::filesystem::path tetgen_program = {};  // empty: lobe-tetgen beside the running program, or on the PATH
};

// What a mesh must reach, or further ones are made with another edge and the other mesher.
struct QualityGate {
  double min_dihedral = 15;              // [degrees]
  double smallest_altitude_ratio = 0.1;  // smallest altitude over the longest edge of its tetrahedron
  double time_step_star = 0.5;
  double gap = 1;           // largest distance between surface and mesh, over the longest edge asked for
  double lost_volume = 25;  // largest part of a label's volume that is not in the mesh [%]
};
constexpr QualityGate quality_gate;
constexpr int second_tries = 4;  // most further tries, after `tries`

struct Phase {
  std::string name;
  double seconds = 0;
};

struct Attempt {
  Mesher mesher = Mesher::cgal;
  double edge = 0;            // edge aimed at [m]
  double min_dihedral = 0;    // [degrees]
  double time_step_star = 0;  // 0: it failed
  std::string failure;
  double largest_gap = 0;  // largest distance between surface and mesh [m]
};

// The vertex that bounds the time step, by the vertex estimate.
struct Bottleneck {
  Index vertex = -1;
  Vec3d position = Vec3d::Zero();  // [m]
  Index tets = 0;                  // tetrahedra around it
  bool on_boundary = false;
};

// Distances of one surface from another, weighted by area.
struct SurfaceGap {
  double mean = 0, percentile_95 = 0, largest = 0;  // [m]
  Vec3d place = Vec3d::Zero();                      // place of the largest [m]
};

struct MeshReport {
  Mesher mesher = Mesher::cgal;  // mesher of the mesh that was kept
  double edge = 0;               // edge asked for, or chosen [m]
  double shortest_edge = 0;      // shortest edge asked for anywhere [m]
  double longest_edge = 0;       // longest edge asked for in any label [m]
  double mean_edge = 0;          // mean edge as in Quality [m]
  Index vertices = 0;
  Index tets = 0;
  Index boundary_faces = 0;
  Quality quality;
  double surface_volume = 0;  // [m³]
  double volume_error = 0;    // excess of the mesh's volume over the surface's [%]
  double time_step = 0;       // largest stable step of the material [s]
  // time_step × wave speed / edge of the regular tetrahedron of mean volume (/ shortest_edge, if edges
  // differ): independent of size and material.
  double time_step_star = 0;
  Bottleneck bottleneck;
  // Distances of the input's surfaces (for an image: those between smoothed labels) and of the mesh's faces.
  SurfaceGap surface_to_mesh, mesh_to_surface;
  double keeping_edge = 0;  // edge that would keep parts which the mesh lost [m]; 0: it lost none
  struct Part {
    int label = 0;
    Index tets = 0;
    double volume = 0, surface_volume = 0;  // volumes of the mesh, and of the surfaces or voxels [m³]
    double volume_error() const { return 100 * (volume / surface_volume - 1); }  // [%]
  };
  std::vector<Part> parts;  // one part per label
  std::vector<Attempt> attempts;
  std::vector<Phase> phases;
  std::vector<std::string> warnings;

  Index missing_labels() const;  // labels without a tetrahedron
  double largest_gap() const;    // larger of both gaps [m]
  double lost_volume() const;    // largest part of a label's volume that is not in the mesh [%]
  bool has_good_shapes() const;  // whether angles, altitudes and time step pass the gate
  bool passes() const;           // whether the mesh passes the gate with every label
};

// The edge of tetrahedra where none is asked for [m]: 1/25 of the diagonal.
double default_edge(const std::vector<Surface>& surfaces);

// Surfaces must be what repair_surface() returns, each inside another one or apart from it, or with the same
// triangles as others where it touches them; every piece of them is meshed. The label of a tetrahedron is the
// number of the innermost surface around it; the triangles between two labels belong to one tetrahedron of
// each. The same surfaces and options give the same mesh, bit
// for bit. Throws InputError for options that make no sense for the surface, MeshingFailure if the meshers
// give up.
TetMesh tetrahedralise(const std::vector<Surface>& surfaces, const MeshOptions& options, MeshReport& report);

// Meshes every label of the image but 0; tetrahedra carry the image's labels. With Mesher::cgal only.
TetMesh tetrahedralise(const LabelImage& image, const MeshOptions& options, MeshReport& report);

}  // namespace lobe::meshing
