#include "lobe/fem/law_fault.h"

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"

namespace lobe {

std::string law_fault(const Elastic& elastic) {
  std::string fault;
  with_solid(elastic.law, [&](auto solid) { fault = solid.fault(nonlinear_law(elastic, 0, 0)); });
  return fault;
}

}  // namespace lobe
