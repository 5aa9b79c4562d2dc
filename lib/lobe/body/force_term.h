// A force on a body in addition to those of its regions, its weight and its dead loads: contact, the springs of
// a haptic coupling, what an application adds. A World has a list of them (World::add()). An empty list costs
// nothing.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lobe/body/model.h"
#include "lobe/mesh/surface.h"
#include "lobe/tool/tool_body.h"

namespace lobe {

// What is around a body before the steps of a frame, for those force terms that want it.
struct Surroundings {
  const Model& model;
  const SurfaceMesh& surface;
  const std::vector<double>& mass;  // per vertex [kg]
  double omega = 0;                 // its highest frequency at rest [rad/s]
  double lumped_omega = 0;          // the same if masses were lumped
  double ratio = 1;                 // of that to the highest of a vertex that moves alone
  // With selective masses: from forces [N] to those that give lumped masses the same accelerations. None: lumped.
  std::function<void(Mat3X<double>&)> spread = {};
};

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

  // ---- Of those that act between the body and what is around it

  virtual bool wants_surroundings() const { return false; }
  // Before the steps of a frame, after its cuts: the tools in it, and the body.
  // True if others are there than were at this time.
  virtual bool see_tools(std::span<const ToolBody>, double /*time*/) { return false; }
  virtual void see_surroundings(const Surroundings&, const At&) {}
  // What the forces that were found last do to tools.
  virtual std::span<const OnTool> on_tools() const { return {}; }

  // ---- Of those whose forces depend on what was before

  // Steps begin that may be taken back, all of them.
  virtual void begin_steps() {}
  virtual void take_back_steps() {}
  // A step of dt [s] was taken by the forces that were found last; no vertex has moved further than `farthest` [m].
  virtual void end_step(double /*farthest*/, double /*dt*/) {}

  // All of its state, for checkpoints. load() throws InputError for what save() did not write.
  virtual std::string save() const { return {}; }
  virtual void load(const std::string& /*kept*/, Index /*vertices*/) {}
};

}  // namespace lobe
