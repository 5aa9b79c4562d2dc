// A surface meshed from code.
#include <lobe_mesh/repair.h>
#include <lobe_mesh/tetrahedralise.h>
#include <cstdio>

int main(int, char** argv) {
  using namespace lobe::meshing;
  RepairReport repairs;
  const Surface surface = repair_surface(read_surface(argv[1]), {}, repairs);
  MeshReport report;
  MeshOptions options;
  options.edge = 0.01;
  const lobe::TetMesh mesh = tetrahedralise({surface}, options, report);
  std::printf("%d tetrahedra, volume error %.1f %%\n", mesh.tet_count(), report.volume_error);
}
