// The stable step of a body in motion, 2/ω_max (theory, section 7). ω_max is a vertex estimate, which follows
// cuts, times the ratio that Lanczos iterations have measured.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lobe/numerics/lanczos.h"
#include "lobe/time/dynamics.h"
#include "lobe/time/frequency_ratios.h"
#include "lobe/time/vertex_frequencies.h"

namespace lobe {

template <class Real>
class StepLimit {
 public:
  using Body = Dynamics<Real>;

  // `mean_edge`: displacements far smaller than it are small [m].
  explicit StepLimit(double mean_edge) : mean_edge_(mean_edge) {}

  // Returns the longest stable step Δt at the present state [s]: the positive root of
  //   ω_max² Δt² + 2 c Δt = 4,
  // with c the highest damping rate of force terms [1/s]. Without damping that is 2/ω_max. ω_max counts as
  // at least a quarter of that at rest. Infinite if nothing is free. Costs O(#tetrahedra) if the state has
  // changed since the last call. Cuts are followed locally, except with averages of several tetrahedra.
  double find(Body& body);
  // Finds it from scratch, as a restored world does, so that both get the same bits.
  void find_anew(Body& body);
  // ---- For frames. The limit is found once in each `interval` of simulated time, counted from 0: about a
  // frame of 60 Hz, as a pass over all tetrahedra costs as much as two or three steps. In between the last
  // one is used, while nothing is edited.
  static constexpr double interval = 0.015;  // [s]
  bool holds(const Body& body) const;
  double for_frame(Body& body) { return holds(body) ? frame_limit_.limit : keep(body); }
  double at_end(Body& body);  // limit at the end of a frame; infinite where the last one holds
  // At the start of a frame: whether the limit was found since the start of the last frame, or no longer
  // holds.
  bool is_due(const Body& body) { return std::exchange(frame_limit_.is_new, false) || !holds(body); }
  double keep(Body& body);       // finds it now
  struct FrameLimit {            // part of a checkpoint
    double limit = 0, time = 0;  // limit, and the time when it was found [s]
    bool is_new = true;
    Index limiting_vertex = -1, volume_ratio_tet = -1;
    double volume_ratio = 1;
    bool is_valid() const { return limit >= 0 && std::isfinite(time) && !std::isnan(volume_ratio); }
    static constexpr auto fields =
        std::tuple(&FrameLimit::limit, &FrameLimit::time, &FrameLimit::is_new, &FrameLimit::limiting_vertex,
                   &FrameLimit::volume_ratio_tet, &FrameLimit::volume_ratio);
  };
  const FrameLimit& frame_limit() const { return frame_limit_; }
  void set_frame_limit(const FrameLimit& frame_limit, const Body& body);

  // Call it at the start of a frame. It measures the ratios again if the limit has changed enough.
  void measure_again(Body& body);
  // Measures the ratios of the body at rest, for each degree of selective masses, in the present mode of
  // its regions (Regions::mode).
  void measure_at_rest(Body& body);
  // Call it when inertia or the condensed regions have changed as a whole. Ratios are then those at rest.
  void restart(Body& body);
  void restart_for_degree(Body& body);

  // Follows an edit; call it before the elements do. What a tetrahedron adds to the stiffness at its corners
  // is removed with it, or moves to the copy of a vertex. A pass over everything is needed with averages of
  // several tetrahedra, a pre-computed or reduced region or a force term, and where the tetrahedron of the
  // smallest volume ratio is removed.
  // `shares_before`: a share for each of edit.shares, 0 for a new copy.
  void follow(const Body& body, const MeshEdit& edit, const std::vector<double>& shares_before);
  // Follows a change of the model of a tetrahedron, which change() performs.
  template <class Change>
  void follow_region(const Body& body, Index tet, Change&& change);
  void extend(Index vertices) { ratios_.extend(vertices); }
  // Call it when other vertices are embedded than before: nothing is then measured of the nodes.
  void forget_nodes() {
    forget();
    ratios_.of_nodes = 1;
  }
  void update(const Body& body, Index vertex);  // call it after its inverse mass has changed
  // Makes the next frame find it anew, as after an edit.
  void forget() {
    known_ = Known::nothing;
    frame_limit_at_ = {};
  }

  double bounded_square(Index v) const {  // ω_v² or a bound of it [1/s²]
    return frequencies_.bounded_square(v) / ratios_.square(v);
  }
  // ω_v² times the square of its ratio [1/s²], by which a vertex limits the step. 0 where its bound is
  // not above `least`, and everywhere if the limit was found at an earlier state.
  double limiting_square(const Body& body, Index v, double least) const {
    const bool may_be = is_known(body) && frequencies_.bounded_square(v) > least;
    return may_be ? exact_square(body, v) * ratios_.square(v) : 0;
  }
  std::vector<double> limiting_squares(const Body& body) const;  // of all vertices
  double exact_square(const Body& body, Index v) const {
    return frequencies_.exact_square(v, body.inertia.inverse_mass(v));
  }
  VertexFrequency highest_vertex(Body& body);  // the estimate without ratios, found again
  // The highest frequency at rest with lumped masses, condensed or expanded, whichever is higher [rad/s].
  double highest_at_rest() const { return std::max(at_rest_[0][1].omega, at_rest_[1][1].omega); }
  const HighestFrequency& search() const { return search_; }  // last search at rest
  Index limiting_vertex() const { return frame_limit_.limiting_vertex; }
  double volume_ratio() const {
    return frame_limit_.volume_ratio;
  }  // smallest det F when the limit was last kept
  Index volume_ratio_tet() const { return frame_limit_.volume_ratio_tet; }

