#include "lobe/live/sewing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/error.h"
#include "lobe/live/pick.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr double rounding_of_points = 1e-6;  // as far outside of the tissue a point still is in it [m]

void expect_in_sewing(bool is_right, const char* what) {
  if (!is_right) throw InputError("thread", what);
}

template <class Real>
FoundPoint find_tissue(World<Real>& world, const Vec3d& x) {
  const Mat3X<Real> u = world.displacements();
  return embed_now<Real>(x, world.elements(), world.grains(), u);
}

// Null: the world has none of this number.
template <class Real>
const Thread* thread_of(World<Real>& world, int number) {
  const Threads<Real>* threads = term_of<Threads>(world.body().terms);
  if (!threads) return nullptr;
  const auto at = std::find_if(threads->all().begin(), threads->all().end(),
                               [&](const Thread& thread) { return thread.number == number; });
  return at == threads->all().end() ? nullptr : &*at;
}

// The least distance between a ray and a segment [m].
double distance_to_ray(const Vec3d& a, const Vec3d& b, const Vec3d& origin, const Vec3d& along) {
  const auto from_ray = [&](const Vec3d& x) { return Vec3d(x - origin - along.dot(x - origin) * along); };
  const Vec3d p = from_ray(a), way = from_ray(b) - p;
  const double square = way.squaredNorm(),
               share = square > 0 ? std::clamp(-p.dot(way) / square, 0.0, 1.0) : 0;
  const Vec3d nearest = a + share * (b - a);
  return along.dot(nearest - origin) < 0 ? std::numeric_limits<double>::infinity() : (p + share * way).norm();
}

}  // namespace

// ---- What a hand shows

template <class Real>
EmbeddedPoint tissue_at(World<Real>& world, const Vec3d& x) {
  expect_in_sewing(x.allFinite(), "passes a point that is not finite");
  const FoundPoint found = find_tissue(world, x);
  if (found.distance > rounding_of_points)
    throw InputError("thread", "passes a point that is " + rounded(found.distance) +
                                   " m outside of every tetrahedron: a thread passes through tissue");
  return found.point;
}

template <class Real>
EmbeddedPoint tissue_below(World<Real>& world, const Vec3d& origin, const Vec3d& direction, double depth) {
  expect_in_sewing(origin.allFinite() && direction.allFinite() && direction.norm() > 0,
                   "is shown by a ray that must be finite, with a direction other than 0");
  expect_in_sewing(depth > 0 && std::isfinite(depth), "must pass more than 0 m below the surface");
  const SurfaceMesh& surface = world.surface().mesh();
  Mat3X<Real> x;
  update_positions(surface, world.elements().points.view(), world.displacements(), x);
  const std::optional<RayHit> hit = cast_ray(surface, x, origin, direction);
  if (!hit) throw InputError("thread", "is shown a place where there is no tissue");
  const Eigen::Vector3i& corners = surface.triangles[std::size_t(hit->triangle)];
  const auto corner = [&](int i) { return Vec3d(x.col(corners[i]).template cast<double>()); };
  const Vec3d outwards = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
  const FoundPoint found = find_tissue(world, hit->point - depth * outwards);
  if (found.distance > rounding_of_points)
    throw InputError("thread", "passes " + rounded(depth) + " m below the surface, which is " +
                                   rounded(found.distance) + " m outside of the tissue: it is thinner there");
  return found.point;
}

template <class Real>
ThreadPart thread_near(World<Real>& world, const Vec3d& origin, const Vec3d& direction, double within) {
  expect_in_sewing(origin.allFinite() && direction.allFinite() && direction.norm() > 0 && within > 0,
                   "is shown by a ray that must be finite, with a direction other than 0");
  ThreadPart nearest{.distance = within};
  const Threads<Real>* threads = term_of<Threads>(world.body().terms);
  if (!threads) return nearest;
  const Vec3d along = direction.normalized();
  const Mat3X<Real> u = world.displacements();
  const auto place = [&](const ThreadBite& bite) { return position(bite.point, world.elements(), u); };
  for (const Thread& thread : threads->all()) {
    if (!thread.is_sewn) continue;
    const auto look = [&](std::size_t from, std::size_t to, std::size_t after) {
      const double distance =
          distance_to_ray(place(thread.bites[from]), place(thread.bites[to]), origin, along);
      if (distance < nearest.distance) nearest = {thread.number, thread.bites[after].number, distance};
    };
    for (std::size_t i = 0; i < thread.spans.size(); ++i)
      if (!thread.spans[i].is_cut) look(i, i + 1, i);
    for (const ThreadKnot& knot : thread.knots)
      look(std::size_t(knot.from), std::size_t(knot.to), std::size_t(knot.to) - 1);
  }
  return nearest;
}

