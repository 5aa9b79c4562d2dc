#include "lobe/contact/contact.h"

#include <algorithm>
#include <cmath>

#include "lobe/io/fields.h"
#include "lobe/sort_unique.h"

namespace lobe {

template <class Real>
Contact<Real>::Contact(const ContactSetup& setup) : setup_(setup) {
  if (setup.self) self_ = std::make_unique<SelfContact>(setup.friction);
  for (const ObstacleSetup& obstacle : setup.obstacles)
    tools_.emplace_back(static_cast<int>(tools_.size()) - static_cast<int>(setup.obstacles.size()), obstacle);
}

// ---- Where the surface is

template <class Real>
Vec3d Contact<Real>::position(const At& at, int point) const {
  const ContactSurface::Point& own = surface_.points()[std::size_t(point)];
  const auto x = [&](Index v) -> Vec3d {
    return at.model.elements.points.col(v) + at.u.col(v).template cast<double>();
  };
  if (own.count == 1) return x(own.corners[0]);
  Vec3d sum = Vec3d::Zero();
  for (int i = 0; i < own.count; ++i) sum += own.weights[i] * x(own.corners[i]);
  return sum;
}

template <class Real>
Vec3d Contact<Real>::velocity(const At& at, int point) const {
  const ContactSurface::Point& own = surface_.points()[std::size_t(point)];
  Vec3d sum = Vec3d::Zero();
  for (int i = 0; i < own.count; ++i)
    sum += own.weights[i] * at.v.col(own.corners[i]).template cast<double>();
  return sum;
}

template <class Real>
void Contact<Real>::find_all(const At& at) const {
  const auto count = static_cast<Eigen::Index>(surface_.points().size());
  all_.resize(3, count);
  for (Eigen::Index p = 0; p < count; ++p) all_.col(p) = position(at, static_cast<int>(p));
  if (x_.cols() >= count) return;
  x_.resize(3, count);
  v_.resize(3, count);
}

template <class Real>
void Contact<Real>::search(ToolContact& tool, const At& at, double ahead) const {
  find_all(at);
  tool.search(surface_, all_, at.time, body_moved_, ahead);
}

template <class Real>
void Contact<Real>::search_self(const At& at) const {
  find_all(at);
  const Index count = at.model.elements.topology.vertex_count();
  all_of_mesh_.resize(3, count);
  for (Index v = 0; v < count; ++v)
    all_of_mesh_.col(v) = at.model.elements.points.col(v) + at.u.col(v).template cast<double>();
  self_->search(surface_, at.model, all_, all_of_mesh_, body_moved_);
}

template <class Real>
void Contact<Real>::gather(const std::vector<int>& points, const At& at) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    x_.col(Eigen::Index(i)) = position(at, points[i]);
    v_.col(Eigen::Index(i)) = velocity(at, points[i]);
  }
}

// What was found for these points, to the vertices of the mesh.
template <class Real>
void Contact<Real>::scatter(const std::vector<int>& points, Mat3X<Real>& f) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ContactSurface::Point& own = surface_.points()[std::size_t(points[i])];
    const Vec3d force = f_.col(Eigen::Index(i));
    for (int c = 0; c < own.count; ++c)
      f.col(own.corners[c]) += (own.weights[c] * force).template cast<Real>();
  }
}

// A state that did not come from a step may be anywhere.
template <class Real>
void Contact<Real>::forget_if_given(const At& at) const {
  if (at.model.revisions.given == given_) return;
  given_ = at.model.revisions.given;
  for (ToolContact& tool : tools_) tool.forget();
  if (self_) self_->forget();
}

// Those that are there, with what may touch them.
template <class Real>
template <class Visit>
void Contact<Real>::visit_tools(const At& at, Visit&& visit) const {
  if (surface_.revision() == 0) return;  // the body has not been seen
  forget_if_given(at);
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    ToolContact& tool = tools_[i];
    if (tool.is_outdated(at.time, body_moved_)) search(tool, at, 0);
    if (tool.points().empty() || !tool.is_there(at.time)) continue;
    gather(tool.points(), at);
    visit(i, tool, ToolContact::At{surface_, law(), at.time, x_, v_});
  }
}

