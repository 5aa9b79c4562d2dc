// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// From a closed surface to tetrahedra that an explicit time integration can use.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lobe/mesh/quality.h"
#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {

enum class Mesher {
  cgal,    // Delaunay refinement and four optimisers: better angles, slower
  tetgen,  // remeshed surface, TetGen inside, smoothing: faster, keeps the remeshed surface
};

struct MeshOptions {
  double edge = 0;  // [m] edge of the regular tetrahedron of mean volume to aim at; 0: diagonal / 25
  Mesher mesher = Mesher::cgal;

  int tries = 0;  // meshes of slightly different edges, the one with the largest time step is kept; 0: cgal
                  // 1, tetgen 3
  double feature_angle = 60;                  // [degrees] edges that turn by more are kept sharp
  double time_limit = 600;                    // [s] of wall-clock time for all tries of the mesher
  double memory_limit = 8e9;                  // [bytes] of TetGen's process
  double lambda = 4e4;                        // [Pa] material that the stable time step is reported for
  double mu = 1e4;                            // [Pa]
  double density = 1000;                      // [kg/m³]
  std::filesystem::path tetgen_program = {};  // empty: lobe-tetgen beside the running program, or on the PATH
};

struct Phase {
  std::string name;
  double seconds = 0;
};

struct MeshReport {
  double edge = 0;       // [m] as asked for, or chosen
  double mean_edge = 0;  // [m] of the regular tetrahedron of mean volume
  Index vertices = 0;
  Index tets = 0;
  Index boundary_faces = 0;
  Quality quality;
  double surface_volume = 0;  // [m³]
  double volume_error = 0;    // [%] of the mesh against the surface
  double time_step = 0;       // [s] largest stable step of the material
  double time_step_star = 0;  // time_step × wave speed / mean_edge: independent of size and material
  std::vector<Phase> phases;
  std::vector<std::string> warnings;
};

// The surface must be what repair_surface() returns; every piece of it is meshed. The same surface and
// options give the same mesh, bit for bit. Throws InputError for options that make no sense for the
// surface, MeshingFailure if the mesher gives up.
TetMesh tetrahedralise(const Surface& surface, const MeshOptions& options, MeshReport& report);

}  // namespace lobe::meshing
