// Runs on any number of ranks, all of them through every case.
#include <doctest/doctest.h>

#include <string>
#include <utility>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "lobe/mesh/generators.h"
#include "lobe/solve/static_solver.h"
#include "lobe_petsc/resolve_part.h"
#include "lobe_petsc/static_solver.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const petsc::Ranks& ranks() {
  static char name[] = "test_petsc";
  static char* arguments[] = {name, nullptr};
  static const petsc::Library library(1, arguments);
  static const petsc::Ranks all(PETSC_COMM_WORLD);
  return all;
}

struct Compared {
  int bodies = 0, too_small = 0, too_large = 0;
  double largest = 0;  // difference, relative to the largest displacement
};

// As exactly as rounding lets: 1e-13 if one load step gets there, else 1e-11.
template <class Options, class Solve>
auto solve_exactly(Options options, const Solve& solve) {
  const double smallest_load_step = std::exchange(options.smallest_load_step, 1);
  options.tolerance = 1e-13;
  auto solution = solve(options);
  if (solution.converged) return solution;
  options.smallest_load_step = smallest_load_step;
  options.tolerance = 1e-11;
  return solve(options);
}

// Rank 0 solves, the others wait for it.
Mat3X<double> serial(const Setup& setup) {
  Mat3X<double> u = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  std::string fault;
  if (ranks().rank() == 0) {
    try {
      StaticResult result =
          solve_exactly(StaticOptions{}, [&](const auto& o) { return solve_static(setup, o); });
      u = std::move(result.u);
      fault = result.reason;
    } catch (const std::exception& error) {
      fault = error.what();
    }
  }
  const bool fine = ranks().min(fault.empty() ? 1 : 0) > 0;
  if (!fine) throw std::runtime_error("serial solver: " + fault);
  MPI_Bcast(u.data(), int(u.size()), MPI_DOUBLE, 0, ranks().comm());
  return u;
}

petsc::Solution in_parts(const Setup& setup, const petsc::Part& part, petsc::Method method) {
  petsc::SolverOptions options;
  options.method = method;
  const Setup of_part = petsc::restrict_setup(setup, part);
  petsc::Solution solution =
      solve_exactly(options, [&](const auto& o) { return petsc::solve_static(ranks(), part, of_part, o); });
  CHECK_MESSAGE(solution.converged, solution.reason);
  return solution;
}

// Returns the displacement by the serial solver; rest for what is too large to be solved on each number of
// ranks.
Mat3X<double> compare(const Setup& setup, petsc::Method method, Compared& compared) {
  if (setup.mesh.tet_count() > 4000) {
    ++compared.too_large;
    return Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  }
  const Mat3X<double> reference = serial(setup);
  if (any_nodal_pressure(setup.materials)) return reference;  // not there, and refused
  petsc::Part part;
  try {
    part = petsc::make_part(ranks(), petsc::slice_of(ranks(), setup.mesh), "validation");
  } catch (const InputError&) {  // fewer tetrahedra than ranks can share
    REQUIRE(setup.mesh.tet_count() < 30);
    ++compared.too_small;
    return reference;
  }
  const petsc::Solution solution = in_parts(setup, part, method);
  double difference = 0;
  for (Index v = 0; v < part.mesh.vertex_count(); ++v)
    difference = std::max(difference, (solution.u.col(v) - reference.col(part.vertex_number[v])).norm());
  const double size = reference.colwise().norm().maxCoeff();
  compared.largest = std::max(compared.largest, ranks().max(size > 0 ? difference / size : difference));
  ++compared.bodies;
  return reference;
}

Compared compare_family(void (*family)(validation::Findings&, bool), petsc::Method method) {
  Compared compared;
  validation::solve_equilibria_by([&](const Setup& setup) { return compare(setup, method, compared); });
  validation::run_family({"petsc", family}, true);  // its findings are the validation's
  validation::solve_equilibria_by({});
  return compared;
}

}  // namespace

