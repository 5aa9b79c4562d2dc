// A body at rest, for its contact with itself (self_contact.h): the triangles of its surface, and the
// tetrahedra behind them.
#pragma once

#include <span>
#include <vector>

#include "lobe/contact/contact_surface.h"

namespace lobe {

class BoundaryLayer {
 public:
  struct Tet {  // a tetrahedron with a corner on the boundary
    Index tet = -1;
    Eigen::Vector4i corners;
    Mat34<double> rest;             // [m]
    int first_face = 0, faces = 0;  // triangles of the surface that may be nearest to a point in it
    int first_lip = 0, lips = 0;    // its cut faces, if it is filled in part
  };
  struct Nearest {
    int face = -1;    // triangle of the surface; −1: none
    double room = 0;  // `face` is the nearest for all rest points within this distance of the given one [m]
  };

  void rebuild(const ContactSurface& surface, const Elements& elements);

  const std::vector<Tet>& tets() const { return tets_; }
  // The place in tets() of a tetrahedron with a corner on the boundary.
  int number_of(Index tet) const;
  // The triangles of the surface that may be nearest to a point in a tetrahedron.
  std::span<const int> faces_of(const Tet& tet) const { return part(faces_, tet.first_face, tet.faces); }
  // The places in tets() of what a triangle never touches.
  std::span<const int> own_of(int triangle) const {
    const int first = first_own_[std::size_t(triangle)];
    return part(own_, first, first_own_[std::size_t(triangle) + 1] - first);
  }

  // `rest`: a point of a tetrahedron where it was at rest [m].
  bool is_filled(const Tet& tet, const Vec3d& rest) const;
  // The nearest of the triangles that the point lies behind.
  Nearest nearest_face(const Tet& tet, const Vec3d& rest) const;
  bool is_behind(int face, const Vec3d& rest) const;

 private:
  struct Plane {  // the plane of a triangle
    Vec3d normal, corner;
    double height(const Vec3d& rest) const { return normal.dot(rest - corner); }
  };
  struct Ball {  // around one
    Vec3d centre;
    double radius;
  };

  static std::span<const int> part(const std::vector<int>& of, int first, int count) {
    return {of.data() + first, std::size_t(count)};
  }
  std::span<const int> lips_of(const Tet& tet) const { return part(lips_, tet.first_lip, tet.lips); }
  double square_to(int face, const Vec3d& rest) const;
  double room_about(const Tet& tet, const Vec3d& rest, int nearest, double square) const;
  void place_at_rest(const ContactSurface& surface, const Elements& elements);
  void find_lips(const ContactSurface& surface, const Elements& elements);
  void find_faces(Tet& tet);
  std::vector<int> vertices_around(const ContactSurface& surface, int triangle);
  void list_own(const ContactSurface& surface);
  Vec3d middle_of_filled(const Tet& tet) const;
  bool is_on_its_side(const ContactSurface& surface, int triangle, const Tet& tet) const;

  std::vector<Tet> tets_;
  std::vector<int> faces_, lips_;  // the faces and lips themselves
  // One entry per triangle of the surface.
  std::vector<Plane> planes_;
  std::vector<Mat3<double>> rest_;  // corners [m]
  std::vector<Ball> balls_;
  std::vector<int> first_own_, own_;
  // Triangles around each point of the surface, and around each vertex of the mesh.
  std::vector<int> first_around_, around_, first_of_vertex_, of_vertex_;
  std::vector<int> stamp_of_vertex_, stamp_of_tet_;
};

}  // namespace lobe
