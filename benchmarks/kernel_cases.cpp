#include "benchmarks/kernel_cases.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>

#include "benchmarks/machine.h"
#include "benchmarks/roofline.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/sim/world.h"
#include "lobe/solve/tangent.h"
#include "paper/stored_terms.h"

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

using SpecimenPointer = std::shared_ptr<const Specimen>;

std::shared_ptr<const Mat3X<double>> part_of(const SpecimenPointer& specimen, const Mat3X<double>& forces) {
  return {specimen, &forces};
}

Kernel reference_kernel(const SpecimenPointer& specimen) {
  const auto f = std::make_shared<Mat3X<double>>(Mat3X<double>::Zero(3, specimen->u.cols()));
  Kernel kernel{"reference", "double", 1, sizeof(ReferenceTet), {}, {}, part_of(specimen, specimen->svk)};
  kernel.evaluate = [specimen, f] {
    f->setZero();
    add_reference_forces(specimen->reference, specimen->u, *f);
  };
  kernel.forces = [f] { return *f; };
  return kernel;
}

// One region's forces on all vertices; the region is built once for all numbers of threads.
template <class Real, class Region>
void add_region(std::vector<Kernel>& kernels, const std::string& name, const SpecimenPointer& specimen,
                const std::vector<int>& threads, const std::shared_ptr<Region>& region, double bytes_per_tet,
                const Mat3X<double>& expected) {
  struct Data {
    Mat3X<Real> u, f;
  };
  const auto data = std::make_shared<Data>(Data{specimen->u.cast<Real>(), specimen->u.cast<Real>()});
  for (int n : threads) {
    const auto parallel = std::make_shared<Parallel>(n);
    Kernel kernel{name, precision_name<Real>, n, bytes_per_tet, {}, {}, part_of(specimen, expected)};
    kernel.evaluate = [region, data, parallel] {
      data->f.setZero();
      region->add_forces(data->u, data->f, *parallel);
    };
    kernel.forces = [data] { return Mat3X<double>(data->f.template cast<double>()); };
    kernels.push_back(std::move(kernel));
  }
}

template <class Real>
constexpr double edge_bytes = double(sizeof(EdgeBlock<Real>)) / EdgeBlock<Real>::width;
template <class Real>
constexpr double block_bytes = double(sizeof(ElementBlock<Real>)) / ElementBlock<Real>::width;

template <class Real>
void add_svk(std::vector<Kernel>& kernels, const SpecimenPointer& specimen, const std::vector<int>& threads) {
  Elements elements(specimen->setup);
  const RegionEdit edit = everything(elements);
  const auto direct = std::make_shared<NonlinearRegion<Real>>();
  direct->follow(elements, edit);
  add_region<Real>(kernels, "svk", specimen, threads, direct, block_bytes<Real>, specimen->svk);
  const auto stored = std::make_shared<StoredTerms<Real>>();
  stored->follow(elements, edit.left, edit.entered);
  add_region<Real>(kernels, "svk_stored", specimen, threads, stored,
                   double(stored->bytes()) / specimen->setup.mesh.tet_count(), specimen->svk);
  elements.volume_penalty = volume_penalty;
  const auto volume = std::make_shared<NonlinearRegion<Real>>();
  volume->follow(elements, edit);
  add_region<Real>(kernels, "svk_volume", specimen, threads, volume, block_bytes<Real>, specimen->svk_volume);
  elements.volume_penalty = 0;
  elements.guard_below = 0.2;
  const auto guarded = std::make_shared<NonlinearRegion<Real>>();
  guarded->follow(elements, edit);
  add_region<Real>(kernels, "svk_guard", specimen, threads, guarded, block_bytes<Real>, specimen->svk);
  elements.guard_below = 0;
  elements.materials[0].nodal_pressure = 1;
  const auto averaged = std::make_shared<NonlinearRegion<Real>>();
  averaged->follow(elements, edit);
  add_region<Real>(kernels, "svk_nodal_pressure", specimen, threads, averaged,
                   block_bytes<Real> + 4 * sizeof(Index), specimen->svk_nodal_pressure);
}

