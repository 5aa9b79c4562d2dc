#include "lobe/forces/attachments.h"

#include <algorithm>
#include <cmath>

#include "lobe/error.h"

namespace lobe {
namespace {

// 1 − D of a strand whose largest elongation so far is m [m].
double intact_share(const AttachmentSetup& attachment, double m) {
  const double holds = attachment.holds_until, c = attachment.softening;
  if (m <= holds) return 1;
  return m < c * holds ? (c * holds - m) / ((c - 1) * m) : 0;
}

// What damage has taken up in a strand whose largest elongation so far is m [J].
double damage_energy(const AttachmentSetup& attachment, const StrandSetup& strand, double m) {
  const double holds = attachment.holds_until, c = attachment.softening;
  if (m <= holds) return 0;
  const double beyond = std::min(m, c * holds) - holds;
  return strand.stiffness / 2 * c * holds * beyond / (c - 1);
}

double energy_of(const AttachmentSetup& attachment, const StrandSetup& strand, double elongation) {
  const double intact = intact_share(attachment, std::max(strand.reached, elongation));
  return elongation > 0 ? intact * strand.stiffness / 2 * elongation * elongation : 0;
}

double tension_of(const AttachmentSetup& attachment, const StrandSetup& strand, double elongation) {
  const double intact = intact_share(attachment, std::max(strand.reached, elongation));
  return std::max(0.0, intact * strand.stiffness * elongation);
}

}  // namespace

template <class Real>
Attachments<Real>::Attachments(const Setup& setup) {
  for (const AttachmentSetup& attachment : setup.attachments)
    state_.attachments.emplace_back().now = attachment;
}

// ---- What is done to attachments

template <class Real>
void Attachments<Real>::attach(const AttachmentSetup& attachment, const Topology& topology) {
  const std::string whose = "attachment \"" + attachment.name + "\"";
  attachment.check([](bool holds, const std::string& fault) {
    if (!holds) throw InputError("command", fault);
  });
  const auto same = std::find_if(state_.attachments.begin(), state_.attachments.end(),
                                 [&](const Attachment& other) { return other.now.name == attachment.name; });
  const bool is_known = same != state_.attachments.end();
  if (is_known && !same->now.strands.empty()) throw InputError(whose, "there is one of this name already");
  for (const StrandSetup& strand : attachment.strands)
    if (!exists(strand.from, topology) || !(strand.ends_in_world() || exists(strand.to, topology)))
      throw InputError(whose, "has an end in a tetrahedron that does not exist");
  (is_known ? *same : state_.attachments.emplace_back()).now = attachment;
  is_arranged_ = false;
}

template <class Real>
void Attachments<Real>::detach(const std::string& name, const At& at) {
  for (Attachment& attachment : state_.attachments)
    if (attachment.now.name == name) return cut(attachment, &at, [](const StrandSetup&) { return true; });
  throw InputError("attachment \"" + name + "\"", "there is none of this name");
}

template <class Real>
template <class IsGone>
void Attachments<Real>::cut(Attachment& attachment, const At* at, IsGone&& is_gone) {
  const std::size_t removed = std::erase_if(attachment.now.strands, [&](const StrandSetup& strand) {
    if (!is_gone(strand)) return false;
    StrandsGone& gone = attachment.cut;
    ++gone.count;
    gone.area += strand.area;
    const double elongation = at ? elongation_of(strand, *at) : 0;
    gone.energy += damage_energy(attachment.now, strand, std::max(strand.reached, elongation)) +
                   energy_of(attachment.now, strand, elongation);
    return true;
  });
  if (removed > 0) is_arranged_ = false;
}

template <class Real>
void Attachments<Real>::sever(const SweptVolume& volume, const At& at) {
  if (!volume.crosses) return;
  for (Attachment& attachment : state_.attachments)
    cut(attachment, &at, [&](const StrandSetup& strand) {
      const Ends ends = ends_of(strand, at);
      Eigen::AlignedBox3d box(ends.from);
      box.extend(ends.to);
      return volume.box.intersects(box) && volume.crosses(ends.from, ends.to);
    });
}

// ---- Strands

template <class Real>
typename Attachments<Real>::Ends Attachments<Real>::ends_of(const StrandSetup& strand, const At& at) {
  const Elements& elements = at.model.elements;
  return {position(strand.from, elements, at.u),
          strand.ends_in_world() ? strand.anchor : position(strand.to, elements, at.u)};
}

template <class Real>
double Attachments<Real>::elongation_of(const StrandSetup& strand, const At& at) {
  const Ends ends = ends_of(strand, at);
  return (ends.to - ends.from).norm() - strand.length;
}

template <class Real>
void Attachments<Real>::arrange(const Elements& elements) {
  if (is_arranged_) return;
  strands_.clear();
  for (std::size_t a = 0; a < state_.attachments.size(); ++a) {
    const AttachmentSetup& attachment = state_.attachments[a].now;
    for (std::size_t i = 0; i < attachment.strands.size(); ++i) {
      add_strand(attachment, attachment.strands[i], elements);
      strands_.back().attachment = Index(a);
      strands_.back().number = Index(i);
    }
  }
  is_arranged_ = true;
}

// One that ends in the world has weights of 0 there.
template <class Real>
void Attachments<Real>::add_strand(const AttachmentSetup& attachment, const StrandSetup& strand,
                                   const Elements& elements) {
  Strand& made = strands_.emplace_back();
  const EmbeddedPoint& to = strand.ends_in_world() ? strand.from : strand.to;
  const Eigen::Vector4i first = elements.topology.corners(strand.from.tet),
                        second = elements.topology.corners(to.tet);
  for (int c = 0; c < 4; ++c) {
    made.corners[std::size_t(c)] = first[c];
    made.corners[std::size_t(4 + c)] = second[c];
    made.weights[std::size_t(c)] = Real(-strand.from.weights[c]);
    made.weights[std::size_t(4 + c)] = strand.ends_in_world() ? Real(0) : Real(strand.to.weights[c]);
  }
  const Vec3d end = strand.ends_in_world() ? strand.anchor : rest_position(strand.to, elements);
  made.at_rest = (end - rest_position(strand.from, elements)).template cast<Real>();
  made.length = Real(strand.length);
  made.stiffness = Real(strand.stiffness * intact_share(attachment, strand.reached));
  made.unchanged_until = Real(std::max(strand.reached, attachment.holds_until));
}

// In a step: a strand that is longer than it ever was is damaged for good.
template <class Real>
void Attachments<Real>::damage(Strand& strand, double elongation, const At& at) {
  Attachment& attachment = state_.attachments[std::size_t(strand.attachment)];
  StrandSetup& of_state = attachment.now.strands[std::size_t(strand.number)];
  of_state.reached = elongation;
  strand.unchanged_until = Real(elongation);
  strand.stiffness = Real(of_state.stiffness * intact_share(attachment.now, elongation));
  if (strand.stiffness > 0) return;
  const Ends ends = ends_of(of_state, at);
  attachment.places += (ends.from + ends.to) / 2;
  attachment.last = at.time;
  for (StrandsGone* gone : {&attachment.torn, &attachment.torn_since}) {
    ++gone->count;
    gone->area += of_state.area;
    gone->energy += damage_energy(attachment.now, of_state, of_state.reached);
  }
  has_torn_ = true;
}

template <class Real>
void Attachments<Real>::add_forces(const At& at, Mat3X<Real>& f) {
  arrange(at.model.elements);
  const bool is_step = at.kick.dt > 0;
  for (Strand& strand : strands_) {
    Vec3<Real> d = strand.at_rest;
    for (std::size_t c = 0; c < 8; ++c) d += strand.weights[c] * at.u.col(strand.corners[c]);
    const Real length = d.norm(), elongation = length - strand.length;
    if (!(elongation > 0)) continue;
    Real stiffness = strand.stiffness;
    if (elongation > strand.unchanged_until) {
      const Attachment& attachment = state_.attachments[std::size_t(strand.attachment)];
      const StrandSetup& of_state = attachment.now.strands[std::size_t(strand.number)];
      if (is_step) damage(strand, double(elongation), at);
      stiffness = Real(of_state.stiffness * intact_share(attachment.now, double(elongation)));
    }
    const Vec3<Real> pull = (stiffness * elongation / length) * d;
    for (std::size_t c = 0; c < 8; ++c) f.col(strand.corners[c]) -= strand.weights[c] * pull;
  }
}

// The sum of a row of the stiffness, which bounds the frequencies, as if a strand were stiff in all
// directions: across itself it is less stiff than along. Slack ones count, since they may be taut within the
// frame.
template <class Real>
void Attachments<Real>::add_diagonal_stiffness(const At& at, DiagonalStiffness& K) {
  arrange(at.model.elements);
  for (const Strand& strand : strands_) {
    double sum = 0;
    for (const Real weight : strand.weights) sum += std::abs(double(weight));
    for (std::size_t c = 0; c < 8; ++c)
      for (const int entry : {0, 3, 5})
        K(entry, strand.corners[c]) += sum * std::abs(double(strand.weights[c])) * double(strand.stiffness);
  }
}

template <class Real>
double Attachments<Real>::energy(const At& at) {
  double sum = 0;
  for (const Attachment& attachment : state_.attachments)
    for (const StrandSetup& strand : attachment.now.strands)
      sum += energy_of(attachment.now, strand, elongation_of(strand, at));
  return sum;
}

template <class Real>
std::vector<Index> Attachments<Real>::acts_on(const Model& model) const {
  const Topology& topology = model.elements.topology;
  std::vector<Index> vertices;
  for (const Attachment& attachment : state_.attachments)
    for (const StrandSetup& strand : attachment.now.strands)
      for (const EmbeddedPoint* end : {&strand.from, &strand.to}) {
        if (end == &strand.to && strand.ends_in_world()) continue;
        if (!exists(*end, topology))
          throw InputError("checkpoint", "has an attachment in tetrahedron " + std::to_string(end->tet) +
                                             ", which the body does not have");
        for (const Index v : topology.corners(end->tet)) vertices.push_back(v);
      }
  return vertices;
}

template <class Real>
void Attachments<Real>::take_back_steps() {
  state_ = saved_;
  is_arranged_ = has_torn_ = false;
}

template <class Real>
void Attachments<Real>::end_step(double, double) {
  if (!has_torn_) return;
  for (Attachment& attachment : state_.attachments)
    std::erase_if(attachment.now.strands, [&](const StrandSetup& strand) {
      return intact_share(attachment.now, strand.reached) == 0;
    });
  is_arranged_ = has_torn_ = false;
}

// ---- Cuts of the tissue

template <class Real>
void Attachments<Real>::follow(const Topology& topology, const MeshEdit&) {
  for (Attachment& attachment : state_.attachments)
    cut(attachment, nullptr, [&](const StrandSetup& strand) {
      return !exists(strand.from, topology) || !(strand.ends_in_world() || exists(strand.to, topology));
    });
  is_arranged_ = false;
}

template <class Real>
void Attachments<Real>::follow_grains(const Elements& elements, const Grains& grains, const MeshEdit& edit) {
  for (Attachment& attachment : state_.attachments)
    for (StrandSetup& strand : attachment.now.strands) {
      follow_division(strand.from, elements, grains, edit);
      if (!strand.ends_in_world()) follow_division(strand.to, elements, grains, edit);
    }
  is_arranged_ = false;
}

// ---- What there is to see

template <class Real>
std::vector<AttachmentFigures> Attachments<Real>::figures(const At& at) const {
  std::vector<AttachmentFigures> all;
  for (const Attachment& attachment : state_.attachments) {
    AttachmentFigures& figures = all.emplace_back();
    figures.name = attachment.now.name;
    figures.strands = Index(attachment.now.strands.size());
    figures.torn = attachment.torn;
    figures.cut = attachment.cut;
    figures.released = attachment.torn.energy;
    for (const StrandSetup& strand : attachment.now.strands) {
      const double elongation = elongation_of(strand, at);
      figures.area += strand.area;
      figures.tension = std::max(figures.tension, tension_of(attachment.now, strand, elongation));
      figures.stored += energy_of(attachment.now, strand, elongation);
      figures.released += damage_energy(attachment.now, strand, std::max(strand.reached, elongation));
    }
  }
  return all;
}

template <class Real>
std::vector<TermLines> Attachments<Real>::lines(const At& at) const {
  std::vector<TermLines> all;
  for (std::size_t a = 0; a < state_.attachments.size(); ++a) {
    const AttachmentSetup& attachment = state_.attachments[a].now;
    if (attachment.strands.empty()) continue;
    TermLines& lines = all.emplace_back(TermLines{term_name, attachment.name, int(a)});
    lines.ends.resize(3, Eigen::Index(2 * attachment.strands.size()));
    for (std::size_t i = 0; i < attachment.strands.size(); ++i) {
      const StrandSetup& strand = attachment.strands[i];
      const Ends ends = ends_of(strand, at);
      lines.ends.col(Eigen::Index(2 * i)) = ends.from;
      lines.ends.col(Eigen::Index(2 * i + 1)) = ends.to;
      lines.tensions.push_back(tension_of(attachment, strand, (ends.to - ends.from).norm() - strand.length));
      lines.damages.push_back(1 - intact_share(attachment, strand.reached));
    }
  }
  return all;
}

template <class Real>
NewTerm<Real> AttachmentSetup::make_term(const Setup& setup) {
  return std::make_shared<Attachments<Real>>(setup);
}
template NewTerm<float> AttachmentSetup::make_term(const Setup&);
template NewTerm<double> AttachmentSetup::make_term(const Setup&);

template class Attachments<float>;
template class Attachments<double>;

}  // namespace lobe
