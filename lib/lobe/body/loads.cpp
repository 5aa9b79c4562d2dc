#include "lobe/body/loads.h"

namespace lobe {

template <class Real>
void Loads<Real>::update(const Elements& elements, const std::vector<Index>& vertices,
                         const std::function<double(Index)>& mass) {
  for (Columns* columns : {&external_, &dead_}) columns->extend(elements.topology.vertex_count());
  for (Index v : vertices) {
    dead_.col(v) = loads_.at(elements, v).template cast<Real>();
    external_.col(v) = dead_.col(v) + (mass(v) * gravity_).template cast<Real>();
  }
}

template <class Real>
void Loads<Real>::put(double time, Parallel& parallel, Columns& f) const {
  const double share = missing_share(time);
  parallel.for_ranges(f.count(), 16384, [&](Index begin, Index end) {
    auto columns = f.view().middleCols(begin, end - begin);
    columns = external_.view().middleCols(begin, end - begin);
    if (share > 0) columns -= Real(share) * dead_.view().middleCols(begin, end - begin);
  });
}

template <class Real>
double Loads<Real>::work(const Mat3X<Real>& u) const {
  double sum = 0;
  for (Index v = 0; v < external_.count(); ++v)
    sum += external_.col(v).template cast<double>().dot(u.col(v).template cast<double>());
  return sum;
}

template class Loads<float>;
template class Loads<double>;

}  // namespace lobe
