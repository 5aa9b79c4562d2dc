// Threads as they are saved, set up again and drawn.
#include <algorithm>

#include "lobe/forces/saved_terms.h"
#include "lobe/forces/threads.h"

namespace lobe {

template <class Real>
std::string Threads<Real>::save() const {
  io::ByteWriter out;
  io::put(out, state_.threads);
  io::put(out, state_.ledger);
  io::put(out, state_.events);
  return out.bytes();
}

template <class Real>
void Threads<Real>::load(const std::string& saved, Index) {
  io::ByteReader in("checkpoint", saved);
  State found;
  io::get(in, found.threads);
  for (std::size_t i = 1; i < found.threads.size(); ++i)
    in.expect(found.threads[i].number > found.threads[i - 1].number);
  io::get(in, found.ledger);
  io::get(in, found.events);
  in.expect_end();
  state_ = std::move(found);
  begin_ = duration_ = time_ = 0;
  due_ = -unlimited;
  has_changed_ = is_arranged_ = is_solved_ = false;
}

// Stitches whose bites are all left. They are sewn anew, and a knot draws its loop in by what it is shorter
// than at rest.
template <class Real>
void Threads<Real>::add_to_setup(const Elements& elements, const CompactMesh& left, Setup& setup) const {
  for (const Thread& thread : state_.threads) {
    if (thread.bites.size() < 2) continue;
    StitchSetup& stitch = setup.stitches.emplace_back();
    stitch.name = thread.name;
    stitch.material = thread.material;
    stitch.at = thread.at;
    std::vector<Vec3d> places;
    for (const ThreadBite& bite : thread.bites) {
      stitch.bites.push_back({left.tet_target[bite.point.tet], bite.point.weights});
      places.push_back(rest_position(bite.point, elements));
    }
    for (const ThreadKnot& knot : thread.knots) {
      const auto from = std::size_t(knot.from), to = std::size_t(knot.to);
      double slack = (places[to] - places[from]).norm() - knot.closing.length;
      for (std::size_t i = from; i < to; ++i)
        slack += (places[i + 1] - places[i]).norm() - thread.spans[i].length;
      stitch.ties.push_back({knot.from, knot.to, thread.at, std::max(0.0, slack) + knot.to_tighten});
    }
    for (const TieSetup& plan : thread.plans)
      if (const Index from = thread.find(plan.from), to = thread.find(plan.to); from >= 0 && to >= 0)
        stitch.ties.push_back({from, to, plan.at, plan.tighten, plan.over});
  }
}

// ---- Drawing

template <class Real>
std::vector<ThreadLine> Threads<Real>::drawn(const At& at) const {
  std::vector<ThreadLine> lines;
  const auto place = [&](const ThreadBite& bite) { return position(bite.point, at.model.elements, at.u); };
  for (const Thread& thread : state_.threads) {
    if (!thread.is_sewn || thread.bites.empty()) continue;
    const auto begin = [&](const Vec3d& x) {
      ThreadLine& line = lines.emplace_back(ThreadLine{thread.number, thread.name, x, {}});
      line.points = x;
    };
    const auto extend = [&](const Vec3d& x, double tension) {
      ThreadLine& line = lines.back();
      line.points.conservativeResize(3, line.points.cols() + 1);
      line.points.rightCols<1>() = x;
      line.tensions.push_back(tension);
    };
    const Vec3d hand = hand_at(thread.hand, at.time);
    const bool has_head = thread.hand.holds && thread.knots.empty() && !thread.is_on_needle();
    begin(has_head ? hand : place(thread.bites.front()));
    if (has_head) extend(place(thread.bites.front()), thread.hand.head.tension);
    for (std::size_t i = 0; i + 1 < thread.bites.size(); ++i) {
      const Vec3d x = place(thread.bites[i + 1]);
      if (thread.spans[i].is_cut)
        begin(x);
      else
        extend(x, thread.spans[i].tension);
    }
    if (thread.hand.holds) extend(hand, thread.hand.tail.tension);
    for (const ThreadKnot& knot : thread.knots) {
      begin(place(thread.bites[std::size_t(knot.to)]));
      extend(place(thread.bites[std::size_t(knot.from)]), knot.closing.tension);
    }
  }
  std::erase_if(lines, [](const ThreadLine& line) { return line.tensions.empty(); });
  return lines;
}

template <class Real>
std::vector<TermLines> Threads<Real>::lines(const At& at) const {
  std::vector<TermLines> all;
  for (const ThreadLine& line : drawn(at)) {
    TermLines& lines = all.emplace_back(TermLines{term_name, line.name, line.thread});
    const Eigen::Index segments = line.points.cols() - 1;
    lines.ends.resize(3, 2 * segments);
    for (Eigen::Index i = 0; i < 2 * segments; ++i) lines.ends.col(i) = line.points.col((i + 1) / 2);
    lines.tensions = line.tensions;
  }
  return all;
}

}  // namespace lobe