// Behind a knot there is one end.
double hand_pull(const Thread& thread) {
  if (!thread.hand.holds) return 0;
  return thread.hand.tail.tension + (thread.knots.empty() ? thread.hand.head.tension : 0);
}

// ---- Any thread

template <class Real>
Sewing<Real>::Sewing(Session<Real>& session, Send send, const HandLimits& limits)
    : session_(session), send_(std::move(send)), limits_(limits) {
  session.between_frames([&] { session.add_hook(*this); });
}

template <class Real>
Sewing<Real>::~Sewing() {
  session_.between_frames([&] { session_.remove_hook(*this); });
  for (const Pulled& pulled : pulled_)
    if (!pulled.is_tied) send(Pull{pulled.thread, false});
}

template <class Real>
bool Sewing<Real>::send(const Edit& edit) {
  return send_({.kind = HandCommand::Kind::edit, .body_edit = std::make_shared<const Edit>(edit)});
}

template <class Real>
auto Sewing<Real>::find(int thread) -> Pulled* {
  const auto at = std::find_if(pulled_.begin(), pulled_.end(),
                               [&](const Pulled& pulled) { return pulled.thread == thread; });
  return at == pulled_.end() ? nullptr : &*at;
}

template <class Real>
bool Sewing<Real>::bring(int thread, const ThreadMaterial& material) {
  return send(BringThread{thread, material});
}

template <class Real>
bool Sewing<Real>::bite_at(int thread, const Vec3d& x) {
  Bite bite{thread, {}};
  session_.between_frames([&] { bite.point = tissue_at(session_.world(), x); });
  return send(bite);
}

template <class Real>
bool Sewing<Real>::bite_below(int thread, const Vec3d& origin, const Vec3d& direction, double depth) {
  Bite bite{thread, {}};
  session_.between_frames([&] { bite.point = tissue_below(session_.world(), origin, direction, depth); });
  return send(bite);
}

template <class Real>
bool Sewing<Real>::pull(int thread, const Vec3d& point) {
  expect_in_sewing(point.allFinite(), "is pulled to a point that is not finite");
  const auto lead = [&] {
    Pulled* pulled = find(thread);
    if (!pulled) return false;
    pulled->along.setZero();
    pulled->filter.aim({.position = point});
    return true;
  };
  {
    const std::lock_guard lock(mutex_);
    if (lead()) return true;
  }
  Pulled pulled{.thread = thread, .filter = PoseFilter(point), .waits = 1};
  session_.between_frames([&] { pulled.replaced = session_.world().body().model.revisions.replaced; });
  const std::lock_guard lock(mutex_);
  if (lead()) return true;
  if (!send(Pull{thread, true, point})) return false;
  pulled_.push_back(pulled);
  return true;
}

template <class Real>
bool Sewing<Real>::pull_on(int thread, const Vec3d& direction, double force, double speed) {
  expect_in_sewing(direction.allFinite() && direction.norm() > 0,
                   "is pulled in a direction that must be finite, and other than 0");
  expect_in_sewing(force > 0 && std::isfinite(force) && speed > 0 && std::isfinite(speed),
                   "is pulled with a force and a speed that must be above 0, and finite");
  const std::lock_guard lock(mutex_);
  Pulled* pulled = find(thread);
  if (!pulled)
    throw InputError("thread " + std::to_string(thread), "is in no hand: pull it to a point first");
  pulled->along = direction.normalized();
  pulled->force = force;
  pulled->speed = std::min(speed, limits_.top_speed);
  pulled->moved = pulled->stiffness = 0;
  return true;
}

template <class Real>
bool Sewing<Real>::let_go(int thread) {
  const std::lock_guard lock(mutex_);
  const Pulled* pulled = find(thread);
  if (!pulled || pulled->is_tied) return true;
  if (!send(Pull{thread, false})) return false;
  std::erase_if(pulled_, [&](const Pulled& other) { return other.thread == thread; });
  return true;
}

// A knot takes the ends out of the hand; until the world has it, the hand sends nothing more.
template <class Real>
bool Sewing<Real>::tie(int thread, Index from, Index to, double tighten, double over) {
  const std::lock_guard lock(mutex_);
  if (!send(Tie{thread, from, to, tighten, over})) return false;
  if (Pulled* pulled = find(thread)) {
    pulled->is_tied = true;
    pulled->waits = 1;
  }
  return true;
}

template <class Real>
bool Sewing<Real>::cut(int thread, Index after) {
  return send(CutThread{thread, after});
}

