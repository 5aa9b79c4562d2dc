// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <CGAL/alpha_wrap_3.h>

#include "lobe_mesh/cgal_common.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {

Surface alpha_wrap(const Surface& surface, double alpha, double offset) {
  return guarded("wrapping", [&] {
    const Soup soup = to_soup(surface.points, surface.triangles);
    CgalMesh wrapping;
    CGAL::alpha_wrap_3(soup.points, soup.triangles, alpha, offset, wrapping);
    return from_cgal(wrapping);
  });
}

}  // namespace lobe::meshing
