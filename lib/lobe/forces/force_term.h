// A force term is a force on a body besides those of its regions, its weight and its dead loads. Examples are
// contact, the springs of a haptic coupling, and forces of an application. A World has a list of them
// (World::add()). An empty list costs nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lobe/body/model.h"
#include "lobe/cut/cautery.h"
#include "lobe/forces/event.h"
#include "lobe/forces/term_lines.h"
#include "lobe/mesh/surface.h"
#include "lobe/tool/tool_body.h"

namespace lobe {

class Grains;
struct Setup;

// The body as some force terms need it before the steps of a frame.
struct BodyView {
  const Model& model;
  const SurfaceMesh& surface;
  const std::vector<double>& mass;  // mass of each vertex [kg]
  const Grains* grains = nullptr;   // null: no blade has cut
  double omega = 0;                 // highest frequency of the body at rest [rad/s]
  double lumped_omega = 0;          // highest frequency if masses were lumped [rad/s]
  double ratio = 1;                 // lumped_omega over the highest frequency of a single vertex
  int mass_degree = 1;              // degree of selective masses; 1: they are lumped
  // The share of its stiffness that contact keeps at this degree (contact/softening.h). Null if masses are
  // lumped.
  std::function<double()> softening = {};
};

// What the next step makes of the forces f that are asked for: v⁺ = keep v + push f/m, u⁺ = u + dt v⁺
// (body/integrator.h).
struct Kick {
  double keep = 1, push = 0;  // [-], [s]
  double dt = 0;              // [s]; 0: no step follows
};

template <class Real>
class ForceTerm {
 public:
  struct At {  // columns: at least all vertices
    const Model& model;
    const Mat3X<Real>& u;  // [m]
    const Mat3X<Real>& v;  // [m/s]
    double time = 0;       // [s]
    Kick kick = {};        // the step that follows
  };

  virtual ~ForceTerm() = default;
  virtual std::string name() const = 0;  // name in checkpoints, different from those of other terms

  // Once per step: f += forces that act on vertices [N]. A force that depends on v is taken half a step late.
  virtual void add_forces(const At& at, Mat3X<Real>& f) = 0;
  // Adds the stiffness that each vertex feels when it moves while its neighbours are held, −∂f_v/∂u_v [N/m].
  // Without it the steps would be too long. Neither this nor energy() changes what later forces are.
  virtual void add_diagonal_stiffness(const At&, DiagonalStiffness&) {}
  virtual double energy(const At&) { return 0; }  // [J]
  // Vertices on which it may act in this frame. In a reduced region they do not follow the lattice, which has
  // no forces of terms.
  virtual std::vector<Index> acts_on(const Model& model) const = 0;
  // The vertices of acts_on() on which it may act although they rest. They do not sleep through the frame. A
  // drag, which acts only on what moves, has none.
  virtual std::vector<Index> wakes(const Model& model) const { return acts_on(model); }
  // Adds the damping that each vertex feels, the largest of −∂f_v/∂v_v over all directions [kg/s], to its
  // entry. Without it the steps would be too long, since the force is taken half a step late.
  virtual void add_diagonal_damping(const At&, std::vector<double>&) const {}
  virtual void begin_frame(double /*time*/, double /*duration*/) {}  // [s]
  virtual void follow(const Topology&, const MeshEdit&) {}           // follows an edit of the mesh
  // Is called after follow() once a blade has cut: grains say where each part of a divided tetrahedron is.
  virtual void follow_grains(const Elements&, const Grains&, const MeshEdit&) {}
  // Is called before a tool burns or cuts what it sweeps in a frame. The term loses what is no tissue and
  // crosses the volume, as threads and strands.
  virtual void sever(const SweptVolume&, const At&) {}
  virtual std::vector<Event> take_events() { return {}; }  // events since the last call
  virtual std::vector<TermLines> lines(const At&) const { return {}; }
  // Adds what is left of it to the setup of the body that is left.
  virtual void add_to_setup(const Elements&, const CompactMesh& /*left*/, Setup&) const {}

  // ---- For terms that act between the body and what is around it

  virtual bool needs_body() const { return false; }
  // Both are called in each frame after its cuts and before its steps, with the tools and the body.
  // see_tools() returns whether other tools touch at this time than before.
  virtual bool see_tools(std::span<const ToolBody>, double /*time*/) { return false; }
  virtual void see_body(const BodyView&, const At&) {}
  // After see_body(), before the steps of a frame: finds what acts_on() says until the next frame. That is
  // part of save(), as edits between two frames ask for it.
  virtual void look_ahead(const At&) {}
  // The forces of the last evaluation on tools.
  virtual std::span<const OnTool> on_tools() const { return {}; }

  // ---- For terms whose forces depend on earlier steps, as friction does

  // take_back_steps() undoes all steps since begin_steps().
  virtual void begin_steps() {}
  virtual void take_back_steps() {}
  // Is called after a step of dt [s] with the forces of the last evaluation. No vertex has moved further than
  // `farthest` [m].
  virtual void end_step(double /*farthest*/, double /*dt*/) {}

  // All of its state, for checkpoints. load() throws InputError for what save() did not write.
  virtual std::string save() const { return {}; }
  virtual void load(const std::string& /*saved*/, Index /*vertices*/) {}
};

template <class Real>
using ForceTerms = std::vector<std::shared_ptr<ForceTerm<Real>>>;

// Returns the term of this kind among those of a body; null if there is none.
template <template <class> class Term, class Real>
Term<Real>* term_of(const ForceTerms<Real>& terms) {
  for (const auto& term : terms)
    if (term->name() == Term<Real>::term_name) return static_cast<Term<Real>*>(term.get());
  return nullptr;
}

}  // namespace lobe
