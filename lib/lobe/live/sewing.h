// Sewing in a session: threads go through points that a hand shows, a hand pulls their ends, and ties them.
// All of it are edits of the body (organ/edit.h), which the session records.
//
//   Sewing<float> sewing(session, [&](const HandCommand& command) { return controller.send(command); });
//   sewing.bring(7, {.strength = 20, .holds = 1.5});
//   sewing.bite_below(7, eye, to_one_lip, 0.004);    // 4 mm below where the ray enters
//   sewing.bite_below(7, eye, to_the_other, 0.004);
//   sewing.pull(7, above);                           // both ends, as a hand moves tools
//   sewing.tie(7, 0, -1);                            // the first and the last bite
#pragma once

#include <functional>
#include <mutex>
#include <vector>

#include "lobe/live/session.h"

namespace lobe {

// The point of the tissue that is at x now [m]. Throws InputError for one outside of every tetrahedron, with
// how far. O(#tets).
template <class Real>
EmbeddedPoint tissue_at(World<Real>& world, const Vec3d& x);

// The point of the tissue `depth` [m] straight below the surface where a ray enters the body. Throws
// InputError if the ray meets nothing, or the tissue is thinner. O(#tets).
template <class Real>
EmbeddedPoint tissue_below(World<Real>& world, const Vec3d& origin,  // [m]
                           const Vec3d& direction,                   // direction, of any length but 0
                           double depth);

// The sewn part of a thread that passes a ray the nearest, within a distance; thread −1: there is none.
struct ThreadPart {
  int thread = -1;
  Index after = -1;     // the bite after which it begins; in a knot's closing span the last bite of its loop
  double distance = 0;  // between the ray and the thread [m]
};
template <class Real>
ThreadPart thread_near(World<Real>& world, const Vec3d& origin, const Vec3d& direction, double within);

// What a hand pulls the ends of a thread with [N]; 0 if no hand has them.
double hand_pull(const Thread& thread);

// What a hand does that sews, in either precision. Any thread may call it. What the hand shows is looked for
// between two frames, and InputError says what is wrong with it; what then cannot be done with a thread, such
// as to tie one that is cut, is a message `refused`. Each returns false if the queue of commands is full.
class SewingHand {
 public:
  virtual ~SewingHand() = default;
  // Takes a thread. Its number is chosen by the caller: at least 0, and of no other thread.
  virtual bool bring(int thread, const ThreadMaterial& material) = 0;
  virtual bool bite_at(int thread, const Vec3d& x) = 0;  // as tissue_at()
  virtual bool bite_below(int thread, const Vec3d& origin, const Vec3d& direction,
                          double depth) = 0;  // as tissue_below()
  // Takes the free ends of a thread in a hand at a point [m], or leads them there. Above the greatest force
  // they slip out of it (message `slipped`).
  virtual bool pull(int thread, const Vec3d& point) = 0;
  // Goes on pulling a thread that a hand holds, along a direction, no faster than `speed` [m/s], until its
  // ends pull with `force` [N].
  virtual bool pull_on(int thread, const Vec3d& direction, double force, double speed) = 0;
  virtual bool let_go(int thread) = 0;
  // Ties a knot between two bites, counted from 0 in the order of sewing; −1 is the last one, −2 that before.
  // A knot that is there already is drawn together by `tighten` [m] more, in the time `over` [s].
  virtual bool tie(int thread, Index from, Index to, double tighten = 0, double over = 0.2) = 0;
  virtual bool cut(int thread, Index after) = 0;  // after a bite, counted likewise
  // Cuts the thread that passes a ray within a distance [m] (thread_near()).
  virtual bool cut_near(const Vec3d& origin, const Vec3d& direction, double within) = 0;
  // Takes a thread out of the tissue: it is cut after each of its bites, and pulls at nothing any more.
  virtual bool remove(int thread) = 0;
};

template <class Real>
class Sewing final : public SewingHand, public SessionHook<Real> {
 public:
  using Send = std::function<bool(const HandCommand&)>;  // sends a command; false: the queue is full

  // Make it between frames of the session, which outlives it, as does the controller of `send`. Hands have
  // the lag, the top speed and the greatest force of `limits`.
  Sewing(Session<Real>& session, Send send, const HandLimits& limits = {});
  ~Sewing() override;  // its hands let go

  bool bring(int thread, const ThreadMaterial& material) override;
  bool bite_at(int thread, const Vec3d& x) override;
  bool bite_below(int thread, const Vec3d& origin, const Vec3d& direction, double depth) override;
  bool pull(int thread, const Vec3d& point) override;
  bool pull_on(int thread, const Vec3d& direction, double force, double speed) override;
  bool let_go(int thread) override;
  bool tie(int thread, Index from, Index to, double tighten = 0, double over = 0.2) override;
  bool cut(int thread, Index after) override;
  bool cut_near(const Vec3d& origin, const Vec3d& direction, double within) override;
  bool remove(int thread) override;

  void before_frame(Hands<Real>& hands, World<Real>& world, double duration) override;
  void after_frame(Hands<Real>& hands, World<Real>& world, double duration) override;

 private:
  struct Pulled {
    int thread = 0;
    PoseFilter filter = {};
    Vec3d along = Vec3d::Zero();   // direction in which it is pulled on; 0: it is led
    double force = 0, speed = 0;   // to be reached [N], at most [m/s]
    double tension = 0, last = 0;  // sum of both ends in the last frame [N], and in the one before
    double moved = 0;              // way of the last frame, along `along` [m]
    double stiffness = 0;          // that it met on its way [N/m]
    int waits = 0;                 // frames until which the world need not know that it holds, or is tied
    bool is_tied = false;          // a knot was asked for
    std::uint64_t replaced = 0;    // the world's revision when it was looked at last
  };

  bool send(const Edit& edit);
  Pulled* find(int thread);
  double way(Pulled& pulled, double duration) const;
  void move(Pulled& pulled, double duration);

  Session<Real>& session_;
  const Send send_;
  const HandLimits limits_;
  std::mutex mutex_;  // lock of what follows
  std::vector<Pulled> pulled_;
};

extern template class Sewing<float>;
extern template class Sewing<double>;

}  // namespace lobe