template <class Real>
template <class Visit>
void Contact<Real>::visit_self(const At& at, Visit&& visit) const {
  if (!self_ || surface_.revision() == 0) return;
  if (self_->is_outdated(body_moved_)) search_self(at);
  if (self_->points().empty()) return;
  gather(self_->points(), at);
  const auto count = static_cast<Eigen::Index>(self_->vertices().size());
  if (of_mesh_.cols() < count) {
    of_mesh_.resize(3, count);
    v_of_mesh_.resize(3, count);
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const Index v = self_->vertices()[std::size_t(i)];
    of_mesh_.col(i) = at.model.elements.points.col(v) + at.u.col(v).template cast<double>();
    if (self_->has_friction()) v_of_mesh_.col(i) = at.v.col(v).template cast<double>();
  }
  visit(SelfContact::At{surface_, law(), x_, v_, of_mesh_, v_of_mesh_, last_step_});
}

// ---- A frame

template <class Real>
std::vector<int> Contact<Real>::there(double time) const {
  std::vector<int> tools;
  for (const ToolContact& own : tools_)
    if (own.is_there(time)) tools.push_back(own.tool());
  return tools;
}

template <class Real>
bool Contact<Real>::see_tools(std::span<const ToolBody> bodies, double time) {
  const std::vector<int> before = there(time);
  std::erase_if(tools_, [&](const ToolContact& own) {
    return !own.is_obstacle() &&
           std::none_of(bodies.begin(), bodies.end(), [&](const ToolBody& body) { return own.is_of(body); });
  });
  for (const ToolBody& body : bodies) {
    auto own = std::find_if(tools_.begin(), tools_.end(),
                            [&](const ToolContact& tool) { return tool.tool() == body.tool; });
    if (own == tools_.end()) {
      tools_.emplace_back(body.tool, *body.shape);
      own = tools_.end() - 1;
      for (const KeptAnchors& kept : kept_)
        if (kept.tool == body.tool) own->set_anchors(kept.anchors);
    }
    own->begin_frame(body, time);
  }
  std::sort(tools_.begin(), tools_.end(),
            [](const ToolContact& a, const ToolContact& b) { return a.tool() < b.tool(); });
  kept_.clear();
  on_tools_.clear();
  for (const ToolContact& tool : tools_)
    if (!tool.is_obstacle()) on_tools_.push_back({.tool = tool.tool()});
  return there(time) != before;
}

// Searched with room for the whole frame, so that touched() is known before its steps.
template <class Real>
void Contact<Real>::see_surroundings(const Surroundings& now, const At& at) {
  if (surface_.is_outdated(now)) {
    surface_.rebuild(now);
    for (ToolContact& tool : tools_) tool.forget();
    if (self_) self_->rebuild(surface_, now.model);
  }
  forget_if_given(at);
  const double until = std::max(frame_end_, at.time);  // a world that was restored is in no frame
  for (ToolContact& tool : tools_)
    if (tool.is_outdated(until, body_moved_)) search(tool, at, tool.moves_until(at.time, until));
  if (self_ && self_->is_outdated(body_moved_)) search_self(at);
  find_touched(at, until);
}

// By where things are now, whenever they were searched, so that a restored world wakes and expands the same.
template <class Real>
void Contact<Real>::find_touched(const At& at, double until) {
  touched_.clear();
  const auto take = [&](int triangle) {
    for (int p : surface_.triangles()[std::size_t(triangle)].points) {
      const ContactSurface::Point& own = surface_.points()[std::size_t(p)];
      touched_.insert(touched_.end(), own.corners.begin(), own.corners.begin() + own.count);
    }
  };
  for (const ToolContact& tool : tools_) {
    if (tool.points().empty() || !(tool.is_there(at.time) || tool.is_there(until))) continue;
    gather(tool.points(), at);
    tool.visit_close(x_, at.time, until, take);
  }
  visit_self(at, [&](const SelfContact::At& here) {
    self_->visit_close(here, take, [&](const Eigen::Vector4i& places) {
      for (int i : places) touched_.push_back(self_->vertices()[std::size_t(i)]);
    });
  });
  sort_unique(touched_);
}

// ---- Forces

template <class Real>
void Contact<Real>::add_forces(const At& at, Mat3X<Real>& f) {
  for (OnTool& own : on_tools_) own = {.tool = own.tool};
  const auto begin = [&](const std::vector<int>& points) {
    if (f_.cols() < x_.cols()) f_.resize(3, x_.cols());
    f_.leftCols(Eigen::Index(points.size())).setZero();
  };
  visit_tools(at, [&](std::size_t i, ToolContact& tool, const ToolContact::At& here) {
    begin(tool.points());
    tool.add_forces(here, f_);
    if (!tool.is_obstacle()) on_tools_[i - setup_.obstacles.size()] = tool.on_tool();
    scatter(tool.points(), f);
  });
  visit_self(at, [&](const SelfContact::At& here) {
    begin(self_->points());
    const std::vector<Index>& vertices = self_->vertices();
    if (f_of_mesh_.cols() < of_mesh_.cols()) f_of_mesh_.resize(3, of_mesh_.cols());
    f_of_mesh_.leftCols(Eigen::Index(vertices.size())).setZero();
    self_->add_forces(here, f_, f_of_mesh_);
    scatter(self_->points(), f);
    if (!self_->has_friction()) return;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      f.col(vertices[i]) += f_of_mesh_.col(Eigen::Index(i)).template cast<Real>();
  });
}

