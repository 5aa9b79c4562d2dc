#include "lobe/solve/quadratic_solver.h"

#include "lobe/error.h"
#include "lobe/setup/check_setup.h"
#include "lobe/solve/floating.h"
#include "lobe/solve/quadratic_tangent.h"

namespace lobe {
namespace {

// Of each vertex or node: which of its components are given, and by how much they move.
struct Given {
  Given(const std::vector<PrescribedVertex>& prescribed, Index count)
      : axes(std::size_t(count), Axes{}), displacements(Mat3X<double>::Zero(3, count)) {
    const HeldVertices held = held_by(prescribed);
    for (const HeldVertices::Held& item : held.all()) {
      axes[std::size_t(item.vertex)] = item.axes;
      for (int axis = 0; axis < 3; ++axis)
        if (item.axes[axis]) displacements(axis, item.vertex) = item.goal[axis];
    }
  }
  std::vector<Axes> axes;
  Mat3X<double> displacements;
};

std::vector<char> nodes_in_use(const QuadraticMesh& mesh) {
  std::vector<char> used(std::size_t(mesh.node_count()), 0);
  for (const Index node : mesh.nodes.reshaped()) used[std::size_t(node)] = 1;
  return used;
}

// An edge whose ends are given moves with them.
Given of_all_nodes(const Given& vertices, const QuadraticMesh& mesh) {
  Given nodes = vertices;
  nodes.displacements = mesh.joined_linearly(vertices.displacements);
  for (const auto& [a, b] : mesh.ends) {
    Axes& axes = nodes.axes.emplace_back();
    for (int axis = 0; axis < 3; ++axis)
      axes[axis] = vertices.axes[std::size_t(a)][axis] && vertices.axes[std::size_t(b)][axis];
  }
  return nodes;
}

Unknowns free_nodes(const QuadraticMesh& mesh, const Given& given) {
  const std::vector<char> used = nodes_in_use(mesh);
  return Unknowns(mesh.node_count(), [&](Index node, int axis) {
    return used[std::size_t(node)] && !given.axes[std::size_t(node)][axis];
  });
}

void add_weight(const Elements& elements, const QuadraticMesh& mesh, const Vec3d& gravity,
                Mat3X<double>& loads) {
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Vec3d weight = elements.volume(t) * elements.elastic_of(t).density * gravity;
    for (int n = 0; n < 10; ++n) loads.col(mesh.nodes(n, t)) += (n < 4 ? corner_share : edge_share) * weight;
  }
}

// What a blade has left of a face bears its load at the corners, as on the mesh itself.
void add_traction(const TetMesh& mesh, const QuadraticMesh& nodes, const FaceLoad& load,
                  Mat3X<double>& loads) {
  const int* c = face_corners[load.face];
  const Mat34<double> X = tet_points(mesh, load.tet);
  const double area = (X.col(c[1]) - X.col(c[0])).cross(X.col(c[2]) - X.col(c[0])).norm() / 2;
  if (load.weights != Vec3d::Ones()) {
    for (int k = 0; k < 3; ++k)
      loads.col(mesh.tets(c[k], load.tet)) += load.weights[k] * area / 3 * load.traction;
    return;
  }
  for (int e = 0; e < 6; ++e)
    if (edge_corners[e][0] != load.face && edge_corners[e][1] != load.face)
      loads.col(nodes.nodes(4 + e, load.tet)) += face_edge_share * area * load.traction;
}

StaticEquations equations_with(const Setup& setup, const QuadraticMesh& mesh, const Given& given) {
  if (!setup.pressures.empty())
    throw InputError("pressure", "is not known on 10-node tetrahedra: leave --quadratic out");
  if (any_partly_held(setup))
    throw InputError("quadratic elements", "know wholly held vertices only: use \"hold_by\": \"vertices\"");
  StaticEquations equations{free_nodes(mesh, given), given.displacements,
                            Mat3X<double>::Zero(3, mesh.node_count())};
  for (Eigen::Index i = 0; i < equations.prescribed.size(); ++i)
    if (equations.unknowns.number.data()[i] >= 0) equations.prescribed.data()[i] = 0;
  add_weight(Elements(setup), mesh, setup.gravity, equations.loads);
  for (const FaceLoad& load : setup.face_loads) add_traction(setup.mesh, mesh, load, equations.loads);
  for (const VertexLoad& load : setup.vertex_loads) equations.loads.col(load.vertex) += load.force;
  return equations;
}

}  // namespace

StaticEquations quadratic_equations(const Setup& setup, const QuadraticMesh& mesh) {
  return equations_with(setup, mesh, of_all_nodes(Given(setup.prescribed, setup.mesh.vertex_count()), mesh));
}

StaticEquations quadratic_equations(const Setup& setup, const QuadraticMesh& mesh,
                                    const std::vector<PrescribedVertex>& given) {
  return equations_with(setup, mesh, Given(given, mesh.node_count()));
}

StaticResult solve_static_quadratic(const Setup& setup, const StaticOptions& options) {
  check_setup(setup, {Option::static_solution});
  const QuadraticMesh mesh(setup.mesh);
  return solve_static_quadratic(setup, mesh, quadratic_equations(setup, mesh), options);
}

StaticResult solve_static_quadratic(const Setup& setup, const QuadraticMesh& mesh,
                                    const StaticEquations& equations, const StaticOptions& options) {
  check_setup(setup, {Option::static_solution});
  const Elements elements(setup);
  refuse_floating_pieces(elements, equations.unknowns);
  QuadraticTangent body(elements, mesh, equations.unknowns);
  return find_equilibrium(equations, body, options);
}

}  // namespace lobe