TEST_CASE("the equilibria of the validation are those of the serial solver") {
  const auto holds = [](const Compared& compared, int least) {
    CHECK(compared.bodies >= least);
    CHECK(compared.largest < 1e-8);
    if (ranks().rank() == 0)
      std::printf("%d bodies on %d ranks, %d too small, %d too large: largest difference %.1e\n",
                  compared.bodies, ranks().count(), compared.too_small, compared.too_large, compared.largest);
  };
  using petsc::Method;
  SUBCASE("patch tests") { holds(compare_family(validation::patch_tests, Method::mumps), 2); }
  SUBCASE("manufactured") { holds(compare_family(validation::manufactured_solutions, Method::mumps), 4); }
  SUBCASE("closed forms") { holds(compare_family(validation::closed_forms, Method::mumps), 2); }
  SUBCASE("beams") { holds(compare_family(validation::svk_beam, Method::mumps), 1); }
  SUBCASE("fibres") { holds(compare_family(validation::fibre_benchmarks, Method::mumps), 2); }
  SUBCASE("independent") { holds(compare_family(validation::independent_solutions, Method::mumps), 1); }
  SUBCASE("multigrid") { holds(compare_family(validation::patch_tests, Method::gamg), 2); }
  SUBCASE("hypre") { holds(compare_family(validation::patch_tests, Method::hypre), 2); }
}

namespace {

Setup mixed_bar(Vec3d size, int nx, int ny, int nz) {
  Setup setup = hybrid_setup(box_mesh(size, nx, ny, nz));
  setup.volume_penalty = 1e5;
  const double end = setup.mesh.points.row(0).maxCoeff();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const Vec3d X = setup.mesh.points.col(v);
    if (X[0] == 0) setup.prescribed.push_back({v, Vec3d::Zero(), {true, false, false}});  // rollers
    if (X[0] == 0 && X[1] == 0) setup.prescribed.push_back({v, Vec3d::Zero(), {false, true, true}});
    if (X[0] == end) setup.prescribed.push_back({v, {0.1 * end, 0, 0}, {true, false, false}});
    if (X[2] == 0) setup.vertex_loads.push_back({v, {0, 1e-4, 0}});
  }
  for (const TetFace& face : outer_faces(setup.mesh))
    setup.face_loads.push_back({face.tet, face.face, {0, 0, -20}});
  setup.gravity = {0, -9.81, 0};
  return setup;
}

}  // namespace

TEST_CASE("mixed regions, rollers, tractions, forces and gravity, by each method") {
  const Setup setup = mixed_bar({0.06, 0.02, 0.02}, 9, 3, 3);
  for (const petsc::Method method : {petsc::Method::mumps, petsc::Method::gamg, petsc::Method::hypre}) {
    Compared compared;
    compare(setup, method, compared);
    CHECK(compared.bodies == 1);
    CHECK(compared.largest < 1e-8);
  }
}

TEST_CASE("a factorisation that gets too little memory at first asks for more, and finds the same") {
  petsc::check(PetscOptionsSetValue(nullptr, "-mat_mumps_icntl_14", "-90"));  // % beyond the estimate
  Compared compared;
  compare(mixed_bar({0.06, 0.02, 0.02}, 9, 3, 3), petsc::Method::mumps, compared);
  petsc::check(PetscOptionsClearValue(nullptr, "-mat_mumps_icntl_14"));
  CHECK(compared.bodies == 1);
  CHECK(compared.largest < 1e-8);
}

