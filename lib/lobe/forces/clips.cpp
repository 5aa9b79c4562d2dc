#include "lobe/forces/clips.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lobe/error.h"
#include "lobe/forces/saved_terms.h"
#include "lobe/text.h"

namespace lobe {
namespace {

// The distance l at which a pair is held [m].
double held_at(const ClipSetup& clip, const ClipSetup::Pair& pair, double time) {
  const double closed = std::clamp((time - clip.since) / clip_closing_time, 0.0, 1.0);
  return clip.shape.gap + std::max(0.0, pair.apart - clip.shape.gap) * (1 - closed);
}

double spring_of(const ClipSetup& clip) {  // of each pair [N/m]
  return clip.shape.stiffness / double(clip.pairs.size());
}

bool is_left(const ClipSetup::Pair& pair, const Topology& topology) {
  return exists(pair.from, topology) && exists(pair.to, topology);
}

// Calls visit(clip, pair, way, beyond) for each pair: from `from` to `to` [m], and d − l [m].
template <class Real, class Visit>
void for_each_pair(const std::vector<ClipSetup>& clips, const typename ForceTerm<Real>::At& at,
                   Visit&& visit) {
  const Elements& elements = at.model.elements;
  for (const ClipSetup& clip : clips)
    for (const ClipSetup::Pair& pair : clip.pairs) {
      const Vec3d way = position<Real>(pair.to, elements, at.u) - position<Real>(pair.from, elements, at.u);
      visit(clip, pair, way, way.norm() - held_at(clip, pair, at.time));
    }
}

}  // namespace

template <class Real>
Clips<Real>::Clips(const Setup& setup) : carriers_(setup.carriers) {
  state_.clips = setup.clips;
  state_.open.assign(carriers_.size(), 0);
}

template <class Real>
bool Clips<Real>::has(ToolId tool, int number) const {
  return std::any_of(state_.clips.begin(), state_.clips.end(),
                     [&](const ClipSetup& clip) { return clip.tool == tool && clip.number == number; });
}

template <class Real>
void Clips<Real>::add(const ClipSetup& clip, const ClipClosure& closure) {
  state_.clips.push_back(clip);
  has_changed_ = true;
  double widest = 0;
  for (const ClipSetup::Pair& pair : clip.pairs) widest = std::max(widest, pair.apart);
  state_.events.push_back(
      {Event::Kind::clipped, clip.since, closure.position, widest,
       "clip \"" + clip.name + "\" closes on " + rounded(1e3 * widest) + " mm of tissue"});
}

// ---- Forces

template <class Real>
void Clips<Real>::add_forces(const At& at, Mat3X<Real>& f) {
  const Topology& topology = at.model.elements.topology;
  for_each_pair<Real>(state_.clips, at,
                      [&](const ClipSetup& clip, const auto& pair, const Vec3d& way, double beyond) {
                        if (!(beyond > 0)) return;
                        const Vec3d pull = spring_of(clip) * beyond * way.normalized();
                        add_force<Real>(pair.from, topology, pull, f);
                        add_force<Real>(pair.to, topology, -pull, f);
                      });
}

// The sum of a row, as springs between equal masses need it.
template <class Real>
void Clips<Real>::add_diagonal_stiffness(const At& at, DiagonalStiffness& K) {
  const Topology& topology = at.model.elements.topology;
  for (const ClipSetup& clip : state_.clips)
    for (const ClipSetup::Pair& pair : clip.pairs) {
      const double sum = pair.from.weights.cwiseAbs().sum() + pair.to.weights.cwiseAbs().sum();
      for (const EmbeddedPoint* end : {&pair.from, &pair.to}) {
        const Eigen::Vector4i corners = topology.corners(end->tet);
        for (int c = 0; c < 4; ++c)
          for (const int entry : {0, 3, 5})
            K(entry, corners[c]) += sum * std::abs(end->weights[c]) * spring_of(clip);
      }
    }
}

template <class Real>
double Clips<Real>::energy(const At& at) {
  double sum = 0;
  for_each_pair<Real>(state_.clips, at, [&](const ClipSetup& clip, const auto&, const Vec3d&, double beyond) {
    sum += spring_of(clip) / 2 * std::max(0.0, beyond) * std::max(0.0, beyond);
  });
  return sum;
}

template <class Real>
std::vector<Index> Clips<Real>::acts_on(const Model& model) const {
  std::vector<Index> vertices;
  for (const ClipSetup& clip : state_.clips)
    for (const ClipSetup::Pair& pair : clip.pairs)
      for (const EmbeddedPoint* end : {&pair.from, &pair.to}) {
        const Eigen::Vector4i corners = model.elements.topology.corners(end->tet);
        vertices.insert(vertices.end(), corners.begin(), corners.end());
      }
  return vertices;
}

// ---- Cuts of the tissue

template <class Real>
void Clips<Real>::follow(const Topology& topology, const MeshEdit& edit) {
  has_changed_ = true;
  for (ClipSetup& clip : state_.clips) {
    std::erase_if(clip.pairs, [&](const ClipSetup::Pair& pair) { return !is_left(pair, topology); });
    for (const TetCopy& made : edit.copies)
      if (std::find(clip.squeezed.begin(), clip.squeezed.end(), made.tet) != clip.squeezed.end())
        clip.squeezed.push_back(made.copy);
  }
}

template <class Real>
void Clips<Real>::follow_grains(const Elements& elements, const Grains& grains, const MeshEdit& edit) {
  for (ClipSetup& clip : state_.clips)
    for (ClipSetup::Pair& pair : clip.pairs)
      for (EmbeddedPoint* end : {&pair.from, &pair.to}) follow_division(*end, elements, grains, edit);
}

// ---- What there is to see

template <class Real>
std::vector<Event> Clips<Real>::take_events() {
  return std::exchange(state_.events, {});
}

template <class Real>
std::vector<ClipFigures> Clips<Real>::figures(const At& at) const {
  std::vector<ClipFigures> all;
  for (const ClipSetup& clip : state_.clips) {
    ClipFigures& figures = all.emplace_back(ClipFigures{clip.name, Index(clip.pairs.size())});
    for_each_pair<Real>({clip}, at, [&](const ClipSetup&, const auto&, const Vec3d& way, double beyond) {
      figures.apart = std::max(figures.apart, way.norm());
      figures.force += spring_of(clip) * std::max(0.0, beyond);
    });
  }
  return all;
}

template <class Real>
std::vector<CarrierFigures> Clips<Real>::carriers() const {
  std::vector<CarrierFigures> all;
  for (std::size_t i = 0; i < carriers_.size(); ++i)
    all.push_back({carriers_[i].body, carriers_[i].carries, state_.open[i]});
  return all;
}

// Both legs, through the points where they press, and their hinge.
template <class Real>
std::vector<TermLines> Clips<Real>::lines(const At& at) const {
  std::vector<TermLines> all;
  for (std::size_t i = 0; i < state_.clips.size(); ++i) {
    const ClipSetup& clip = state_.clips[i];
    if (clip.pairs.empty()) continue;
    std::vector<std::pair<Vec3d, Vec3d>> pairs;
    for (const ClipSetup::Pair& pair : clip.pairs)
      pairs.emplace_back(position<Real>(pair.from, at.model.elements, at.u),
                         position<Real>(pair.to, at.model.elements, at.u));
    TermLines& lines = all.emplace_back(TermLines{term_name, clip.name, int(i)});
    lines.ends.resize(3, Eigen::Index(4 * pairs.size() - 2));
    Eigen::Index next = 0;
    const auto draw = [&](const Vec3d& from, const Vec3d& to) {
      lines.ends.col(next++) = from;
      lines.ends.col(next++) = to;
      lines.tensions.push_back(0);
    };
    draw(pairs[0].first, pairs[0].second);
    for (std::size_t k = 1; k < pairs.size(); ++k) {
      draw(pairs[k - 1].first, pairs[k].first);
      draw(pairs[k - 1].second, pairs[k].second);
    }
  }
  return all;
}

template <class Real>
void Clips<Real>::add_to_setup(const Elements&, const CompactMesh& left, Setup& setup) const {
  for (ClipSetup clip : state_.clips) {
    if (clip.pairs.empty()) continue;
    for (ClipSetup::Pair& pair : clip.pairs)
      for (EmbeddedPoint* end : {&pair.from, &pair.to}) end->tet = left.tet_target[end->tet];
    std::erase_if(clip.squeezed, [&](Index tet) { return left.tet_target[tet] < 0; });
    for (Index& tet : clip.squeezed) tet = left.tet_target[tet];
    setup.clips.push_back(std::move(clip));
  }
  for (CarrierSetup carrier : carriers_) {
    std::erase_if(carrier.fed, [&](Index vertex) { return left.vertex_target[vertex] < 0; });
    for (Index& vertex : carrier.fed) vertex = left.vertex_target[vertex];
    if (!carrier.fed.empty()) setup.carriers.push_back(std::move(carrier));
  }
}

template <class Real>
std::string Clips<Real>::save() const {
  io::ByteWriter out;
  io::put(out, state_.clips);
  io::put(out, state_.open);
  io::put(out, state_.events);
  return out.bytes();
}

template <class Real>
void Clips<Real>::load(const std::string& saved, Index) {
  io::ByteReader in("checkpoint", saved);
  State found;
  io::get(in, found.clips);
  io::get(in, found.open);
  io::get(in, found.events);
  in.expect_end();
  in.expect(found.open.size() == carriers_.size());
  for (const ClipSetup& clip : found.clips)
    in.expect(clip.shape.fault().empty() && std::isfinite(clip.since));
  state_ = std::move(found);
  has_changed_ = true;
}

template <class Real>
NewTerm<Real> ClipSetup::make_term(const Setup& setup) {
  return std::make_shared<Clips<Real>>(setup);
}
template NewTerm<float> ClipSetup::make_term(const Setup&);
template NewTerm<double> ClipSetup::make_term(const Setup&);

template class Clips<float>;
template class Clips<double>;

}  // namespace lobe
