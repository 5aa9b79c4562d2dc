// Tensions of massless elastic cables that pass through points, with friction (theory, section 20).
//
// A span s runs from point p to point q. Its natural length is l, its stretched length S, its unit vector t,
// and its tension T = EA/l ⟨S − l⟩. Tensions are those at the end of a step of dt:
//   (l/EA) T_s + dt push Σ_r A_sr T_r = S_s + dt t_s · (v_q − v_p) − l_s,  A_sr = t_s · M⁻¹_sr t_r,
// where v are the velocities that the points would have without the cables. M⁻¹_sr says how the ends of s
// answer to forces on the ends of r. So the stiffness of a cable is no limit to the step.
//
// Where a cable passes a point it turns by θ, and slips as soon as the tensions of the two spans differ by
// more than e^(μθ): T₂ = T₁ e^(μθ) while it slips from 1 to 2. Spans that slip into each other are a run. A
// run has one unknown tension, and its equation is the sum of those of its spans, in which the slip cancels.
// So the law of the capstan holds to rounding. Which points slip is found by trying.
//
// A point of tissue gives way along the force F on it as soon as |F| is above what the tissue holds.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "lobe/types.h"

namespace lobe {

class Cables {
 public:
  struct Span {
    Index p = 0, q = 0;    // points
    double stiffness = 0;  // EA [N]
    double friction = 0;   // μ where it passes q into the next span of its chain
    double length = 0;     // l [m]
    double tension = 0;    // T [N]
    int slip = 0;          // slip at q: 1 to the next span, −1 from it, 0: it sticks
    // Results of the last solution:
    double stretched = 0;         // S [m]
    Vec3d along = Vec3d::Zero();  // t, from p to q
    double longer = 0;            // growth of l [m]
    // What a span of this tension loses with a length that slips out of it [J/m]: its work, and its energy.
    double energy_per_length(double T) const { return T + T * T / (2 * stiffness); }
    double compliance(double l) const { return std::max(l, shortest) / stiffness; }  // [m/N]
  };
  static constexpr double shortest = 1e-4;  // [m]: shorter spans have the stiffness of this length
  // Spans that pass into each other: [begin, end) in order. If it is closed, the last passes into the first.
  struct Chain {
    Index begin = 0, end = 0;
    bool is_closed = false;
  };
  struct Point {
    Vec3d x = Vec3d::Zero();  // [m]
    Vec3d v = Vec3d::Zero();  // velocity at the end of the step without the cables [m/s]
    double holds = std::numeric_limits<double>::infinity();  // force that the tissue bears [N]
    // Results of the last solution:
    Vec3d force = Vec3d::Zero();  // force of the cables on it [N]
    double way = 0;               // distance by which it gives way along its force [m]
    Vec3d along = Vec3d::Zero();  // direction in which it gives way
  };
  // Energy that the last solution lost [J].
  struct Losses {
    double friction = 0, cut = 0;
  };

  void clear();
  Index add_point(double holds = std::numeric_limits<double>::infinity());
  void add_chain(const std::vector<Span>& spans, bool is_closed);
  // Finds which spans act on each other. mobility(a, b) is the velocity that a force on point b gives to
  // point a, per force and time, by axis [1/kg].
  template <class Mobility>
  void couple(const Mobility& mobility);

  bool empty() const { return spans_.empty(); }
  std::vector<Point>& points() { return points_; }
  const std::vector<Point>& points() const { return points_; }
  std::vector<Span>& spans() { return spans_; }
  const std::vector<Span>& spans() const { return spans_; }

  void place();       // S and t of each span, from the positions of the points
  void sum_forces();  // adds the tensions up to forces on points
  // Finds tensions, slips and forces on points. Without mobility and at dt = 0: of points that do not move.
  void solve(double dt, double push);  // times [s], [s]
  // Takes the slips over into the natural lengths. Their sum stays the same in each chain.
  Losses slip();
  double energy() const;  // energy at the lengths of place() [J]

 private:
  struct Coupling {
    Index span = 0;
    Vec3d mobility = Vec3d::Zero();  // [1/kg]
  };
  struct Run {
    Index begin = 0, end = 0;  // range in order_
    double tension = 0;        // tension of its first span
    double compliance = 0;     // compliance of its equation
    bool is_taut = false;
  };

  // Chains that share a point, or act on each other by mobility. Each cluster is solved by itself.
  struct Cluster {
    Index chains_begin = 0, chains_end = 0;  // range in chains_of_
    Index points_begin = 0, points_end = 0;  // range in points_of_
    Index begin = 0, spans = 0;              // its spans in order_; its runs begin there in runs_
    Index runs_end = 0;                      // end in runs_
  };