// In no time: dashpots are read and written as in a step, and stay where they are.
template <class Real>
void add_viscous(std::vector<Kernel>& kernels, const SpecimenPointer& specimen,
                 const std::vector<int>& threads) {
  Elements elements(specimen->setup);
  const RegionEdit edit = everything(elements);
  elements.materials[0].viscosity = {prony_terms[0], prony_terms[1]};
  for (const bool is_smoothed : {false, true}) {
    if (is_smoothed) elements.materials[0].element = ElementType::edge_smoothed;
    const auto region = std::make_shared<NonlinearRegion<Real>>();
    region->follow(elements, edit);
    double bytes = block_bytes<Real>;
    region->visit_viscous([&](auto& patches) {
      patches.viscosity().set_step({.follows = true});
      if constexpr (requires { patches.bytes(); })
        if (is_smoothed) bytes = double(patches.bytes()) / elements.topology.tet_count();
    });
    std::vector<Real> dashpots;
    region->visit_viscous([&](const auto& patches) { patches.save(dashpots); });
    bytes += double(dashpots.size() * sizeof(Real)) / elements.topology.tet_count();
    add_region<Real>(kernels, is_smoothed ? "svk_smoothed_prony" : "svk_prony", specimen, threads, region,
                     bytes, is_smoothed ? specimen->svk_smoothed_prony : specimen->svk_prony);
  }
}

// Edge-smoothed tetrahedra, alone and with nodal pressure.
template <class Real>
void add_smoothed(std::vector<Kernel>& kernels, const SpecimenPointer& specimen,
                  const std::vector<int>& threads) {
  Elements elements(specimen->setup);
  const RegionEdit edit = everything(elements);
  elements.materials[0].element = ElementType::edge_smoothed;
  const auto add = [&](const char* name, const Mat3X<double>& expected) {
    const auto patches = std::make_shared<SmoothedPatches<Real>>();
    patches->follow(elements, edit.left, edit.entered);
    add_region<Real>(kernels, name, specimen, threads, patches,
                     double(patches->bytes()) / elements.topology.tet_count(), expected);
  };
  add("svk_smoothed", specimen->svk_smoothed);
  elements.volume_penalty = volume_penalty;
  add("svk_smoothed_volume", specimen->svk_smoothed_volume);
  elements.volume_penalty = 0;
  elements.materials[0].nodal_pressure = 1;
  add("svk_smoothed_pressure", specimen->svk_smoothed_pressure);
}

std::array<Vec3d, 2> holzapfel_families() {
  const Vec3d plane(holzapfel_plane.data()), m = fibre_direction, n = (plane - plane.dot(m) * m).normalized();
  const double c = std::cos(holzapfel_angle), s = std::sin(holzapfel_angle);
  return {c * m + s * n, c * m - s * n};
}

