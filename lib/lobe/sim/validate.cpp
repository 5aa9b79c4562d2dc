#include "lobe/sim/validate.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lobe/sim/validate_parts.h"

namespace lobe {
namespace {

void check(bool holds, const std::string& what) { lobe_assert(holds, what.c_str()); }

template <class Items>
std::vector<Index> sorted(const Items& items) {
  std::vector<Index> list(items.begin(), items.end());
  std::sort(list.begin(), list.end());
  return list;
}

// ---- The mesh

// Faces by their vertices, each with the tetrahedra that have it.
struct FaceOfTet {
  std::array<Index, 3> vertices;
  Index code;  // 4 × tetrahedron + corner opposite to it
  bool operator<(const FaceOfTet& other) const {
    return vertices != other.vertices ? vertices < other.vertices : code < other.code;
  }
};

std::vector<FaceOfTet> faces_of(const Topology& topology) {
  std::vector<FaceOfTet> faces;
  for (Index t = 0; t < topology.tet_count(); ++t)
    for (int f = 0; f < 4 && topology.alive(t); ++f) {
      const Eigen::Vector3i face = topology.face(4 * t + f);
      std::array<Index, 3> vertices{face[0], face[1], face[2]};
      std::sort(vertices.begin(), vertices.end());
      faces.push_back({vertices, 4 * t + f});
    }
  std::sort(faces.begin(), faces.end());
  return faces;
}

// Copies of tetrahedra may share a face with several others, and need not with all that have its corners:
// neighbours know each other, and have three corners in common.
void validate_shared_faces(const Topology& topology) {
  std::vector<Index> boundary;
  for (Index t = 0; t < topology.tet_count(); ++t) {
    if (!topology.alive(t)) continue;
    std::array<bool, 4> has_neighbour{};
    topology.for_neighbours(t, [&](int face, Index other) {
      has_neighbour[std::size_t(face)] = true;
      bool is_known = false;
      topology.for_neighbours(other, [&](int, Index back) { is_known = is_known || back == t; });
      const Eigen::Vector4i beside = topology.corners(other);
      for (Index v : topology.face(4 * t + face))
        check((beside.array() == v).any(), "topology: a face that only one of its tetrahedra has");
      check(topology.alive(other) && is_known, "topology: a neighbour across a face");
    });
    for (int f = 0; f < 4; ++f)
      if (!has_neighbour[std::size_t(f)]) boundary.push_back(4 * t + f);
  }
  check(sorted(topology.boundary_faces()) == boundary, "topology: the boundary");
}

// Checks the neighbour across each face, and that faces without one are the boundary. Of a body that a blade
// has met, faces may be open whose tetrahedra still have three corners in common.
void validate_faces(const Topology& topology, bool is_incised) {
  if (is_incised) return validate_shared_faces(topology);
  const std::vector<FaceOfTet> faces = faces_of(topology);
  std::vector<Index> boundary;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].vertices == faces[i].vertices) ++end;
    check(end - i <= 2, "topology: a face belongs to more than two tetrahedra");
    const Index a = faces[i].code, b = end - i == 2 ? faces[i + 1].code : -1;
    check(topology.neighbour(a / 4, a % 4) == (b < 0 ? -1 : b / 4), "topology: a neighbour across a face");
    if (b >= 0) check(topology.neighbour(b / 4, b % 4) == a / 4, "topology: a neighbour across a face");
    if (b < 0) boundary.push_back(a);
    i = end;
  }
  std::sort(boundary.begin(), boundary.end());
  check(sorted(topology.boundary_faces()) == boundary, "topology: the boundary");
}

void validate_topology(const Elements& elements, bool is_incised) {
  const Topology& topology = elements.topology;
  std::vector<std::vector<Index>> around(std::size_t(topology.vertex_count()));
  Index alive = 0;
  for (Index t = 0; t < topology.tet_count(); ++t) {
    if (!topology.alive(t)) continue;
    ++alive;
    for (const Index v : topology.corners(t)) {
      check(v >= 0 && v < topology.vertex_count(), "topology: a corner is no vertex");
      around[std::size_t(v)].push_back(t);
    }
  }
  check(alive == topology.alive_count(), "topology: the number of tetrahedra that are left");
  for (Index v = 0; v < topology.vertex_count(); ++v)
    check(sorted(topology.around(v)) == around[std::size_t(v)], "topology: the tetrahedra around a vertex");
  validate_faces(topology, is_incised);
}

void validate_elements(const Elements& elements) {
  const Topology& topology = elements.topology;
  const auto tets = std::size_t(topology.tet_count());
  check(elements.points.count() == topology.vertex_count(), "elements: one rest position per vertex");
  check(elements.region_of.size() == tets && elements.material_of.size() == tets &&
            elements.corner_volumes.size() == tets,
        "elements: one region, one material and one volume per tetrahedron");
  check(elements.bodies.of.size() == (elements.bodies.any() ? tets : 0),
        "elements: one body per tetrahedron, or none");
  for (Index t = 0; t < topology.tet_count(); ++t) {
    check(elements.material_of[std::size_t(t)] < elements.materials.size(), "elements: a material's number");
    if (topology.alive(t))
      check(signed_volume(elements.corner_points(t)) > 0, "elements: a tetrahedron's rest volume");
    check(elements.corner_volumes[std::size_t(t)] == elements.volume(t) / 4, "elements: a quarter's volume");
  }
}

// ---- The body in motion