  void find_clusters();
  void list_clusters();
  template <class Visit>  // visit(number of a span), chain by chain
  void for_spans(const Cluster& cluster, const Visit& visit) const {
    for (Index i = cluster.chains_begin; i < cluster.chains_end; ++i) {
      const Chain& chain = chains_[std::size_t(chains_of_[std::size_t(i)])];
      for (Index s = chain.begin; s < chain.end; ++s) visit(std::size_t(s));
    }
  }
  std::span<Run> runs(const Cluster& cluster) {
    return std::span(runs_).subspan(std::size_t(cluster.begin),
                                    std::size_t(cluster.runs_end - cluster.begin));
  }
  void find_friction();
  void stick_one(const Chain& chain);
  void find_runs(Cluster& cluster);
  void find_runs_of(const Chain& chain, Cluster& cluster, Index& at);
  void find_compliance(Run& run);
  void find_tensions(const Cluster& cluster);
  void assemble(std::span<Run> own);
  double missing(std::span<const Run> own, std::size_t i) const;
  void solve_taut(std::span<Run> own);
  // The place of the entry (i, j) of A in matrix_ and factor_, whose rows have 2 band_ + 1 entries.
  std::size_t place_in_band(std::size_t i, std::size_t j) const { return i * 2 * band_ + j + band_; }
  double residual(Index span) const;
  bool find_slips(const Cluster& cluster);
  bool change_slips(const Chain& chain);
  void slip_run(const Run& run, Losses& losses);
  bool give_way(const Cluster& cluster);
  double give_way_slope(const Cluster& cluster, Index point) const;
  void solve_slips(Cluster& cluster);
  void sum_forces(const Cluster& cluster);
  bool update_compliances(const Cluster& cluster);
  Index next(const Chain& chain, Index span) const {
    if (span + 1 < chain.end) return span + 1;
    return chain.is_closed ? chain.begin : -1;
  }

  std::vector<Point> points_;
  std::vector<Span> spans_;
  std::vector<Chain> chains_;
  std::vector<Index> coupling_begin_ = {0};  // begin of each span in couplings_; and the end
  std::vector<Coupling> couplings_;
  std::vector<Vec3d> mobilities_;  // mobility of points on each other, scratch of couple()
  // Scratch of a step:
  std::vector<double> inertance_;   // dt push A, per coupling [m/N]
  std::vector<double> wanted_;      // the right-hand side, per span [m]
  std::vector<double> compliance_;  // l/EA, per span [m/N]
  std::vector<double> ratio_;       // e^(μθ) at q of each span
  std::vector<double> share_;       // T of a span over that of its run's first
  std::vector<double> through_;     // the slip at q into the next span [m]
  // The equations A T = b of a cluster's runs:
  std::size_t band_ = 0;                 // distance of entries of A from its diagonal
  std::vector<double> matrix_, factor_;  // [m/N]
  std::vector<double> right_;            // [m]
  std::vector<Index> order_;             // spans, run by run
  std::vector<Index> run_of_;            // run of each span
  std::vector<Run> runs_;                // runs of a cluster, from its `begin` on
  std::vector<Cluster> clusters_;        // clusters in the order of their first chains; none: not found yet
  std::vector<Index> chains_of_, points_of_;       // cluster by cluster, ascending
  std::vector<Index> root_, chain_of_, chain_at_;  // one per chain, span, point: scratch of find_clusters()
};

template <class Mobility>
void Cables::couple(const Mobility& mobility) {
  couplings_.clear();
  coupling_begin_.assign(1, 0);
  const auto count = Index(points_.size());
  mobilities_.resize(std::size_t(count) * std::size_t(count));
  const auto of = [&](Index a, Index b) -> Vec3d& { return mobilities_[std::size_t(a * count + b)]; };
  for (Index a = 0; a < count; ++a)
    for (Index b = 0; b <= a; ++b) of(a, b) = of(b, a) = mobility(a, b);
  for (const Span& s : spans_) {
    for (Index r = 0; r < Index(spans_.size()); ++r) {
      const Span& other = spans_[std::size_t(r)];
      const Vec3d sum = of(s.q, other.q) - of(s.q, other.p) - of(s.p, other.q) + of(s.p, other.p);
      if (sum != Vec3d::Zero()) couplings_.push_back({r, sum});
    }
    coupling_begin_.push_back(Index(couplings_.size()));
  }
  find_clusters();
}

}  // namespace lobe