TEST_CASE("parts are a partition: every tetrahedron once, every vertex owned once, the surface whole") {
  TetMesh mesh = box_mesh({1, 1, 1}, 4, 4, 4);
  std::swap(mesh.tets(2, 7), mesh.tets(3, 7));  // inside out, with a face on the surface or without
  const petsc::Part part = petsc::make_part(ranks(), petsc::slice_of(ranks(), mesh), "box");
  CHECK(ranks().sum(std::int64_t(part.mesh.tet_count())) == mesh.tet_count());
  CHECK(ranks().sum(std::int64_t(part.owned)) == mesh.vertex_count());
  CHECK(ranks().sum(std::int64_t(part.outer.size())) == std::int64_t(outer_faces(mesh).size()));
  for (const TetFace& face : part.outer) {
    const auto& corners = face_corners[face.face];
    Mat3<double> X;
    for (int c = 0; c < 3; ++c) X.col(c) = part.mesh.points.col(part.mesh.tets(corners[c], face.tet));
    const Vec3d low = X.rowwise().minCoeff(), high = X.rowwise().maxCoeff();
    const bool on_side = ((low.array() == 0) && (high.array() == 0)).any() || ((low.array() == 1)).any();
    CHECK(on_side);
  }
  double volume = 0;
  for (Index t = 0; t < part.mesh.tet_count(); ++t) volume += signed_volume(tet_points(part.mesh, t));
  CHECK(std::abs(ranks().sum(volume) - 1) < 1e-12);
}

TEST_CASE("faults of one rank are thrown on all, and the job goes on") {
  for (int faulty = 0; faulty < ranks().count(); ++faulty) {
    std::string what;
    try {
      ranks().together([&] {
        if (ranks().rank() == faulty)
          throw InputError({{"place", "of rank " + std::to_string(faulty)}, {"other", "fault"}});
      });
    } catch (const InputError& error) {
      what = error.what();
      CHECK(error.faults().size() == 2);
    }
    CHECK(what.find("place: of rank " + std::to_string(faulty)) != std::string::npos);
  }
}

TEST_CASE("too many ranks, floating pieces, nodal pressure and missing methods are refused") {
  Setup setup = mixed_bar({0.02, 0.02, 0.02}, 2, 2, 2);
  if (ranks().count() > 1) {
    const TetMesh one{Mat3X<double>(setup.mesh.points.leftCols(4)), Tets(Eigen::Vector4i(0, 1, 2, 3)), {0}};
    CHECK_THROWS_WITH_AS(petsc::make_part(ranks(), petsc::slice_of(ranks(), one), "one.vtu"),
                         doctest::Contains("start at most as many ranks as there are tetrahedra"),
                         InputError);
  }
  const petsc::Part part = petsc::make_part(ranks(), petsc::slice_of(ranks(), setup.mesh), "box");
  Setup floating = setup;
  std::erase_if(floating.prescribed, [](const PrescribedVertex& p) { return p.axes[1]; });
  CHECK_THROWS_WITH_AS(petsc::solve_static(ranks(), part, petsc::restrict_setup(floating, part), {}),
                       doctest::Contains("a piece of 48 tetrahedra is not held"), InputError);
  for (Elastic& elastic : setup.materials) elastic.nodal_pressure = 1;
  CHECK_THROWS_WITH_AS(petsc::solve_static(ranks(), part, petsc::restrict_setup(setup, part), {}),
                       doctest::Contains("--solver eigen"), InputError);
  CHECK_THROWS_WITH_AS(petsc::method_of("hypre", {"auto", "gamg"}),
                       doctest::Contains("built without hypre; it has auto, gamg"), InputError);
  CHECK_THROWS_WITH_AS(petsc::method_of("jacobi", {"auto", "gamg"}), doctest::Contains("must be one of"),
                       InputError);
}

TEST_CASE("a mechanism or an impossible load ends with a reason, and the last equilibrium is kept") {
  Setup setup = mixed_bar({0.06, 0.02, 0.02}, 6, 2, 2);
  for (RegionModel& model : setup.region_of) model = RegionModel::nonlinear;
  setup.volume_penalty = 0;
  for (PrescribedVertex& p : setup.prescribed) p.displacement *= -11;  // to the other side of the held end
  const petsc::Part part = petsc::make_part(ranks(), petsc::slice_of(ranks(), setup.mesh), "box");
  petsc::SolverOptions options;
  options.smallest_load_step = 0.2;
  options.most_iterations = 15;
  const petsc::Solution solution =
      petsc::solve_static(ranks(), part, petsc::restrict_setup(setup, part), options);
  CHECK(!solution.converged);
  CHECK(solution.reason.find("no equilibrium beyond") == 0);
  CHECK(solution.load_fraction < 1);
  CHECK(solution.u.allFinite());
}