template <class Real>
void add_other_laws(std::vector<Kernel>& kernels, const SpecimenPointer& specimen,
                    const std::vector<int>& threads) {
  Elements elements(specimen->setup);
  const RegionEdit edit = everything(elements);
  elements.materials[0].fibre = fibre_moduli;
  elements.fibres = fibre_direction.replicate(1, elements.topology.tet_count());
  const auto fibrous = std::make_shared<NonlinearRegion<Real>>();
  fibrous->follow(elements, edit);
  add_region<Real>(kernels, "svk_fibre", specimen, threads, fibrous, block_bytes<Real> + 3 * sizeof(Real),
                   specimen->svk_fibre);
  elements.materials[0].fibre = {};
  elements.materials[0].law = MaterialLaw::neo_hookean;
  const auto neo_hookean = std::make_shared<NonlinearRegion<Real>>();
  neo_hookean->follow(elements, edit);
  add_region<Real>(kernels, "neo_hookean", specimen, threads, neo_hookean, block_bytes<Real>,
                   specimen->neo_hookean);
  elements.materials[0].law = MaterialLaw::yeoh;
  elements.materials[0].further = yeoh_moduli;
  const auto yeoh = std::make_shared<NonlinearRegion<Real>>();
  yeoh->follow(elements, edit);
  add_region<Real>(kernels, "yeoh", specimen, threads, yeoh, block_bytes<Real>, specimen->yeoh);
  elements.materials[0].law = MaterialLaw::mooney_rivlin;
  elements.materials[0].further = {mooney_c01, 0};
  const auto mooney_rivlin = std::make_shared<NonlinearRegion<Real>>();
  mooney_rivlin->follow(elements, edit);
  add_region<Real>(kernels, "mooney_rivlin", specimen, threads, mooney_rivlin, block_bytes<Real>,
                   specimen->mooney_rivlin);
  elements.materials[0].law = MaterialLaw::holzapfel;
  elements.materials[0].further = holzapfel_constants;
  elements.materials[0].fibre_angle = holzapfel_angle;
  elements.materials[0].fibre_plane = holzapfel_plane;
  const auto holzapfel = std::make_shared<NonlinearRegion<Real>>();
  holzapfel->follow(elements, edit);
  add_region<Real>(kernels, "holzapfel", specimen, threads, holzapfel, block_bytes<Real> + 3 * sizeof(Real),
                   specimen->holzapfel);
}

template <class Real>
void add_tensor_mass(std::vector<Kernel>& kernels, const SpecimenPointer& specimen,
                     const std::vector<int>& threads) {
  Elements elements(specimen->setup);
  std::fill(elements.region_of.begin(), elements.region_of.end(), RegionModel::tensor_mass);
  const auto region = std::make_shared<TensorMassRegion<Real>>();
  region->follow(elements, everything(elements));
  const double bytes = double(region->edge_count()) * edge_bytes<Real>;
  add_region<Real>(kernels, "tensor_mass", specimen, threads, region,
                   bytes / specimen->setup.mesh.tet_count(), specimen->linear);
  elements.materials[0].element = ElementType::edge_smoothed;
  const auto smoothed = std::make_shared<SmoothedPatches<Real>>(chosen_instruction_set(), Strain::small);
  const RegionEdit edit = everything(elements);
  smoothed->follow(elements, edit.left, edit.entered, RegionModel::tensor_mass);
  add_region<Real>(kernels, "tensor_mass_smoothed", specimen, threads, smoothed,
                   double(smoothed->bytes()) / elements.topology.tet_count(), specimen->linear_smoothed);
}

template <class Real>
void add_corotational(std::vector<Kernel>& kernels, const SpecimenPointer& specimen,
                      const std::vector<int>& threads) {
  Elements elements(specimen->setup);
  std::fill(elements.region_of.begin(), elements.region_of.end(), RegionModel::corotational);
  const auto region = std::make_shared<CorotationalRegion<Real>>();
  region->follow(elements, everything(elements));
  add_region<Real>(kernels, "corotational", specimen, threads, region, block_bytes<Real>,
                   specimen->corotational);
  elements.materials[0].element = ElementType::edge_smoothed;
  const auto smoothed = std::make_shared<SmoothedPatches<Real>>();
  const RegionEdit edit = everything(elements);
  smoothed->follow(elements, edit.left, edit.entered, RegionModel::corotational);
  add_region<Real>(kernels, "corotational_smoothed", specimen, threads, smoothed,
                   double(smoothed->bytes()) / elements.topology.tet_count(),
                   specimen->corotational_smoothed);
}

