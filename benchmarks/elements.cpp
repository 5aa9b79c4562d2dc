// lobe bench elements: how far each element is off on one mesh, and what it costs in motion. The truth is
// that of 10-node tetrahedra with the same body held.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iomanip>
#include <memory>
#include <numeric>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/element_frequency.h"
#include "benchmarks/machine.h"
#include "benchmarks/timing.h"
#include "benchmarks/validation/bodies.h"
#include "lobe/diagnostics/compare.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/refine.h"
#include "lobe/numerics/supernodal_factor.h"
#include "lobe/scene/material_constants.h"
#include "lobe/sim/world.h"
#include "lobe/solve/quadratic_solver.h"
#include "lobe/sort_unique.h"

namespace lobe::bench {
namespace {

struct Element {
  const char* name;
  ElementType type;
  double nodal_pressure;
  double condensed_share = 0;  // of the volume, of that with the smallest x, where the bodies are held
};
// The first is what the others are compared with.
constexpr Element compared_elements[] = {{"plain", ElementType::tetrahedron, 0},
                                         {"plain with nodal_pressure", ElementType::tetrahedron, 1},
                                         {"edge-smoothed", ElementType::edge_smoothed, 0},
                                         {"edge-smoothed with nodal_pressure", ElementType::edge_smoothed, 1},
                                         {"plain hybrid", ElementType::tetrahedron, 0, 0.6},
                                         {"edge-smoothed hybrid", ElementType::edge_smoothed, 0, 0.6}};

// The end of a gesture, on any mesh of the body.
struct Deed {
  const char* name;
  std::function<Setup(const TetMesh&)> on;
};

struct ElementBody {
  std::string name;
  TetMesh mesh;
  std::vector<Deed> deeds;  // the first is played in motion
  int refined = 0;          // how often the mesh of the truth is
};

struct ElementRow {
  std::string body;
  Index tets = 0;
  std::string gesture;
  const Element* element = nullptr;
  double error = 0;               // relative: L2 of displacements by mass, or of the frequency, with its sign
  double largest = 0, force = 0;  // by how much the largest displacement and the grip force are too large
  double step = 0, time = 0;      // stable step at rest, processor time in motion, over those of plain ones
};

Setup of_element(Setup setup, const Element& element) {
  for (Elastic& material : setup.materials) {
    material.element = element.type;
    material.nodal_pressure = element.nodal_pressure;
  }
  std::vector<Index> order(setup.region_of.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return barycentre(setup.mesh, a).x() < barycentre(setup.mesh, b).x(); });
  double left = element.condensed_share * total_volume(setup.mesh);
  for (Index t : order)
    if ((left -= signed_volume(tet_points(setup.mesh, t))) > 0) setup.region_of[t] = RegionModel::precomputed;
  return setup;
}

// ---- Bodies

// The vertices of the tetrahedra that lie within, so that what is held is a body.
std::vector<Index> of_tets_within(const TetMesh& mesh, const validation::Condition& is_inside) {
  std::vector<Index> vertices;
  for (const auto& tet : mesh.tets.colwise()) {
    bool within = true;
    for (const Index v : tet) within = within && is_inside(mesh.points.col(v));
    if (within) vertices.insert(vertices.end(), tet.begin(), tet.end());
  }
  sort_unique(vertices);
  return vertices;
}

// The smallest ball around the place, of these radii, that has tetrahedra.
std::vector<Index> grasped_by(const TetMesh& mesh) {
  const Vec3d tip(0.082, -0.045, 0.035);
  for (const double radius : {0.02, 0.03})
    if (auto found = of_tets_within(mesh, [&](const Vec3d& X) { return (X - tip).norm() <= radius; });
        !found.empty())
      return found;
  throw WrongResult("elements: the mesh has no tetrahedron at the tip of the liver's left lobe");
}

Setup held_at_its_right(const TetMesh& mesh) {
  Setup setup = validation::body_of(mesh, {4e4, 1e4, 1000}, RegionModel::nonlinear);
  setup.volume_penalty = 1e5;
  setup.damping = 20;
  validation::prescribe(setup,
                        of_tets_within(mesh,
                                       [](const Vec3d& X) {
                                         return X.x() >= -0.12 && X.x() <= -0.02 && X.y() >= 0.015 &&
                                                X.y() <= 0.08 && std::abs(X.z()) <= 0.08;
                                       }),
                        [](const Vec3d&) { return Vec3d::Zero(); });
  return setup;
}

Setup pulled(const TetMesh& mesh, const Vec3d& by) {
  Setup setup = held_at_its_right(mesh);
  validation::prescribe(setup, grasped_by(mesh), [&](const Vec3d&) { return by; });
  return setup;
}

ElementBody liver_body(const std::filesystem::path& file) {
  const auto sagging = [](const TetMesh& mesh) {
    Setup setup = held_at_its_right(mesh);
    setup.gravity = {0, -9.81, 0};
    return setup;
  };
  return {file.stem().string(),
          read_mesh(file).mesh,
          {{"sag", sagging},
           {"lift",
            [](const TetMesh& mesh) {
              return pulled(mesh, {0.004, -0.004, 0.03});
            }},
           {"aside", [](const TetMesh& mesh) {
              return pulled(mesh, {0, 0.035, 0});
            }}}};
}

// 1,536 tetrahedra, bent by so little that it is linear.
ElementBody beam_body(double poisson, bool quick) {
  constexpr double length = 0.12, side = 0.03, cell = side / 4;
  const auto bent = [=](const TetMesh& mesh) {
    const LamePair lame = lame_from_young(28000, poisson);
    Setup setup = validation::body_of(mesh, {lame.lambda, lame.mu, 1000}, RegionModel::nonlinear);
    setup.damping = 20;
    validation::prescribe(setup,
                          validation::vertices_where(mesh, [](const Vec3d& X) { return X.x() < 1e-9; }),
                          [](const Vec3d&) { return Vec3d::Zero(); });
    validation::load_faces(
        setup, [](const Vec3d& X) { return X.x() > length - 1e-9; },
        [](const Vec3d&) { return Vec3d(0, 0, -1); });
    return setup;
  };
  std::ostringstream name;
  name << "beam of ν = " << poisson;
  return {name.str(),
          validation::jittered(box_mesh({length, side, side}, 16, 4, 4), cell, 0.2, 1, false),
          {{"bent", bent}},
          quick ? 0 : 1};
}

std::vector<ElementBody> element_bodies(const Options& options) {
  std::vector<ElementBody> bodies;
  for (const double poisson : {0.3, 0.49}) bodies.push_back(beam_body(poisson, options.quick));
  if (!options.quick)
    bodies.push_back(liver_body(std::filesystem::path(LOBE_DATA_DIR) / "meshes/liver_2k.vtu"));
  for (const std::filesystem::path& mesh : options.meshes) bodies.push_back(liver_body(mesh));
  return bodies;
}

// ---- Errors

Vec3d force_on_moved(const Mat3X<double>& reactions, const Mat3X<double>& prescribed) {
  Vec3d sum = Vec3d::Zero();
  for (Eigen::Index n = 0; n < reactions.cols(); ++n)
    if (!prescribed.col(n).isZero(0)) sum += reactions.col(n);
  return sum;
}

StaticResult checked(StaticResult result, const std::string& what) {
  if (!result.converged) throw WrongResult("elements: " + what + " has no equilibrium: " + result.reason);
  return result;
}

struct Truth {
  Mat3X<double> u;   // at the vertices of `mesh` [m]
  double force = 0;  // on what is moved [N]
  TetMesh mesh;
  std::function<Mat3X<double>(const Mat3X<double>&)> prolongate;  // from the body's mesh to that one
};

// From the solution of edge-smoothed tetrahedra on the same mesh, to a residual below which no figure of the
// table changes.
StaticResult solve_truth(const Setup& setup, const QuadraticMesh& nodes, const StaticEquations& equations) {
  StaticOptions options{.tolerance = 1e-7, .factor = make_supernodal};
  const StaticResult near =
      solve_static(of_element(setup, {"edge-smoothed", ElementType::edge_smoothed, 0, 0}), options);
  const Mat3X<double> start = nodes.joined_linearly(near.u);
  if (near.converged) options.start = &start;
  return solve_static_quadratic(setup, nodes, equations, options);
}

Truth truth_of(const ElementBody& body, const Deed& deed) {
  Truth truth;
  truth.mesh = body.mesh;
  truth.prolongate = [](const Mat3X<double>& u) { return u; };
  const auto refine_once = [&truth] {
    const auto fine = std::make_shared<RefinedMesh>(refine(truth.mesh));
    truth.mesh = fine->mesh;
    truth.prolongate = [fine, before = truth.prolongate](const Mat3X<double>& u) {
      return fine->prolongate(before(u));
    };
  };
  for (int i = 0; i < body.refined; ++i) refine_once();
  const Setup setup = deed.on(truth.mesh);
  const QuadraticMesh nodes(setup.mesh);
  const StaticEquations equations = quadratic_equations(setup, nodes);
  StaticResult solved = checked(solve_truth(setup, nodes, equations), body.name + " of quadratic tetrahedra");
  truth.force = force_on_moved(solved.reactions, equations.prescribed).norm();
  truth.u = std::move(solved.u);
  refine_once();  // its vertices are the nodes
  return truth;
}

double excess_over(double truth, double found) { return truth > 0 ? found / truth - 1 : 0; }

ElementRow error_row(const ElementBody& body, const Deed& deed, const Element& element, const Truth& truth) {
  const Setup setup = of_element(deed.on(body.mesh), element);
  const StaticResult found = checked(solve_static(setup, {.factor = make_supernodal}),
                                     body.name + " of " + element.name + " tetrahedra");
  Mat3X<double> prescribed = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  for (const PrescribedVertex& p : setup.prescribed) prescribed.col(p.vertex) = p.displacement;
  ElementRow row{body.name, body.mesh.tet_count(), deed.name, &element};
  row.error = compare_displacements(truth.mesh, truth.prolongate(found.u), truth.u).l2;
  row.largest = excess_over(truth.u.colwise().norm().maxCoeff(), found.u.colwise().norm().maxCoeff());
  row.force = excess_over(truth.force, force_on_moved(found.reactions, prescribed).norm());
  return row;
}

std::vector<ElementRow> error_rows(const ElementBody& body) {
  std::vector<ElementRow> rows;
  for (const Deed& deed : body.deeds) {
    const Truth truth = truth_of(body, deed);
    for (const Element& element : compared_elements) rows.push_back(error_row(body, deed, element, truth));
  }
  const Setup at_rest = body.deeds.front().on(body.mesh);
  const double truth = lowest_quadratic_frequency(at_rest);
  for (const Element& element : compared_elements) {
    ElementRow& row =
        rows.emplace_back(ElementRow{body.name, body.mesh.tet_count(), "lowest frequency", &element});
    row.error = lowest_frequency(of_element(at_rest, element)) / truth - 1;
  }
  return rows;
}

// ---- Cost

struct Cost {
  double step = 1, time = 1;
};

// All play the same frames of the first gesture, each with steps as long as its own limit allows.
std::vector<Cost> element_costs(const ElementBody& body, const Sampling& sampling) {
  constexpr int steps_per_frame = 50;
  const Setup plain = body.deeds.front().on(body.mesh);
  std::vector<std::shared_ptr<World<float>>> worlds;
  for (const Element& element : compared_elements)
    worlds.push_back(std::make_shared<World<float>>(of_element(plain, element)));
  std::vector<Cost> costs;
  const double of_plain = worlds.front()->time_step_limit();
  for (const auto& world : worlds) costs.push_back({world->time_step_limit() / of_plain});
  const double frame = (steps_per_frame - 0.5) * plain.safety * of_plain;
  std::vector<Timed> frames;
  for (const auto& world : worlds) frames.push_back({[world, frame] { world->advance(frame); }});
  const auto samples = sample_in_turn(frames, sampling);
  for (std::size_t i = 0; i < costs.size(); ++i) costs[i].time = median(samples[i]) / median(samples[0]);
  return costs;
}

// ---- Tables

std::string csv(const std::vector<ElementRow>& rows) {
  std::ostringstream out;
  out << "body,tets,gesture,element,error,largest_excess,force_excess,step_ratio,time_ratio\n"
      << std::setprecision(4);
  for (const ElementRow& r : rows)
    out << r.body << ',' << r.tets << ',' << r.gesture << ',' << r.element->name << ',' << r.error << ','
        << r.largest << ',' << r.force << ',' << r.step << ',' << r.time << '\n';
  return out.str();
}

std::string line_of(const ElementRow& r, const char* format) {
  char line[256];
  std::snprintf(line, sizeof line, format, r.body.c_str(), r.tets, r.gesture.c_str(), r.element->name,
                100 * r.error, 100 * r.largest, 100 * r.force, r.step, r.time);
  return line;
}

std::string markdown(const std::vector<ElementRow>& rows, const std::string& machine) {
  std::string out =
      machine +
      "\n\n| body | tetrahedra | gesture | element | error % | largest displacement % | force % "
      "| stable step | time |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const ElementRow& r : rows)
    out += line_of(r, "| %s | %d | %s | %s | %.2f | %+.2f | %+.2f | %.2f | %.2f |\n");
  return out;
}

}  // namespace

void bench_elements(const Options& options) {
  const std::string machine = begin_results(options.output, "elements");
  std::printf("\n%-16s %6s %-16s %-34s %8s %9s %8s %6s %6s\n", "body", "tets", "gesture", "element",
              "error %", "largest %", "force %", "step", "time");
  std::vector<ElementRow> rows;
  for (const ElementBody& body : element_bodies(options)) {
    const std::vector<Cost> costs = element_costs(body, options.quick ? Sampling{5, 0.02} : Sampling{});
    for (ElementRow& row : error_rows(body)) {
      const Cost& cost = costs[std::size_t(row.element - compared_elements)];
      row.step = cost.step;
      row.time = cost.time;
      std::printf("%s", line_of(row, "%-16s %6d %-16s %-34s %8.2f %+9.2f %+8.2f %6.2f %6.2f\n").c_str());
      std::fflush(stdout);
      rows.push_back(std::move(row));
    }
  }
  io::write_file(options.output / "elements.csv", csv(rows));
  io::write_file(options.output / "elements.md",
                 "# Elements: error and cost on the same mesh\n\n" + markdown(rows, machine));
}

}  // namespace lobe::bench
