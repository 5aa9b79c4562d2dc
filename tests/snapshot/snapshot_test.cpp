#include "lobe/snapshot/snapshot.h"

#include <doctest/doctest.h>

#include <set>

#include "lobe/fem/body.h"
#include "lobe/snapshot/triple_buffer.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("pictures of one revision share what a cut alone changes, and keep it when the next cut comes") {
  const TetMesh box = irregular_box(4);
  Topology topology(box);
  const std::vector<RegionModel> regions(std::size_t(box.tet_count()), RegionModel::nonlinear);
  Surface surface(topology, regions);
  SurfaceCopies copies;
  SurfaceSnapshot<float> first, second, third;
  const Mat3X<float> u = random_displacement<float>(box.vertex_count(), 1e-3);
  copies.copy(surface, box.points, Mat3X<float>::Zero(3, box.vertex_count()), first);
  copies.copy(surface, box.points, u, second);
  CHECK(first.mesh == second.mesh);
  const auto before = first.mesh->triangles;

  const MeshEdit edit = topology.remove(std::vector<Index>{0});
  surface.follow(topology, edit, regions);
  REQUIRE(topology.vertex_count() == box.vertex_count());
  copies.copy(surface, box.points, u, third);
  CHECK(third.mesh != first.mesh);
  CHECK(third.mesh->revision == surface.revision());
  CHECK(third.mesh->triangles == surface.mesh().triangles);
  CHECK(first.mesh->triangles == before);

  for (const SurfaceSnapshot<float>& copy : {second, third})
    for (Index i = 0; i < copy.mesh->vertex_count(); ++i) {
      const Index v = copy.mesh->mesh_vertex[i];
      const Vec3<float> x = (box.points.col(v) + u.col(v).cast<double>()).cast<float>();
      CHECK(copy.x.col(i) == x);
      CHECK(std::abs(copy.normals.col(i).norm() - 1) < 1e-6F);
    }
}

TEST_CASE("pictures that go through the buffer use their storage again") {
  const TetMesh box = irregular_box(4);
  const Topology topology(box);
  const std::vector<RegionModel> regions(std::size_t(box.tet_count()), RegionModel::nonlinear);
  const Surface surface(topology, regions);
  SurfaceCopies copies;
  TripleBuffer<Snapshot<double>> buffer;
  const Mat3X<double> u = random_displacement(box.vertex_count(), 1e-3);
  std::set<const double*> storage;
  std::set<const SurfaceMesh*> meshes;
  for (int frame = 0; frame < 50; ++frame) {
    Snapshot<double>* const picture = buffer.writable();
    REQUIRE(picture);
    picture->frame = frame;
    picture->u = u;
    copies.copy(surface, box.points, u, picture->surface);
    buffer.publish();
    const auto view = buffer.latest();
    CHECK(view->frame == frame);
    CHECK(view->u == u);
    storage.insert({view->u.data(), view->surface.x.data(), view->surface.normals.data()});
    meshes.insert(view->surface.mesh.get());
  }
  CHECK(storage.size() == 3 * 2);
  CHECK(meshes.size() == 1);
}