template <class Real>
bool Sewing<Real>::cut_near(const Vec3d& origin, const Vec3d& direction, double within) {
  ThreadPart part;
  session_.between_frames([&] { part = thread_near(session_.world(), origin, direction, within); });
  if (part.thread < 0)
    throw InputError("thread", "is shown a place where none passes within " + rounded(within) + " m");
  return cut(part.thread, part.after);
}

template <class Real>
bool Sewing<Real>::remove(int thread) {
  std::vector<Index> bites;
  session_.between_frames([&] {
    const Thread* found = thread_of(session_.world(), thread);
    if (!found) throw InputError("thread " + std::to_string(thread), "there is none of this number");
    for (const ThreadBite& bite : found->bites) bites.push_back(bite.number);
  });
  return std::all_of(bites.begin(), bites.end(), [&](Index bite) { return cut(thread, bite); });
}

// ---- The thread of the session

// What the world knows of a hand is what was sent before the last frame. One that the world does not have
// holding by then was refused, has tied, or its thread has broken or torn out: messages say so.
template <class Real>
void Sewing<Real>::before_frame(Hands<Real>&, World<Real>& world, double duration) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t replaced = world.body().model.revisions.replaced;
  std::erase_if(pulled_, [&](Pulled& pulled) {
    const Thread* thread = thread_of(world, pulled.thread);
    const bool holds = thread && thread->hand.holds;
    // Between two frames that is a return to another state, at which all hands let go.
    const bool has_gone_back = pulled.replaced != replaced;
    if (has_gone_back && holds) send(Pull{pulled.thread, false});  // by what was sent before
    if (has_gone_back || (!holds && pulled.waits == 0)) return true;
    if (pulled.waits > 0)
      --pulled.waits;
    else
      pulled.is_tied = false;  // that was refused
    pulled.last = std::exchange(pulled.tension, thread ? hand_pull(*thread) : 0);
    return false;
  });
  for (Pulled& pulled : pulled_)
    if (!pulled.is_tied) move(pulled, duration);
}

template <class Real>
void Sewing<Real>::move(Pulled& pulled, double duration) {
  if (!pulled.along.isZero(0)) {
    pulled.moved = way(pulled, duration);
    pulled.filter = PoseFilter(pulled.filter.pose().position + pulled.moved * pulled.along);
    if (pulled.moved == 0) return;
  } else if (!pulled.filter.step(duration, limits_)) {
    return;
  }
  send(
      Pull{pulled.thread, true, pulled.filter.pose().position});  // if the queue is full, the next frame will
}

// As far as a spring of the stiffness that it has met needs for a quarter of the force that is missing. A
// quarter, since the tension answers two frames later.
template <class Real>
double Sewing<Real>::way(Pulled& pulled, double duration) const {
  constexpr double share = 0.25, forgets = 0.9, none = 1e-9;  // [m]
  const double most = pulled.speed * duration, missing = pulled.force - pulled.tension;
  if (std::abs(pulled.moved) > none)
    pulled.stiffness = std::max(forgets * pulled.stiffness, (pulled.tension - pulled.last) / pulled.moved);
  if (!(pulled.stiffness > 0)) return missing > 0 ? most : 0;
  return std::clamp(share * missing / pulled.stiffness, -most, most);
}

template <class Real>
void Sewing<Real>::after_frame(Hands<Real>& hands, World<Real>& world, double) {
  const std::lock_guard lock(mutex_);
  for (Pulled& pulled : pulled_) pulled.replaced = world.body().model.revisions.replaced;
  std::erase_if(pulled_, [&](const Pulled& pulled) {
    const Thread* thread = thread_of(world, pulled.thread);
    if (!thread || !thread->hand.holds || pulled.is_tied) return false;
    const double force = hand_pull(*thread);
    if (force <= limits_.force_cap || !send(Pull{pulled.thread, false})) return false;
    hands.say("slipped", "thread " + std::to_string(pulled.thread) +
                             " slipped out of the hand, pulled with " + rounded(force) + " N, more than " +
                             rounded(limits_.force_cap) + " N");
    return true;
  });
}

#define LOBE_INSTANTIATE(Real)                                                           \
  template EmbeddedPoint tissue_at(World<Real>&, const Vec3d&);                          \
  template EmbeddedPoint tissue_below(World<Real>&, const Vec3d&, const Vec3d&, double); \
  template ThreadPart thread_near(World<Real>&, const Vec3d&, const Vec3d&, double);     \
  template class Sewing<Real>;
LOBE_INSTANTIATE(float)
LOBE_INSTANTIATE(double)
#undef LOBE_INSTANTIATE

}  // namespace lobe
