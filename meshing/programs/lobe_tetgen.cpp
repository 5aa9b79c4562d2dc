// lobe-tetgen: TetGen as a program of its own, because TetGen may crash, hang or exhaust the memory.
//
// This program is linked to TetGen and is therefore distributed under the GNU Affero General Public License,
// version 3 or later; see meshing/LICENSE.
//
// Usage: lobe-tetgen INPUT OUTPUT SWITCHES, files as in tetgen_files.h. Exit status 0: OUTPUT was written;
// 2: wrong usage or unreadable input; 3: TetGen refused the surface; 4: it made no tetrahedra.
#include <tetgen.h>
#include <unistd.h>

#include <algorithm>
#include <exception>

#include "lobe_mesh/tetgen_files.h"

namespace {

using lobe::meshing::TetgenFile;

void fill(const TetgenFile& surface, tetgenio& in) {
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(surface.points.size() / 3);
  in.pointlist = new REAL[surface.points.size()];
  std::copy(surface.points.begin(), surface.points.end(), in.pointlist);
  in.numberoffacets = static_cast<int>(surface.cells.size() / 3);
  in.facetlist = new tetgenio::facet[static_cast<std::size_t>(in.numberoffacets)];
  for (int f = 0; f < in.numberoffacets; ++f) {
    tetgenio::facet& facet = in.facetlist[f];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    tetgenio::polygon& polygon = facet.polygonlist[0];
    tetgenio::init(&polygon);
    polygon.numberofvertices = 3;
    polygon.vertexlist = new int[3];
    std::copy_n(surface.cells.begin() + 3 * f, 3, polygon.vertexlist);
  }
}

TetgenFile result(const tetgenio& out) {
  TetgenFile mesh;
  mesh.points.assign(out.pointlist, out.pointlist + 3 * out.numberofpoints);
  for (int t = 0; t < out.numberoftetrahedra; ++t) {
    const int* corners = out.tetrahedronlist + t * out.numberofcorners;
    mesh.cells.insert(mesh.cells.end(), corners, corners + 4);
    const bool regions = out.numberoftetrahedronattributes > 0;
    mesh.regions.push_back(
        regions ? static_cast<int>(out.tetrahedronattributelist[t * out.numberoftetrahedronattributes]) : 0);
  }
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  // TetGen frees memory twice if an exception unwinds it. So the program ends at once, whatever is thrown.
  std::set_terminate([] { _exit(3); });
  TetgenFile surface;
  if (argc != 4 || !surface.read(argv[1])) return 2;
  static tetgenio in, out;  // static: not destroyed before _exit()
  fill(surface, in);
  try {
    tetrahedralize(argv[3], &in, &out);
  } catch (...) {
    _exit(3);
  }
  if (out.numberoftetrahedra <= 0) _exit(4);
  _exit(result(out).write(argv[2]) ? 0 : 2);
}
