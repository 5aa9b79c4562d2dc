#include "lobe/contact/anchors.h"

#include <algorithm>

namespace lobe {

int Anchors::add(const FaceOwner& owner, int divisions) {
  const auto first = static_cast<int>(at.size());
  triangles.push_back({owner.tet, owner.code, divisions, first});
  at.resize(at.size() + std::size_t(divisions) * std::size_t(divisions), Vec3d::Zero());
  holds.resize(at.size(), 0);
  return first;
}

void Anchors::take_over(const Anchors& old) {
  const auto before = [](const OfTriangle& a, const OfTriangle& b) {
    return std::pair(a.tet, a.code) < std::pair(b.tet, b.code);
  };
  auto from = old.triangles.begin();
  for (const OfTriangle& own : triangles) {
    while (from != old.triangles.end() && before(*from, own)) ++from;
    if (from == old.triangles.end()) return;
    if (before(own, *from) || from->divisions != own.divisions) continue;
    const int count = own.divisions * own.divisions;
    std::copy_n(old.at.begin() + from->first, count, at.begin() + own.first);
    std::copy_n(old.holds.begin() + from->first, count, holds.begin() + own.first);
  }
}

bool Anchors::is_valid() const {
  std::size_t points = 0;
  for (const OfTriangle& own : triangles) {
    if (own.divisions < 1 || own.divisions > 1000 || std::size_t(own.first) != points) return false;
    points += std::size_t(own.divisions) * std::size_t(own.divisions);
  }
  return at.size() == points && holds.size() == points &&
         std::all_of(at.begin(), at.end(), [](const Vec3d& x) { return x.allFinite(); });
}

}  // namespace lobe