template <class Real>
void validate_motion(const Dynamics<Real>& body) {
  const Index vertices = body.model.elements.topology.vertex_count();
  const Motion<Real>& motion = body.motion;
  check(motion.u.count() == vertices && motion.v.count() == vertices && motion.forces.count() == vertices &&
            motion.reversals.size() == std::size_t(vertices),
        "motion: one displacement, velocity and force per vertex");
  check(motion.u.view().allFinite() && motion.v.view().allFinite() && std::isfinite(motion.time),
        "motion: the state is not finite");
}

// What the tetrahedra around a vertex give it, and what an interface carries; what follows others has none.
template <class Real>
double expected_mass(const Dynamics<Real>& body, Index v) {
  if (body.regions.follows(v)) return 0;
  const Elements& elements = body.model.elements;
  return std::max({lumped_mass(elements, v) + body.regions.carried(v), body.inertia.floor().at(elements, v),
                   body.regions.least_mass(v)});
}

template <class Real>
void validate_masses(const Dynamics<Real>& body) {
  const std::vector<double>& mass = body.inertia.mass();
  const Index vertices = body.model.elements.topology.vertex_count();
  check(mass.size() == std::size_t(vertices), "inertia: one mass per vertex");
  for (Index v = 0; v < vertices; ++v) {
    const double vertex_mass = mass[std::size_t(v)];
    check(vertex_mass == expected_mass(body, v), "inertia: a vertex's mass");
    const double inverse = body.inertia.inverse_mass(v);
    const bool rests = body.model.held.fixes(v) || vertex_mass == 0;
    check(rests ? inverse == 0 : std::abs(inverse * vertex_mass - 1) < 1e-12, "inertia: an inverse mass");
  }
}

template <class Real>
void validate_held(const Dynamics<Real>& body) {
  for (const HeldVertices::Held& item : body.model.held.all()) {
    check(item.vertex >= 0 && item.vertex < body.model.elements.topology.vertex_count(),
          "held: a vertex that there is not");
    check(body.model.held.holds(item.vertex), "held: an entry that does not hold its vertex");
  }
  for (const HeldVertices::Held& item : body.model.held.partly()) {
    check(item.is_valid() && item.share < 1 && item.vertex < body.model.elements.topology.vertex_count(),
          "held: a share of a vertex that there is not, or a share that is none");
    check(body.model.held.anchors(item.vertex), "held: a share that does not anchor its vertex");
  }
  if (!body.hold_springs.is_current(body.model.revisions)) return;
  check(body.hold_springs.all().size() == body.model.held.partly().size(), "held: a share without a spring");
  for (const auto& spring : body.hold_springs.all()) {
    const double k = hold_stiffness(body.model.elements, spring.item);
    check(std::abs(spring.stiffness - k) <= 1e-12 * k, "held: the stiffness of a spring");
  }
}

void validate_surface(const Surface& surface, const SurfaceCells& cells, const Elements& elements) {
  const SurfaceMesh& mesh = surface.mesh();
  const std::vector<Index> faces = cells.outer_faces();
  check(std::size_t(mesh.triangle_count()) == faces.size(), "surface: one triangle per face of the boundary");
  for (Index code : faces) {
    const SurfaceCells::Cell cell = cells.cell(code / 4);
    const Index i = surface.triangle_of({cell.tet, std::uint32_t(cells.are_tets() ? code % 4 : code)});
    check(i >= 0, "surface: a face of the boundary that is not there");
    const auto slot = std::size_t(i);
    check(mesh.region[slot] == elements.region_of[std::size_t(cell.tet)], "surface: a triangle's region");
    check(mesh.body[slot] == elements.bodies.body_of(cell.tet), "surface: a triangle's body");
    for (int k = 0; k < 3; ++k) {
      const Index vertex = mesh.triangles[slot][k], point = cell.points[face_corners[code % 4][k]];
      check(surface.vertex_of(point, mesh.cut[slot], cells.stroke_of(code)) == vertex,
            "surface: a triangle's corners");
      check(surface.point_of(vertex) == point, "surface: a vertex's point");
      const SurfacePlace place = cells.place(point);
      if (place.vertex >= 0)
        check(mesh.mesh_vertex[std::size_t(vertex)] == place.vertex, "surface: a vertex of the mesh");
    }
  }
}

void validate_places(const SurfaceMesh& mesh, const Topology& topology) {
  for (const SurfaceMesh::Within& inner : mesh.within) {
    check(inner.vertex >= 0 && inner.vertex < mesh.vertex_count(), "surface: a place of no vertex");
    check(std::abs(inner.weights.sum() - 1) < 1e-9, "surface: weights that are not 1 together");
    const auto around = topology.around(inner.corners[0]);
    check(std::any_of(around.begin(), around.end(),
                      [&](Index t) { return topology.corners(t) == inner.corners; }),
          "surface: a vertex within no tetrahedron");
  }
}

}  // namespace

template <class Real>
void validate(World<Real>& world) {
  Dynamics<Real>& body = world.body();
  const bool is_incised = world.grains() || !body.model.elements.shares.empty();
  validate_topology(body.model.elements, is_incised);
  validate_elements(body.model.elements);
  validate_parts(world);
  validate_motion(body);
  validate_held(body);
  validate_masses(body);
  validate_surface(world.surface(), *surface_cells(body.model.elements, world.grains()), body.model.elements);
  validate_places(world.surface().mesh(), body.model.elements.topology);
}

template void validate(World<float>&);
template void validate(World<double>&);

}  // namespace lobe
