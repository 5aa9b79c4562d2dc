// The commands of `lobe`. Each prints its result, throws InputError for bad input, and returns an exit
// status.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lobe/numerics/sparse_factor.h"
#include "lobe/types.h"

namespace lobe::program {

struct InfoOptions {
  std::filesystem::path mesh;
  double lame_lambda = 4e4, lame_mu = 1e4, density = 1000;  // [Pa], [Pa], [kg/m³]: for the stable time step
  bool json = false;
};
int info(const InfoOptions& options);

struct SceneOptions {
  std::filesystem::path scene;
  std::filesystem::path mesh;    // in place of the scene's, if not empty
  std::filesystem::path output;  // a directory (run) or a mesh (regions)
  int threads = 1;
  bool json = false;
  bool no_pictures = false;
  std::filesystem::path picture;  // of `regions`, if not empty
  std::filesystem::path record;   // of `run`: a file for the recording; of `replay`: the recording
  std::string solver = "eigen";   // of `solve`: the one that is linked, or that of a sibling program
  bool quadratic = false;         // of `solve`: with 10-node tetrahedra
  bool total_error = false;       // of `check`: also how far the mesh is from the truth
};

// The sparse solver that this program is linked to.
struct Solver {
  const char* name;
  SparseFactorMaker make;
  SparseFactorMaker make_definite;  // of matrices that are positive definite in equilibrium
};
extern const Solver linked_solver;

int check(const SceneOptions& options);
int run(const SceneOptions& options);
int replay(const SceneOptions& options);
int solve(const SceneOptions& options);
int regions(const SceneOptions& options);

struct RestOptions {
  std::filesystem::path scene, mesh, output;  // the mesh in place of the scene's, if not empty
  double tolerance = 1e-5;                    // [m]
  bool json = false;
};
int rest(const RestOptions& options);

struct FitCommand {
  std::vector<std::filesystem::path> scenes, data;  // a table of measurements for each scene
  std::vector<std::string> parameters{"young_modulus"};
  std::filesystem::path output;  // the first scene with what was found, if not empty
  bool json = false;
};
int fit(const FitCommand& command);

struct SensitivityCommand {
  std::filesystem::path scene;
  std::filesystem::path output;   // a mesh with the sensitivity of each tetrahedron (.vtu), if not empty
  std::filesystem::path picture;  // of it, if not empty
  bool json = false;
};
int sensitivity(const SensitivityCommand& command);

struct CompareOptions {
  std::filesystem::path a, b;
  bool json = false;
};
int compare(const CompareOptions& options);

struct RefineOptions {
  std::filesystem::path mesh, output;
  int times = 1;
  long long tets = 0;  // if above 0: as often as it takes to have so many
};
int refine(const RefineOptions& options);

struct ConvertOptions {
  std::filesystem::path mesh, output;
  double scale = 1;
  std::string labels;  // the cell array that has them; empty: read_mesh() chooses
};
int convert(const ConvertOptions& options);

struct MakeSceneOptions {
  std::vector<std::filesystem::path> files;  // a mesh, a label image, or surfaces
  std::filesystem::path output;  // the scene; empty: default_scene(); a mesh that is made is beside it
  double scale = 0;              // from the file's coordinates to metres; 0: by its size
  double edge = 0;               // of tetrahedra that a surface is filled with [m]; 0: lobe-mesh chooses
  double voxels = 0;             // of voxels that surfaces are turned into first [m]; 0: where they overlap
  bool accepts_loss = false;     // of volume, as lobe-mesh --accept-loss
  std::string tissue = "liver";
  std::string hold;         // one of names_of_sides(); empty: the broadest side
  double springs = 0;       // stiffness per area of a bed on which that side lies [Pa/m]; 0: it is fixed
  std::vector<Vec3d> pins;  // places that are fixed, at the body at rest [m]
};
std::vector<std::string> names_of_sides();  // and "none"
// "organ_scene.json" in the working folder for organ.stl: no name that a user's own files are likely to have.
std::filesystem::path default_scene(const MakeSceneOptions& options);
// Warnings of lobe-mesh, which has printed them, are added to `warnings` if that is not null.
int make_scene(const MakeSceneOptions& options, std::vector<std::string>* warnings = nullptr);

struct TissuesOptions {
  bool json = false;
};
int print_tissues(const TissuesOptions& options);

}  // namespace lobe::program