// A whole step of a World, which moves it by almost nothing. From rest, the force is mass × v / Δt; that on
// held vertices does not show and is left out.
template <class Real>
void add_step(std::vector<Kernel>& kernels, const SpecimenPointer& specimen,
              const std::vector<int>& threads) {
  auto expected = std::make_shared<Mat3X<double>>(specimen->svk);
  std::vector<double> mass(std::size_t(specimen->u.cols()), 0);
  for (const ReferenceTet& tet : specimen->reference)
    for (Index v : tet.corners) mass[v] += tet.corner_mass;
  for (const PrescribedVertex& held : specimen->setup.prescribed) {
    mass[held.vertex] = 0;
    expected->col(held.vertex).setZero();
  }
  for (int n : threads) {
    const double before = resident_bytes();
    const auto world = std::make_shared<World<Real>>(specimen->setup, n);
    const double bytes = resident_bytes() - before;
    const double dt = 1e-4 * world->time_step_limit();
    State<Real> state = world->state();
    state.u = specimen->u.cast<Real>();
    state.velocity_lag = dt / 2;
    world->set_state(state);
    Kernel kernel{"step", precision_name<Real>, n, block_bytes<Real>, {}, {}, expected};
    kernel.evaluate = [world, dt] { world->step(dt); };
    kernel.forces = [world, mass, dt] {
      Mat3X<double> f = world->state().v.template cast<double>() / dt;
      for (Index v = 0; v < f.cols(); ++v) f.col(v) *= mass[v];
      return f;
    };
    kernel.world_bytes_per_tet = std::max(0.0, bytes) / specimen->setup.mesh.tet_count();
    kernels.push_back(std::move(kernel));
  }
}

