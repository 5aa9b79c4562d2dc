#include "benchmarks/kernel_cases.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "lobe/mesh/generators.h"
#include "lobe/sim/world.h"

namespace lobe::bench {
namespace {

template <class Real>
constexpr const char* precision_name = sizeof(Real) == 4 ? "single" : "double";

RegionEdit everything(const Elements& elements) {
  RegionEdit edit;
  edit.entered.resize(std::size_t(elements.topology.tet_count()));
  std::iota(edit.entered.begin(), edit.entered.end(), 0);
  edit.vertices.resize(std::size_t(elements.topology.vertex_count()));
  std::iota(edit.vertices.begin(), edit.vertices.end(), 0);
  return edit;
}

using CubePointer = std::shared_ptr<const Cube>;

std::shared_ptr<const Mat3X<double>> part_of(const CubePointer& cube, const Mat3X<double>& forces) {
  return {cube, &forces};
}

Kernel reference_kernel(const CubePointer& cube) {
  const auto f = std::make_shared<Mat3X<double>>(Mat3X<double>::Zero(3, cube->u.cols()));
  Kernel kernel{"reference", "double", 1, sizeof(ReferenceTet), {}, {}, part_of(cube, cube->svk)};
  kernel.evaluate = [cube, f] {
    f->setZero();
    add_reference_forces(cube->reference, cube->u, *f);
  };
  kernel.forces = [f] { return *f; };
  return kernel;
}

// One region's forces on all vertices; the region is built once for all numbers of threads.
template <class Real, class Region>
void add_region(std::vector<Kernel>& kernels, const std::string& name, const CubePointer& cube,
                const std::vector<int>& threads, const std::shared_ptr<Region>& region, double bytes_per_tet,
                const Mat3X<double>& expected) {
  struct Data {
    Mat3X<Real> u, f;
  };
  const auto data = std::make_shared<Data>(Data{cube->u.cast<Real>(), cube->u.cast<Real>()});
  for (int n : threads) {
    const auto parallel = std::make_shared<Parallel>(n);
    Kernel kernel{name, precision_name<Real>, n, bytes_per_tet, {}, {}, part_of(cube, expected)};
    kernel.evaluate = [region, data, parallel] {
      data->f.setZero();
      region->add_forces(data->u, data->f, *parallel);
    };
    kernel.forces = [data] { return Mat3X<double>(data->f.template cast<double>()); };
    kernels.push_back(std::move(kernel));
  }
}

template <class Real>
constexpr double block_bytes = double(sizeof(ElementBlock<Real>)) / ElementBlock<Real>::width;

template <class Real>
void add_svk(std::vector<Kernel>& kernels, const CubePointer& cube, const std::vector<int>& threads) {
  Elements elements(cube->setup);
  const RegionEdit edit = everything(elements);
  const auto direct = std::make_shared<NonlinearRegion<Real>>();
  direct->follow(elements, edit);
  add_region<Real>(kernels, "svk", cube, threads, direct, block_bytes<Real>, cube->svk);
  const auto stored = std::make_shared<StoredTerms<Real>>();
  stored->follow(elements, edit.left, edit.entered);
  add_region<Real>(kernels, "svk_stored", cube, threads, stored,
                   double(stored->bytes()) / cube->setup.mesh.tet_count(), cube->svk);
  elements.volume_penalty = cube_volume_penalty;
  const auto volume = std::make_shared<NonlinearRegion<Real>>();
  volume->follow(elements, edit);
  add_region<Real>(kernels, "svk_volume", cube, threads, volume, block_bytes<Real>, cube->svk_volume);
  elements.volume_penalty = 0;
  elements.materials[0].nodal_pressure = 1;
  const auto averaged = std::make_shared<NonlinearRegion<Real>>();
  averaged->follow(elements, edit);
  add_region<Real>(kernels, "svk_nodal_pressure", cube, threads, averaged,
                   block_bytes<Real> + 4 * sizeof(Index), cube->svk_nodal_pressure);
}

template <class Real>
void add_tensor_mass(std::vector<Kernel>& kernels, const CubePointer& cube, const std::vector<int>& threads) {
  Elements elements(cube->setup);
  std::fill(elements.region_of.begin(), elements.region_of.end(), RegionModel::tensor_mass);
  const auto region = std::make_shared<TensorMassRegion<Real>>();
  region->follow(elements, everything(elements));
  const double bytes = double(region->edge_count()) * sizeof(EdgeBlock<Real>) / EdgeBlock<Real>::width;
  add_region<Real>(kernels, "tensor_mass", cube, threads, region, bytes / cube->setup.mesh.tet_count(),
                   cube->linear);
}

// A whole step of a World, which moves it by almost nothing. From rest, the force is mass × v / Δt; that on
// held vertices does not show and is left out.
template <class Real>
void add_step(std::vector<Kernel>& kernels, const CubePointer& cube, const std::vector<int>& threads) {
  auto expected = std::make_shared<Mat3X<double>>(cube->svk);
  std::vector<double> mass(std::size_t(cube->u.cols()), 0);
  for (const ReferenceTet& tet : cube->reference)
    for (Index v : tet.corners) mass[v] += tet.corner_mass;
  for (const PrescribedVertex& held : cube->setup.prescribed) {
    mass[held.vertex] = 0;
    expected->col(held.vertex).setZero();
  }
  for (int n : threads) {
    const auto world = std::make_shared<World<Real>>(cube->setup, n);
    const double dt = 1e-4 * world->time_step_limit();
    State<Real> state = world->state();
    state.u = cube->u.cast<Real>();
    world->set_state(state);
    Kernel kernel{"step", precision_name<Real>, n, block_bytes<Real>, {}, {}, expected};
    kernel.evaluate = [world, dt] { world->step(dt); };
    kernel.forces = [world, mass, dt] {
      Mat3X<double> f = world->state().v.template cast<double>() / dt;
      for (Index v = 0; v < f.cols(); ++v) f.col(v) *= mass[v];
      return f;
    };
    kernels.push_back(std::move(kernel));
  }
}

}  // namespace

Setup cube_setup(int tets) {
  const int cells = std::max(1, static_cast<int>(std::lround(std::cbrt(tets / 6.0))));
  Setup setup;
  setup.mesh = box_mesh(Vec3d::Constant(cube_edge), cells, cells, cells);
  setup.materials = {Elastic{}};
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

Cube::Cube(int tets) : setup(cube_setup(tets)) {
  const Index n = setup.mesh.vertex_count();
  const double cell = cube_edge / std::cbrt(setup.mesh.tet_count() / 6.0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> move(-0.1 * cell, 0.1 * cell);
  u.resize(3, n);
  for (double& component : u.reshaped()) component = static_cast<float>(move(random));
  for (PrescribedVertex& held : setup.prescribed) held.displacement = u.col(held.vertex);
  setup.ramp = 0;  // held where the displacement has them
  reference = reference_tets(setup);
  svk = linear = svk_nodal_pressure = Mat3X<double>::Zero(3, n);
  add_reference_forces(reference, u, svk);
  add_reference_linear_forces(reference, u, linear);
  add_reference_nodal_pressure_forces(reference, u, svk_nodal_pressure);
  svk_volume = svk;
  add_reference_volume_forces(reference, setup.mesh.points + u, cube_volume_penalty, svk_volume);
}

std::vector<Kernel> make_kernels(const CubePointer& cube, const std::vector<int>& threads) {
  std::vector<Kernel> kernels{reference_kernel(cube)};
  add_svk<float>(kernels, cube, threads);
  add_svk<double>(kernels, cube, threads);
  add_tensor_mass<float>(kernels, cube, threads);
  add_tensor_mass<double>(kernels, cube, threads);
  add_step<float>(kernels, cube, threads);
  add_step<double>(kernels, cube, threads);
  return kernels;
}

double deviation(const Kernel& kernel) {
  kernel.evaluate();
  return (kernel.forces() - *kernel.expected).cwiseAbs().maxCoeff() / kernel.expected->cwiseAbs().maxCoeff();
}

double allowed_deviation(const Kernel& kernel) { return kernel.precision == "double" ? 1e-11 : 1e-5; }

}  // namespace lobe::bench