  // Highest frequencies of the body at rest, condensed or expanded as it is now [rad/s]: with its masses, and
  // with lumped masses. The ratio is that of the latter to the highest vertex estimate.
  double omega_at_rest(const Body& body) { return at_rest(body).omega; }
  double lumped_omega_at_rest(const Body& body) const { return at_rest_[body.regions.mode()][1].omega; }
  double lumped_ratio_at_rest(const Body& body) const { return at_rest_[body.regions.mode()][1].ratio; }

  // The frequencies of the body as it was set up, and expanded. A body that cannot be expanded has only those
  // with lumped masses, condensed.
  RestFrequencies of_whole_at_rest(int degree, bool is_measured) const {
    const auto& of_degrees = at_rest_[1];
    return {is_measured ? of_degrees[std::size_t(degree)].omega : 0, of_degrees[1].omega,
            of_degrees[1].ratio};
  }

  void count_step() { ratios_.step(); }
  const FrequencyRatios& ratios() const { return ratios_; }
  void set_ratios(const FrequencyRatios& ratios) { ratios_ = ratios; }

 private:
  struct RestFrequency {
    double ratio = 1;  // ω_max / vertex estimate
    double omega = 0;  // ω_max [rad/s]
  };
  enum class Known {
    nothing,
    followed,  // edits were followed since it was found
    anew       // it is what a restored world would find, to the bit
  };

  bool is_known(const Body& body) const {
    const Revisions& now = body.model.revisions;
    return known_ != Known::nothing && found_at_.displacements == now.displacements &&
           found_at_.terms == now.terms;
  }
  double weight(const Body& body, Index v) const { return body.inertia.inverse_mass(v) * ratios_.square(v); }
  template <class Weight>
  void find_frequencies(Body& body, Weight&& weight);
  HighestFrequency search_highest(Body& body, const LanczosSettings& settings);
  HighestFrequency search_with_nodes(Body& body, const LanczosSettings& settings);
  bool nodes_limit(double limit) const { return ratios_.of_nodes * node_omega_ > 1.98 / limit; }
  void measure_degree_at_rest(Body& body);
  RestFrequency& at_rest(const Body& body) {
    return at_rest_[body.regions.mode()][std::size_t(body.inertia.degree_now())];
  }
  static double least_ratio(const Body& body) { return 1.0 / body.inertia.degree_now(); }
  // Whether the stiffness at a vertex is a sum of what each tetrahedron adds, at its displacements.
  static bool is_sum_of_tets(const Body& body) {
    const std::vector<Elastic>& materials = body.model.elements.materials;
    return body.regions.are_all_of_tets() && !any_averages(materials) && !any_viscous(materials);
  }
  static CornerStiffness stiffness_of(const Body& body, Index tet);
  void follow_shares(const Body& body, const MeshEdit& edit, const std::vector<double>& shares_before);

  double mean_edge_;
  VertexFrequencies<Real> frequencies_;  // weighed with ratios_
  FrequencyRatios ratios_;
  // Frequencies at rest in each mode of the regions, with each degree.
  std::array<std::array<RestFrequency, highest_mass_degree + 1>, Regions<Real>::most_modes> at_rest_;
  HighestFrequency search_;
  Known known_ = Known::nothing;
  Revisions found_at_;
  Index limiting_vertex_ = -1;
  double node_omega_ = 0;  // a bound of the frequencies of nodes [rad/s]
  std::vector<double> node_squares_;
  double damping_rate_ = 0;  // rate of force terms [1/s]
  double volume_ratio_ = 1;
  Index volume_ratio_tet_ = -1;
  FrameLimit frame_limit_;
  Revisions frame_limit_at_;
};

template <class Real>
template <class Change>
void StepLimit<Real>::follow_region(const Body& body, Index tet, Change&& change) {
  if (!is_sum_of_tets(body)) forget();
  if (!is_known(body)) {
    forget();
    return change();
  }
  const Eigen::Vector4i corners = body.model.elements.topology.corners(tet);
  frequencies_.subtract(corners, stiffness_of(body, tet));
  change();
  frequencies_.subtract(corners, -stiffness_of(body, tet));
  known_ = Known::followed;
}

extern template class StepLimit<float>;
extern template class StepLimit<double>;

}  // namespace lobe