template <class Real>
void Contact<Real>::add_diagonal_stiffness(const At& at, DiagonalStiffness& sum) const {
  const auto add_to_vertex = [&](Index vertex, double share, const Mat3<double>& K) {
    auto column = sum.col(vertex);
    column[0] += share * K(0, 0);
    column[1] += share * K(0, 1);
    column[2] += share * K(0, 2);
    column[3] += share * K(1, 1);
    column[4] += share * K(1, 2);
    column[5] += share * K(2, 2);
  };
  const auto add_to = [&](int point, double weight, const Mat3<double>& K) {
    const ContactSurface::Point& own = surface_.points()[std::size_t(point)];
    for (int c = 0; c < own.count; ++c)
      add_to_vertex(own.corners[c], own.count == 1 ? weight * weight : std::abs(weight * own.weights[c]), K);
  };
  visit_tools(at, [&](std::size_t, ToolContact& tool, const ToolContact::At& here) {
    tool.visit_stiffness(here, [&](int place, double weight, const Mat3<double>& K) {
      add_to(tool.points()[std::size_t(place)], weight, K);
    });
  });
  visit_self(at, [&](const SelfContact::At& here) {
    self_->visit_stiffness(
        here,
        [&](int place, double weight, const Mat3<double>& K) {
          add_to(self_->points()[std::size_t(place)], weight, K);
        },
        [&](int place, double weight, const Mat3<double>& K) {
          add_to_vertex(self_->vertices()[std::size_t(place)], weight * weight, K);
        });
  });
}

template <class Real>
double Contact<Real>::energy(const At& at) const {
  double sum = 0;
  visit_tools(at, [&](std::size_t, const ToolContact& tool, const ToolContact::At& here) {
    sum += tool.energy(here);
  });
  visit_self(at, [&](const SelfContact::At& here) { sum += self_->energy(here); });
  return sum;
}

// ---- What was before

template <class Real>
void Contact<Real>::begin_steps() {
  kept_step_ = last_step_;
  if (self_) self_->keep_anchors();
  for (ToolContact& tool : tools_) tool.keep_anchors();
}

template <class Real>
void Contact<Real>::take_back_steps() {
  last_step_ = kept_step_;
  if (self_) self_->take_back();
  for (ToolContact& tool : tools_) tool.take_back();
}

template <class Real>
void Contact<Real>::end_step(double farthest, double dt) {
  body_moved_ += farthest;
  last_step_ = dt;
  if (self_) self_->end_step();
  for (ToolContact& tool : tools_) tool.end_step();
}

template <class Real>
std::string Contact<Real>::save() const {
  io::ByteWriter out;
  out.put(last_step_);
  io::put(out, self_ ? self_->anchors() : Anchors());
  out.put(std::uint64_t(tools_.size()));
  for (const ToolContact& tool : tools_) {
    out.put(tool.tool());
    io::put(out, tool.anchors());
  }
  return out.bytes();
}

template <class Real>
void Contact<Real>::load(const std::string& kept, Index) {
  io::ByteReader in("checkpoint", kept);
  const auto last_step = in.get<double>();
  in.expect(last_step >= 0 && std::isfinite(last_step));
  Anchors of_self;
  io::get(in, of_self);
  std::vector<KeptAnchors> found(in.get_count(1));
  for (KeptAnchors& own : found) {
    own.tool = in.get<int>();
    io::get(in, own.anchors);
  }
  in.expect_end();
  kept_ = std::move(found);
  last_step_ = last_step;
  if (self_) self_->set_anchors(of_self);
  std::erase_if(tools_, [](const ToolContact& own) { return !own.is_obstacle(); });
  for (ToolContact& tool : tools_)
    for (const KeptAnchors& own : kept_)
      if (own.tool == tool.tool()) tool.set_anchors(own.anchors);
  on_tools_.clear();
}

template class Contact<float>;
template class Contact<double>;

}  // namespace lobe
