#include "lobe/contact/contact.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lobe/contact/self_contact.h"
#include "lobe/contact/tool_contact.h"
#include "lobe/file/fields.h"
#include "lobe/sort_unique.h"

namespace lobe {

template <class Real>
struct Contact<Real>::OfTool {
  int tool = 0;
  Remembered remembered;
};

template <class Real>
struct Contact<Real>::Scratch {
  Mat3X<double> x;               // places of all points of the surface [m]
  ContactForces self_forces;     // of the body on itself
  Mat3X<Real> soon;              // displacements at the end of the frame [m]
  DiagonalStiffness now, later;  // of the body on itself
};

template <class Real>
Contact<Real>::Contact(const ContactSetup& setup, double body_damping)
    : setup_(setup), body_damping_(body_damping), scratch_(std::make_unique<Scratch>()) {
  if (setup.self) self_ = std::make_unique<SelfContact>();
  for (const ObstacleSetup& obstacle : setup.obstacles)
    tools_.emplace_back(static_cast<int>(tools_.size()) - static_cast<int>(setup.obstacles.size()), obstacle);
}

template <class Real>
Contact<Real>::~Contact() = default;

template <class Real>
ContactLaw Contact<Real>::law() const {
  const double omega = surface_.omega();
  return {.damping = omega > 0 ? 2 * setup_.damping / omega : 0,
          .hold = 0.5 * body_damping_,
          .deepest = deepest_contact * surface_.mean_edge() / surface_.softening(),
          .friction = setup_.friction};
}

// ---- Where the surface is

template <class Real>
Places Contact<Real>::places(const At& at) const {
  return {surface_, at.model, at.u, at.v};
}

template <class Real>
void Contact<Real>::search(ToolContact& tool, const At& at, double ahead) {
  const Places now = places(at);
  const auto count = static_cast<Eigen::Index>(surface_.points().size());
  scratch_->x.resize(3, count);
  for (Eigen::Index p = 0; p < count; ++p) scratch_->x.col(p) = now.of_point(static_cast<int>(p));
  tool.search(surface_, scratch_->x, at.time, body_moved_, ahead);
}

// Distributes the forces on the points that a tool presses to the vertices of the mesh.
template <class Real>
void Contact<Real>::scatter(const ToolContact& tool, Mat3X<Real>& f) const {
  tool.visit_forces([&](int point, const Vec3d& force) {
    const ContactSurface::Point& surface_point = surface_.points()[std::size_t(point)];
    for (int c = 0; c < surface_point.count; ++c)
      f.col(surface_point.corners[c]) += (surface_point.weights[c] * force).template cast<Real>();
  });
}

template <class Real>
void Contact<Real>::forget_all() {
  for (ToolContact& tool : tools_) tool.forget();
  if (self_) self_->forget();
}

// Forgets what may touch if the state did not come from a step.
template <class Real>
void Contact<Real>::forget_if_replaced(const At& at) {
  if (at.model.revisions.replaced == replaced_) return;
  replaced_ = at.model.revisions.replaced;
  forget_all();
}

// Those that are there, with what may touch them. What they press on is held only where selective masses have
// made contact soft: a hand that leads a tool would get back more energy than it gave.
template <class Real>
template <class Visit>
void Contact<Real>::visit_tools(const At& at, Visit&& visit) {
  if (surface_.revision() == 0) return;  // the body has not been seen
  forget_if_replaced(at);
  ContactLaw own_law = law();
  own_law.hold = surface_.softening() < 1 ? 0.75 * body_damping_ : 0;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    ToolContact& tool = tools_[i];
    if (tool.is_outdated(at.time, body_moved_)) search(tool, at, 0);
    if (tool.points().empty() || !tool.is_there(at.time)) continue;
    const Places now = places(at);
    tool.use(surface_);
    visit(i, tool, ToolContact::At{surface_, own_law, at.time, last_step_, body_moved_, now});
  }
}

template <class Real>
template <class Visit>
void Contact<Real>::visit_self(const At& at, Visit&& visit) {
  if (!self_ || surface_.revision() == 0) return;
  const Places here = places(at);
  const ContactLaw own_law = law();
  const SelfAt now{surface_, own_law, here, body_moved_, last_step_};
  self_->keep_pairs(now);
  visit(now);
}

// ---- A frame

template <class Real>
void Contact<Real>::find_there(double time, std::vector<int>& tools) const {
  tools.clear();
  for (const ToolContact& contact : tools_)
    if (contact.is_there(time)) tools.push_back(contact.tool());
}

