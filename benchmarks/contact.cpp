// lobe bench contact: what contact costs per step, where it is far and where it touches, what it does to the
// time step limit, and how deep a probe goes in at a given pressure.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <memory>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "benchmarks/timing.h"
#include "lobe/contact/contact.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/numerics/lanczos.h"
#include "lobe/sim/world.h"

namespace lobe::bench {
namespace {

constexpr double radius = 0.012, depth = 0.004;  // of the probe [m]

struct ContactRow {
  std::string mesh, what;
  Index tets = 0;
  int touched = 0;             // vertices that feel contact
  double step_us = 0;          // of processor time
  double cost = 0;             // share of the step of the same body without contact
  double limit = 1;            // time step limit over that without contact, by Lanczos iterations
  double force = 0;            // on the probe [N]
  double depth_at_10_kPa = 0;  // κ alone, the median over the surface [m]
};

Setup organ(const TetMesh& mesh) {
  Setup setup;
  setup.mesh = mesh;
  setup.materials = {{4e4, 1e4, 1000}};
  setup.material_of.assign(std::size_t(mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  const double middle = (mesh.points.row(1).minCoeff() + mesh.points.row(1).maxCoeff()) / 2;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(1, v) > middle + 0.02) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.damping = 15;
  return setup;
}

// Where it is lowest in y, a ball comes from there.
ProbeSetup ball(const TetMesh& mesh, double gap, double friction) {
  Index lowest;
  mesh.points.row(1).minCoeff(&lowest);
  const Vec3d centre = mesh.points.col(lowest) - Vec3d(0, radius + gap, 0);
  std::vector<PathPoint> path{{0, centre - Vec3d(0, std::max(0.0, -gap), 0)}, {0.2, centre}};
  for (int i = 0; i < 400; ++i)  // rubs to and fro
    path.push_back({0.2 + 0.05 * (i + 1), centre + Vec3d(i % 2 ? 0.001 : -0.001, 0, 0)});
  return {"ball", RigidShape::sphere(radius), friction, path};
}

// 2/ω_max about the present state, of the regions and, if wanted, contact [s].
template <class Real>
double limit_of(World<Real>& world, bool with_contact) {
  Dynamics<Real>& body = world.body();
  const Mat3X<Real> at = body.motion.u.view();
  const Mat3X<Real> still = Mat3X<Real>::Zero(3, at.cols());
  const auto forces = [&](const Mat3X<Real>& u, Mat3X<Real>& f) {
    body.regions.add_forces_near(u, 0, f, body.parallel);
    if (!with_contact) return;
    for (const auto& term : body.terms) term->add_forces({body.model, u, still, body.motion.time}, f);
  };
  body.regions.invalidate_sums();
  Mat3X<Real> there = Mat3X<Real>::Zero(3, at.cols());
  forces(at, there);
  const HighestFrequency found = highest_frequency<Real>(
      body.inertia.inverse_mass(), [&](Index v) { return world.step_limit().bounded_square(v); }, 1e-7,
      [&](const Mat3X<Real>& u, Mat3X<Real>& f) {
        f -= there;
        forces(Mat3X<Real>(at + u), f);
      },
      {.tolerance = 0.001, .most = 120});
  body.regions.invalidate_sums();
  return 2 / found.omega;
}

struct ContactCase {
  const char* what;
  std::function<void(Setup&)> ask;
  bool has_slit = false;
};

// Its tetrahedra left and right of its middle share no vertices within a ball of a fifth of its length: a
// slit, whose lips lie on each other.
TetMesh with_slit(TetMesh mesh) {
  const Vec3d low = mesh.points.rowwise().minCoeff(), high = mesh.points.rowwise().maxCoeff();
  const Vec3d middle = (low + high) / 2;
  const auto is_right = [&](Index t) {
    return mesh.points(Eigen::all, mesh.tets.col(t)).row(0).mean() > middle[0];
  };
  std::vector<bool> is_of_left(std::size_t(mesh.vertex_count()), false);
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (!is_right(t))
      for (Index v : mesh.tets.col(t)) is_of_left[std::size_t(v)] = true;
  std::vector<Index> copy_of(is_of_left.size(), -1);
  std::vector<Vec3d> copies;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if (!is_right(t)) continue;
    for (Index& v : mesh.tets.col(t)) {
      if (!is_of_left[std::size_t(v)] || (mesh.points.col(v) - middle).norm() > (high - low)[0] / 5) continue;
      Index& copy = copy_of[std::size_t(v)];
      if (copy < 0) {
        copy = mesh.vertex_count() + static_cast<Index>(copies.size());
        copies.emplace_back(mesh.points.col(v));
      }
      v = copy;
    }
  }
  mesh.points.conservativeResize(3, mesh.vertex_count() + static_cast<Index>(copies.size()));
  for (std::size_t i = 0; i < copies.size(); ++i)
    mesh.points.col(mesh.vertex_count() - Index(copies.size() - i)) = copies[i];
  return mesh;
}

// By its weight, and for ever.
void swing(Setup& setup) {
  setup.gravity = {0, -9.81, 0};
  setup.damping = 0;
}

std::vector<ContactCase> cases() {
  return {{"none", [](Setup&) {}},
          {"also none", [](Setup&) {}},  // what the measurement itself is off by
          {"far probe", [](Setup& s) { s.probes.push_back(ball(s.mesh, 0.2, 0.1)); }},
          {"near probe", [](Setup& s) { s.probes.push_back(ball(s.mesh, 0.003, 0.1)); }},
          {"touching", [](Setup& s) { s.probes.push_back(ball(s.mesh, -depth, 0)); }},
          {"touching with friction", [](Setup& s) { s.probes.push_back(ball(s.mesh, -depth, 0.1)); }},
          {"self without touch", [](Setup& s) { s.contact.self = true; }},
          {"none while swinging", swing},
          {"self while swinging",
           [](Setup& s) {
             swing(s);
             s.contact.self = true;
           }},
          {"none with a slit while swinging", swing, true},
          {"self with a slit while swinging",
           [](Setup& s) {
             swing(s);
             s.contact.self = true;
           },
           true}};
}

void check(World<double>& world, const ContactCase& contact_case, ContactRow& row) {
  for (int i = 0; i < 25; ++i)
    if (!world.advance(0.02).ok)
      throw WrongResult(std::string(contact_case.what) + ": the run did not go well");
  if (!world.tools().lists().probes.empty()) row.force = world.tools().lists().probes.front().force.norm();
  if (world.body().terms.empty()) return;
  DiagonalStiffness K = DiagonalStiffness::Zero(6, world.elements().topology.vertex_count());
  world.body().terms.front()->add_diagonal_stiffness(world.body().here(), K);
  row.touched = static_cast<int>((K.colwise().squaredNorm().array() > 0).count());
  row.limit = limit_of(world, true) / limit_of(world, false);
  const auto& contact = dynamic_cast<const Contact<double>&>(*world.body().terms.front());
  std::vector<double> depths;
  for (const ContactSurface::Triangle& t : contact.surface().triangles()) depths.push_back(1e4 / t.stiffness);
  std::nth_element(depths.begin(), depths.begin() + long(depths.size() / 2), depths.end());
  row.depth_at_10_kPa = depths[depths.size() / 2];
}

// One of several worlds of the same kind, which lie at different places of the memory: that alone changes the
// time of a step by some per cent.
struct Runner {
  std::shared_ptr<World<float>> world;
  std::shared_ptr<double> steps = std::make_shared<double>(0), frames = std::make_shared<double>(0);

