// A force on a body in addition to those of its regions, its weight and its dead loads: contact, the springs of
// a haptic coupling, what an application adds. A World has a list of them (World::add()). An empty list costs
// nothing.
#pragma once

#include <string>
#include <vector>

#include "lobe/body/model.h"

namespace lobe {

template <class Real>
class ForceTerm {
 public:
  struct At {  // columns are of at least all vertices
    const Model& model;
    const Mat3X<Real>& u;  // [m]
    const Mat3X<Real>& v;  // [m/s]
    double time = 0;       // [s]
  };

  virtual ~ForceTerm() = default;
  virtual std::string name() const = 0;  // under which a checkpoint keeps it, unlike that of others

  // Once per step: f += forces that act on vertices [N]. A force that depends on v is taken half a step late.
  virtual void add_forces(const At& at, Mat3X<Real>& f) = 0;
  // What its vertices feel of it when they move while their neighbours are held, −∂f_v/∂u_v [N/m]: without it the time step limit is
  // too long.
  virtual void add_diagonal_stiffness(const At&, DiagonalStiffness&) const {}
  virtual double energy(const At&) const { return 0; }  // [J]
  // Vertices on which it may act in this frame. They do not sleep through it.
  virtual std::vector<Index> touched() const = 0;
  virtual void begin_frame(double /*time*/, double /*duration*/) {}  // [s]
  virtual void follow(const Topology&, const MeshEdit&) {}           // of the mesh

  // All of its state, for checkpoints. load() throws InputError for what save() did not write.
  virtual std::string save() const { return {}; }
  virtual void load(const std::string& /*kept*/, Index /*vertices*/) {}
};

}  // namespace lobe
