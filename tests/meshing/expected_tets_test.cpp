// How many tetrahedra are expected, against how many there are.
#include "lobe_mesh/expected_tets.h"

#include "lobe_mesh/tetrahedralise.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

Surface slab(double low, double high) {  // 12 × 12 mm
  Surface surface = make_cube(1);
  surface.points =
      (Vec3d(0.012, 0.012, high - low).asDiagonal() * surface.points).colwise() + Vec3d(0, 0, low);
  return surface;
}

// Made over expected.
double made_over_expected(const std::vector<Surface>& surfaces, const MeshOptions& options) {
  MeshReport report;
  tetrahedralise(surfaces, options, report);
  return report.tets / expected_tets(options, make_model(surfaces));
}

}  // namespace

TEST_CASE("as many tetrahedra are expected as there are, where edges differ, too") {
  const Surface organ = make_sphere(0.05, 3), tumour = moved(make_sphere(0.012, 3), {0.02, 0, 0});
  CHECK(made_over_expected({organ}, {.edge = 0.01}) == near(1, 0.08));
  CHECK(made_over_expected({organ, tumour}, {.edge = 0.012, .label_edges = {{1, 0.004}}}) == near(1, 0.08));
  CHECK(made_over_expected({organ}, {.edge = 0.012, .balls = {{{-0.05, 0, 0}, 0.01, 0.004}}}) ==
        near(1, 0.08));
  // Along the rims of a layer of 1.3 edges there are more.
  CHECK(made_over_expected({slab(0, 0.004), slab(0.004, 0.0053)},
                           {.edge = 0.003, .label_edges = {{1, 0.001}}}) == near(1.33, 0.2));
}

TEST_CASE("tetrahedra that grow from a shorter edge are those of the integral over a flat layer") {
  // A thin slab below a thick one: edges a in the first, a + g z above.
  const double a = 0.0005, g = 0.3, depth = 0.004, area = 0.012 * 0.012;
  Model model = make_model({slab(0, depth), slab(depth, depth + 0.001)});
  model.junctions.clear();  // without what their lines add
  const auto per_volume = [](double edge) { return 6 * std::numbers::sqrt2 / std::pow(edge, 3); };
  const double grown =
                   area * 6 * std::numbers::sqrt2 / (2 * g) * (1 / (a * a) - 1 / std::pow(a + g * depth, 2)),
               fine = area * 0.001 * per_volume(a);
  const MeshOptions options{.edge = 0.01, .label_edges = {{1, a}}, .growth = g};
  CHECK(expected_tets(options, model) == near(grown + fine, 0.08));
  CHECK(expected_tets({.edge = 0.002}, model) == near(area * (depth + 0.001) * per_volume(0.002), 0.08));
}

TEST_CASE("a layer that is thinner than an edge is expected to have edges of its thickness") {
  const Model model = make_model({slab(0, 0.004), slab(0.004, 0.0053)});
  const MeshOptions options = with_edges_of_thin_labels({.edge = 0.003, .label_edges = {{0, 0.001}}}, model);
  CHECK(options.label_edges.at(0) == 0.001);
  CHECK(options.label_edges.at(1) == near(edge_within(model, 1), 1e-12));
  CHECK(edge_within(model, 1) == near(2 * 0.0013 * 0.144 / (0.288 + 0.0624), 1e-9));
}