template <class Real>
bool Contact<Real>::see_tools(std::span<const ToolBody> bodies, double time) {
  find_there(time, there_before_);
  std::erase_if(tools_, [&](const ToolContact& contact) {
    return !contact.is_obstacle() && std::none_of(bodies.begin(), bodies.end(),
                                                  [&](const ToolBody& body) { return contact.is_of(body); });
  });
  for (const ToolBody& body : bodies) {
    auto found = std::find_if(tools_.begin(), tools_.end(),
                              [&](const ToolContact& tool) { return tool.tool() == body.tool; });
    if (found == tools_.end()) {
      tools_.emplace_back(body.tool, *body.shape);
      found = tools_.end() - 1;
      for (const OfTool& saved : waiting_)
        if (saved.tool == body.tool) found->memory().set(saved.remembered);
    }
    found->begin_frame(body, time);
  }
  std::sort(tools_.begin(), tools_.end(),
            [](const ToolContact& a, const ToolContact& b) { return a.tool() < b.tool(); });
  waiting_.clear();
  on_tools_.clear();
  for (const ToolContact& tool : tools_)
    if (!tool.is_obstacle()) on_tools_.push_back({.tool = tool.tool()});
  find_there(time, there_);
  return there_ != there_before_;
}

// Searched with room for the whole frame, so that look_ahead() finds all that may be touched in it.
template <class Real>
void Contact<Real>::see_body(const BodyView& now, const At& at) {
  if (surface_.is_outdated(now)) {
    surface_.rebuild(now);
    for (ToolContact& tool : tools_) tool.forget();
    if (self_) self_->rebuild(surface_, now.model);
  }
  forget_if_replaced(at);
  const double until = end_of_frame(at.time);  // a world that was restored is in no frame
  for (ToolContact& tool : tools_)
    if (tool.is_outdated(until, body_moved_)) search(tool, at, tool.moves_until(at.time, until));
  for (ToolContact& tool : tools_) tool.look_ahead(until);
}

// By where things are now, whenever they were searched, so that a restored world wakes and expands the same.
template <class Real>
void Contact<Real>::look_ahead(const At& at) {
  const double until = end_of_frame(at.time);
  touched_.clear();
  const auto take = [&](int triangle) {
    for (int p : surface_.triangles()[std::size_t(triangle)].points) {
      const ContactSurface::Point& surface_point = surface_.points()[std::size_t(p)];
      touched_.insert(touched_.end(), surface_point.corners.begin(),
                      surface_point.corners.begin() + surface_point.count);
    }
  };
  for (const ToolContact& tool : tools_) {
    if (tool.points().empty() || !(tool.is_there(at.time) || tool.is_there(until))) continue;
    tool.visit_close(places(at), at.time, until, take);
  }
  visit_self(at, [&](const SelfAt& here) {
    self_->visit_close(here, take, [&](const Eigen::Vector4i& corners) {
      touched_.insert(touched_.end(), corners.begin(), corners.end());
    });
  });
  sort_unique(touched_);
}

// ---- Forces

template <class Real>
void Contact<Real>::add_forces(const At& at, Mat3X<Real>& f) {
  for (OnTool& on_tool : on_tools_) on_tool = {.tool = on_tool.tool};
  visit_memories([](ContactMemory& memory) { memory.begin_forces(); });
  visit_tools(at, [&](std::size_t i, ToolContact& tool, const ToolContact::At& here) {
    tool.find_forces(here);
    if (!tool.is_obstacle()) on_tools_[i - setup_.obstacles.size()] = tool.on_tool();
    scatter(tool, f);
  });
  visit_self(at, [&](const SelfAt& here) {
    scratch_->self_forces.begin(surface_, f.cols());
    self_->add_forces(here, scratch_->self_forces);
    scratch_->self_forces.end(f);
  });
}

namespace {

void add_to_vertex(Index vertex, double share, const Mat3<double>& K, DiagonalStiffness& sum) {
  auto column = sum.col(vertex);
  column[0] += share * K(0, 0);
  column[1] += share * K(0, 1);
  column[2] += share * K(0, 2);
  column[3] += share * K(1, 1);
  column[4] += share * K(1, 2);
  column[5] += share * K(2, 2);
}

void add_to_point(const ContactSurface::Point& point, double weight, const Mat3<double>& K,
                  DiagonalStiffness& sum) {
  for (int c = 0; c < point.count; ++c)
    add_to_vertex(point.corners[c], point.count == 1 ? weight * weight : std::abs(weight * point.weights[c]),
                  K, sum);
}

}  // namespace

