// Stored configurations of a whole body, at earlier or predicted moments, and how much nearer any two of its
// vertices may be now than there.
#pragma once

#include <type_traits>

#include "lobe/contact/gap_kernels.h"
#include "lobe/contact/places.h"

namespace lobe {

class Stations {
 public:
  enum Station { measured, looked };

  // Makes one of where the body will be `ahead` [s] from now, at the present velocities.
  void set(Station station, const Places& now, double ahead);
  // How much nearer any two vertices may be than there, at most [m].
  double range_since(Station station, const Places& now) const;
  double range_of_speeds(const Places& now);  // how much nearer any two may come per time, at most [m/s]
  // Places of vertices there about another vertex. There are four numbers each, of which the last stays as it
  // is [m].
  void of_vertices(Station station, const Places& now, Index origin, const std::vector<Index>& vertices,
                   float* x) const;

 private:
  // Columns that begin at the same place of a line of the cache as others.
  template <class Real>
  class Columns {
   public:
    int count() const { return count_; }
    auto all() { return Eigen::Map<Mat3X<Real>>(numbers_.data() + first_, 3, count_); }
    auto all() const { return Eigen::Map<const Mat3X<Real>>(numbers_.data() + first_, 3, count_); }
    void lie_like(const Mat3X<Real>& other, int count);

   private:
    std::vector<Real> numbers_;
    std::size_t first_ = 0;
    int count_ = 0;
  };
  template <class Real>
  struct Kept {
    Columns<Real> u[2], zeros;  // one column per vertex
  };
  template <class Real, class Self>
  static auto& kept(Self& self) {
    if constexpr (std::is_same_v<Real, float>)
      return self.single_;
    else
      return self.exact_;
  }
  double range(const Mat3X<float>& u, const Columns<float>& from, int count) const;
  double range(const Mat3X<double>& u, const Columns<double>& from, int count) const;

  GapKernels kernels_ = gap_kernels(chosen_instruction_set());
  Kept<float> single_;  // none, as the next, of a body in the other precision
  Kept<double> exact_;
};

}  // namespace lobe
