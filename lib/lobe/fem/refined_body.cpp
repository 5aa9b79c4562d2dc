#include "lobe/fem/refined_body.h"

namespace lobe {
namespace {

template <class Value>
void inherit(const RefinedMesh& refined, std::vector<Value>& values) {
  if (values.empty()) return;
  std::vector<Value> fine;
  fine.reserve(refined.parent_of.size());
  for (const Index parent : refined.parent_of) fine.push_back(values[std::size_t(parent)]);
  values = std::move(fine);
}

}  // namespace

Body refined_body(const Body& body, const RefinedMesh& refined) {
  Body fine = body;
  fine.mesh = refined.mesh;
  inherit(refined, fine.material_of);
  inherit(refined, fine.region_of);
  inherit(refined, fine.shares);
  return fine;
}

}  // namespace lobe
