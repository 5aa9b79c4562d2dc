// Where a body is now, as contact asks for it, and where its forces go.
#pragma once

#include "lobe/types.h"

namespace lobe {

// One column for each point, component after component.
using PointRows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

class Places {
 public:
  virtual ~Places() = default;
  virtual Vec3d of_point(int point) const = 0;           // of the surface [m]
  virtual Vec3d velocity_of_point(int point) const = 0;  // [m/s]
  // Of some points of the surface: their places [m] and velocities [m/s].
  virtual void of_points(const std::vector<int>& points, PointRows& x, PointRows& v) const = 0;
  virtual Vec3d of_vertex(Index vertex) const = 0;  // of the mesh [m]
  virtual Vec3d velocity_of_vertex(Index vertex) const = 0;
  // Writes the positions of vertices of the mesh [m] to x[4 to[i]] … x[4 to[i] + 2], and their velocities
  // [m/s] to v in the same way, unless v is null. Every fourth number keeps its value.
  virtual void of_vertices(const std::vector<Index>& vertices, const std::vector<int>& to, double* x,
                           double* v) const = 0;

  // A station is a stored configuration of the whole body, at an earlier or a predicted moment.

  // Makes one of where it will be `ahead` [s] from now, at the present velocities.
  virtual void set_station(int station, double ahead) const = 0;
  // How much nearer any two vertices may be than there, at most [m].
  virtual double range_since(int station) const = 0;
  virtual double range_of_speeds() const = 0;  // the same per time [m/s]
  // Places of vertices there about another vertex; four numbers each, of which the last stays as it is [m].
  virtual void of_vertices_there(int station, Index origin, const std::vector<Index>& vertices,
                                 float* x) const = 0;
};

class ContactForces {
 public:
  virtual ~ContactForces() = default;
  virtual void add_to_point(int point, const Vec3d& force) = 0;  // [N]
  virtual void add_to_vertex(Index vertex, const Vec3d& force) = 0;
};

}  // namespace lobe