template <class Real>
void Contact<Real>::add_diagonal_stiffness(const At& at, DiagonalStiffness& sum) {
  visit_tools(at, [&](std::size_t, ToolContact& tool, const ToolContact::At& here) {
    tool.visit_stiffness(here, [&](int place, double weight, const Mat3<double>& K) {
      add_to_point(surface_.points()[std::size_t(tool.points()[std::size_t(place)])], weight, K, sum);
    });
  });
  const double ahead = end_of_frame(at.time) - at.time;
  const bool is_at_end = ahead <= 1e-9 * (frame_end_ - frame_begin_);
  if (!self_ || surface_.body_count() < 2 || is_at_end) return add_self_stiffness(at, sum);
  find_soon(at, ahead);
  DiagonalStiffness &now = scratch_->now, &later = scratch_->later;
  now.setZero(6, sum.cols());
  add_self_stiffness(at, now);
  for (Index v = 0; v < sum.cols(); ++v) {
    const auto size = [v](const DiagonalStiffness& K) { return K(0, v) + K(3, v) + K(5, v); };
    sum.col(v) += size(later) > size(now) ? later.col(v) : now.col(v);
  }
}

template <class Real>
void Contact<Real>::add_self_stiffness(const At& at, DiagonalStiffness& sum) {
  visit_self(at, [&](const SelfAt& here) {
    self_->visit_stiffness(
        here,
        [&](int point, double weight, const Mat3<double>& K) {
          add_to_point(surface_.points()[std::size_t(point)], weight, K, sum);
        },
        [&](Index vertex, double weight, const Mat3<double>& K) {
          add_to_vertex(vertex, weight * weight, K, sum);
        });
  });
}

// What bodies that move on as they do now would touch at the end of the frame. So the step limit knows of a
// touch before it happens, and the frame is not run again.
template <class Real>
void Contact<Real>::find_soon(const At& at, double ahead) {
  scratch_->later.setZero(6, at.u.cols());
  scratch_->soon = at.u + Real(ahead) * at.v;
  self_->leave_path();
  add_self_stiffness({at.model, scratch_->soon, at.v, at.time}, scratch_->later);
  self_->leave_path();
}

template <class Real>
double Contact<Real>::energy(const At& at) {
  double sum = 0;
  visit_tools(at,
              [&](std::size_t, ToolContact& tool, const ToolContact::At& here) { sum += tool.energy(here); });
  visit_self(at, [&](const SelfAt& here) { sum += self_->energy(here); });
  return sum;
}

// ---- What was before

template <class Real>
template <class Visit>
void Contact<Real>::visit_memories(Visit&& visit) {
  if (self_) visit(self_->memory());
  for (ToolContact& tool : tools_) visit(tool.memory());
}

template <class Real>
void Contact<Real>::begin_steps() {
  step_at_start_ = last_step_;
  visit_memories([](ContactMemory& memory) { memory.keep(); });
}

template <class Real>
void Contact<Real>::take_back_steps() {
  last_step_ = step_at_start_;
  visit_memories([](ContactMemory& memory) { memory.take_back(); });
  forget_all();
}

template <class Real>
void Contact<Real>::end_step(double farthest, double dt) {
  body_moved_ += farthest;
  last_step_ = dt;
  visit_memories([](ContactMemory& memory) { memory.end_step(); });
}

template <class Real>
std::string Contact<Real>::save() const {
  io::ByteWriter out;
  out.put(last_step_);
  io::put(out, touched_);
  io::put(out, self_ ? self_->memory().remembered() : Remembered());
  out.put(std::uint64_t(tools_.size()));
  for (const ToolContact& tool : tools_) {
    out.put(tool.tool());
    io::put(out, tool.memory().remembered());
  }
  return out.bytes();
}

template <class Real>
void Contact<Real>::load(const std::string& saved, Index vertices) {
  io::ByteReader in("checkpoint", saved);
  const auto last_step = in.get<double>();
  in.expect(last_step >= 0 && std::isfinite(last_step));
  std::vector<Index> touched;
  io::get(in, touched);
  in.expect(std::is_sorted(touched.begin(), touched.end()) &&
            (touched.empty() || (touched.front() >= 0 && touched.back() < vertices)));
  Remembered of_self;
  io::get(in, of_self);
  std::vector<OfTool> found(in.get_count(1));
  for (OfTool& own : found) {
    own.tool = in.get<int>();
    io::get(in, own.remembered);
  }
  in.expect_end();
  waiting_ = std::move(found);
  last_step_ = last_step;
  touched_ = std::move(touched);
  if (self_) self_->memory().set(of_self);
  std::erase_if(tools_, [](const ToolContact& contact) { return !contact.is_obstacle(); });
  for (ToolContact& tool : tools_)
    for (const OfTool& own : waiting_)
      if (own.tool == tool.tool()) tool.memory().set(own.remembered);
  forget_all();
  on_tools_.clear();
}

template class Contact<float>;
template class Contact<double>;

}  // namespace lobe