  explicit Runner(const Setup& setup) : world(std::make_shared<World<float>>(setup)) {
    for (int i = 0; i < 25; ++i) world->advance(0.02);
  }
  Timed timed() const {
    return {[*this] {
      *steps += world->advance(1.0 / 60).steps;
      ++*frames;
    }};
  }
};

constexpr int copies = 5;  // of each world

std::vector<ContactRow> measure(const std::string& name, const TetMesh& mesh, const Sampling& sampling) {
  const std::vector<ContactCase> all = cases();
  std::vector<ContactRow> rows;
  for (const ContactCase& contact_case : all) {
    Setup setup = organ(contact_case.has_slit ? with_slit(mesh) : mesh);
    contact_case.ask(setup);
    ContactRow row{name, contact_case.what, mesh.tet_count()};
    World<double> exact(setup);
    check(exact, contact_case, row);
    rows.push_back(row);
  }
  std::vector<Runner> runners;  // all cases once, then again
  std::vector<Timed> timed;
  for (int copy = 0; copy < copies; ++copy)
    for (const ContactCase& contact_case : all) {
      Setup setup = organ(contact_case.has_slit ? with_slit(mesh) : mesh);
      contact_case.ask(setup);
      timed.push_back(runners.emplace_back(setup).timed());
    }
  const auto samples = sample_rounds(timed, sampling);
  const auto step_of = [&](int copy, std::size_t what, int round) {
    const std::size_t i = std::size_t(copy) * all.size() + what;
    return samples[i][std::size_t(round)] * *runners[i].frames / *runners[i].steps;
  };
  std::size_t bare = 0;
  for (std::size_t what = 0; what < rows.size(); ++what) {
    if (std::string(all[what].what).starts_with("none")) bare = what;
    std::vector<double> steps, costs;  // costs: against the same body without contact
    for (int copy = 0; copy < copies; ++copy)
      for (int round = 0; round < sampling.rounds; ++round) {
        steps.push_back(step_of(copy, what, round));
        costs.push_back(steps.back() / step_of(copy, bare, round) - 1);
      }
    std::sort(steps.begin(), steps.end());
    std::sort(costs.begin(), costs.end());
    rows[what].step_us = 1e6 * median(steps);
    rows[what].cost = median(costs);
  }
  return rows;
}

void print(const ContactRow& r) {
  std::printf("%-10s %-30s %8d %8d %9.1f %8.1f%% %8.4f %8.3f %9.2f\n", r.mesh.c_str(), r.what.c_str(), r.tets,
              r.touched, r.step_us, 100 * r.cost, r.limit, r.force, 1e3 * r.depth_at_10_kPa);
}

std::string csv(const std::vector<ContactRow>& rows) {
  std::ostringstream out;
  out << "mesh,contact,tets,touched_vertices,step_us,cost,limit,force_N,depth_at_10_kPa_mm\n"
      << std::setprecision(4);
  for (const ContactRow& r : rows)
    out << r.mesh << ',' << r.what << ',' << r.tets << ',' << r.touched << ',' << r.step_us << ',' << r.cost
        << ',' << r.limit << ',' << r.force << ',' << 1e3 * r.depth_at_10_kPa << '\n';
  return out.str();
}

}  // namespace

void bench_contact(const Options& options) {
  begin_results(options.output, "contact");
  std::printf("\n%-10s %-30s %8s %8s %9s %9s %8s %8s %9s\n", "mesh", "contact", "tets", "touched", "step us",
              "cost", "limit", "force N", "mm/10kPa");
  const std::filesystem::path meshes = std::filesystem::path(LOBE_DATA_DIR) / "meshes";
  std::vector<ContactRow> rows;
  std::vector<const char*> names{"liver_2k"};
  if (!options.quick) names.push_back("liver_10k");
  for (const char* name : names)
    for (const ContactRow& row : measure(name, read_mesh(meshes / (std::string(name) + ".vtu")).mesh,
                                         {.rounds = options.quick ? 3 : 15, .seconds = 0.03}))
      print(rows.emplace_back(row));
  io::write_file(options.output / "contact.csv", csv(rows));
}

}  // namespace lobe::bench