Setup whole_body(const TetMesh& mesh) {
  Setup setup;
  setup.mesh = mesh;
  setup.materials = {Elastic{}};
  setup.material_of.assign(std::size_t(mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  return setup;
}

double flops_per_tet(const Kernel& kernel) {
  if (kernel.name == "svk" || kernel.name == "step") return flops_svk();
  if (kernel.name == "svk_volume") return flops_svk_volume();
  if (kernel.name != "tensor_mass") return 0;
  const double edge = kernel.precision == "single" ? edge_bytes<float> : edge_bytes<double>;
  return flops_tensor_mass_edge() * kernel.bytes_per_tet / edge;
}

// Those of the solvers [N].
Mat3X<double> smoothed_forces(Setup setup, RegionModel model, const Mat3X<double>& u) {
  setup.materials[0].element = ElementType::edge_smoothed;
  std::fill(setup.region_of.begin(), setup.region_of.end(), model);
  return energy_and_forces(Elements(setup), u).forces;
}

}  // namespace

Setup cube_setup(int tets) {
  const int cells = std::max(1, static_cast<int>(std::lround(std::cbrt(tets / 6.0))));
  Setup setup = whole_body(box_mesh(Vec3d::Constant(cube_edge), cells, cells, cells));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

Setup shuffled(const Setup& setup) {
  const Index vertices = setup.mesh.vertex_count(), tets = setup.mesh.tet_count();
  std::vector<Index> place(static_cast<std::size_t>(vertices)), order(static_cast<std::size_t>(tets));
  std::iota(place.begin(), place.end(), 0);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(2);
  std::shuffle(place.begin(), place.end(), random);
  std::shuffle(order.begin(), order.end(), random);
  Setup result = setup;
  for (Index v = 0; v < vertices; ++v) result.mesh.points.col(place[v]) = setup.mesh.points.col(v);
  for (Index t = 0; t < tets; ++t)
    for (int c = 0; c < 4; ++c) result.mesh.tets(c, t) = place[setup.mesh.tets(c, order[t])];
  for (PrescribedVertex& held : result.prescribed) held.vertex = place[held.vertex];
  return result;
}

Setup organ_setup(const TetMesh& mesh) {
  Setup setup = whole_body(mesh);
  const auto x = setup.mesh.points.row(0);
  const double held_below = x.minCoeff() + 0.05 * (x.maxCoeff() - x.minCoeff());
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (x[v] < held_below) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

Setup liver_setup() {
  return organ_setup(read_mesh(std::filesystem::path(LOBE_DATA_DIR) / "meshes/liver_10k.vtu").mesh);
}

void give(RegionModel model, Setup& setup) {
  const auto x = setup.mesh.points.row(0);
  const double end = x.minCoeff() + 0.8 * (x.maxCoeff() - x.minCoeff());
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const bool beyond = model == RegionModel::precomputed && barycentre(setup.mesh, t).x() > end;
    setup.region_of[std::size_t(t)] = beyond ? RegionModel::nonlinear : model;
  }
}

Specimen::Specimen(std::string mesh_name, const Setup& body) : mesh(std::move(mesh_name)), setup(body) {
  const Index n = setup.mesh.vertex_count();
  const double cell = std::cbrt(6 * total_volume(setup.mesh) / setup.mesh.tet_count());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> move(-0.1 * cell, 0.1 * cell);
  u.resize(3, n);
  for (double& component : u.reshaped()) component = static_cast<float>(move(random));
  for (PrescribedVertex& held : setup.prescribed) held.displacement = u.col(held.vertex);
  setup.ramp = 0;  // held where the displacement has them
  reference = reference_tets(setup);
  svk = linear = svk_nodal_pressure = svk_smoothed = svk_smoothed_pressure = neo_hookean = yeoh =
      mooney_rivlin = holzapfel = corotational = Mat3X<double>::Zero(3, n);
  add_reference_forces(reference, u, svk);
  add_reference_linear_forces(reference, u, linear);
  add_reference_nodal_pressure_forces(reference, u, svk_nodal_pressure);
  add_reference_smoothed_forces(reference, u, false, svk_smoothed);
  add_reference_smoothed_forces(reference, u, true, svk_smoothed_pressure);
  linear_smoothed = smoothed_forces(setup, RegionModel::tensor_mass, u);
  corotational_smoothed = smoothed_forces(setup, RegionModel::corotational, u);
  svk_smoothed_volume = svk_smoothed;
  add_reference_volume_forces(reference, setup.mesh.points + u, volume_penalty, svk_smoothed_volume);
  svk_volume = svk;
  add_reference_volume_forces(reference, setup.mesh.points + u, volume_penalty, svk_volume);
  svk_prony = 2 * svk;
  svk_smoothed_prony = 2 * svk_smoothed;
  svk_fibre = svk;
  add_reference_fibre_forces(reference, u, fibre_moduli, fibre_direction, svk_fibre);
  add_reference_neo_hookean_forces(reference, u, neo_hookean);
  add_reference_yeoh_forces(reference, u, yeoh_moduli, yeoh);
  add_reference_mooney_rivlin_forces(reference, u, mooney_c01, mooney_rivlin);
  add_reference_holzapfel_forces(reference, u, holzapfel_constants, holzapfel_families(), holzapfel);
  add_reference_corotational_forces(reference, u, corotational);
}

std::vector<Kernel> make_kernels(const SpecimenPointer& specimen, const std::vector<int>& threads) {
  std::vector<Kernel> kernels{reference_kernel(specimen)};
  add_svk<float>(kernels, specimen, threads);
  add_svk<double>(kernels, specimen, threads);
  add_smoothed<float>(kernels, specimen, threads);
  add_smoothed<double>(kernels, specimen, threads);
  add_viscous<float>(kernels, specimen, threads);
  add_viscous<double>(kernels, specimen, threads);
  add_other_laws<float>(kernels, specimen, threads);
  add_other_laws<double>(kernels, specimen, threads);
  add_tensor_mass<float>(kernels, specimen, threads);
  add_tensor_mass<double>(kernels, specimen, threads);
  add_corotational<float>(kernels, specimen, threads);
  add_corotational<double>(kernels, specimen, threads);
  add_step<float>(kernels, specimen, threads);
  add_step<double>(kernels, specimen, threads);
  for (Kernel& kernel : kernels) kernel.flops_per_tet = flops_per_tet(kernel);
  return kernels;
}

double deviation(const Kernel& kernel) {
  kernel.evaluate();
  return (kernel.forces() - *kernel.expected).cwiseAbs().maxCoeff() / kernel.expected->cwiseAbs().maxCoeff();
}

double allowed_deviation(const Kernel& kernel) { return kernel.precision == "double" ? 1e-11 : 1e-5; }

}  // namespace lobe::bench
