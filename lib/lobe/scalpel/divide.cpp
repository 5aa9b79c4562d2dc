// Division: the tetrahedra that grains are part of now, and which are beside each other.
#include <algorithm>
#include <iterator>

#include "lobe/assert.h"
#include "lobe/scalpel/division.h"
#include "lobe/sort_unique.h"

namespace lobe {

std::vector<std::pair<Index, Index>> Division::moved_grains() const {
  std::vector<std::pair<Index, Index>> moved;
  for (const Changed& changed : changed_)
    if (changed.element != grains_[changed.grain].element) moved.emplace_back(changed.grain, changed.element);
  std::sort(moved.begin(), moved.end());
  return moved;
}

TetDivision Division::find() {
  for (Index v : vertices_) split(v);
  result_.may_part = may_part();
  for (Index t : changed_tets()) divide(t);
  std::move(new_parts_.begin(), new_parts_.end(), std::back_inserter(parts_));
  find_neighbours();
  return std::move(result_);
}

std::vector<Index> Division::changed_tets() const {
  std::vector<Index> tets;
  for (const Changed& known : changed_)
    if (known.has_new_corners) tets.push_back(known.element);
  sort_unique(tets);
  return tets;
}

// Grains with the same corners are one tetrahedron. What fills most keeps the number, the first of several.
void Division::divide(Index tet) {
  groups_.clear();
  grains_of_tet_.clear();
  for (Index grain : grains_.of(tet)) grains_of_tet_.emplace_back(0, grain);
  std::sort(grains_of_tet_.begin(), grains_of_tet_.end());
  for (auto& [group, grain] : grains_of_tet_) {
    const Corners corners = corners_of(grain);
    while (group < groups_.size() && groups_[group].corners != corners) ++group;
    if (group == groups_.size()) groups_.push_back({corners, 0});
    groups_[group].share += grains_[grain].share;
  }
  const auto most = std::max_element(groups_.begin(), groups_.end(),
                                     [](const Group& a, const Group& b) { return a.share < b.share; });
  const auto keeps = std::size_t(most - groups_.begin());
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const Index number = i == keeps ? tet : topology_.tet_count() + new_tets_++;
    lobe_assert(groups_[i].share > 0, "division: a copy that fills no volume");
    result_.parts.push_back({number, tet, groups_[i].corners, groups_[i].share});
    const auto begin = static_cast<Index>(grains_of_parts_.size());
    for (const auto& [group, grain] : grains_of_tet_) {
      if (group != i) continue;
      grains_of_parts_.push_back(grain);
      if (number != tet) changed(grain).element = number;
    }
    (number == tet ? parts_ : new_parts_)
        .push_back({number, begin, static_cast<Index>(grains_of_parts_.size())});
  }
}

// Of what a face has opened between, of what has other corners or is new, and of what is beside these.
void Division::find_neighbours() {
  const auto grains_of = [this](const Part& part) {
    return std::span<const Index>(grains_of_parts_)
        .subspan(std::size_t(part.begin), std::size_t(part.end - part.begin));
  };
  std::vector<Index> tets;
  tets.reserve(2 * parted_.size() + parts_.size() + 4 * grains_of_parts_.size());
  for (const auto& [a, b] : parted_) {
    if (grains_[a].element == grains_[b].element) continue;
    for (Index grain : {a, b}) tets.push_back(grains_[grain].element);
  }
  for (const Part& part : parts_) {
    tets.push_back(part.tet);
    for (Index grain : grains_of(part))
      for (int f = 0; f < 4; ++f)
        if (const Index other = grains_.neighbour(grain, f); other >= 0) tets.push_back(element_of(other));
  }
  sort_unique(tets);
  result_.neighbours.reserve(tets.size());
  result_.others.reserve(4 * tets.size());
  auto part = parts_.begin();
  for (Index t : tets) {
    while (part != parts_.end() && part->tet < t) ++part;
    const bool is_part = part != parts_.end() && part->tet == t;
    add_neighbours(t, is_part ? grains_of(*part) : grains_.of(t));
  }
}

// Two tetrahedra beside each other differ in one corner, which is opposite to the face that they share.
void Division::add_neighbours(Index tet, std::span<const Index> grains) {
  for (std::vector<Index>& others : across_) others.clear();
  others_.clear();
  const Corners corners = corners_of(grains.front());
  for (Index grain : grains) {
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(grain, f);
      if (other < 0) continue;
      const Changed* changed = find_changed(other);
      const Index element = changed ? changed->element : grains_[other].element;
      if (element == tet || std::find(others_.begin(), others_.end(), element) != others_.end()) continue;
      others_.push_back(element);
      const Corners next = changed ? changed->corners : topology_.corners(element);
      for (int c = 0; c < 4; ++c)
        if (!has(next, corners[c])) across_[std::size_t(c)].push_back(element);
    }
  }
  TetDivision::Neighbours& listed = result_.neighbours.emplace_back();
  listed.tet = tet;
  for (std::size_t f = 0; f < 4; ++f) {
    std::sort(across_[f].begin(), across_[f].end());
    listed.begin[f] = static_cast<Index>(result_.others.size());
    result_.others.insert(result_.others.end(), across_[f].begin(), across_[f].end());
  }
  listed.begin[4] = static_cast<Index>(result_.others.size());
}

TetDivision Grains::divide(const Topology& topology, const std::vector<Index>& opened) {
  Division division(*this, topology, opened, parted_, {scratch_, place_scratch_, vertex_scratch_}, is_whole_);
  TetDivision result = division.find();
  for (const TetDivision::Part& part : result.parts)
    if (of_element_.vertex_count() <= part.tet) {
      of_element_.add_vertex();
      parent_of_copy_.push_back(parent_of(part.of));
    }
  for (const auto& [grain, element] : division.moved_grains()) {
    Grain& moved = grains_[std::size_t(grain)];
    of_element_.erase_value(moved.element, grain);
    of_element_.append(element, grain);
    moved.element = element;
    changed_.push_back(grain);
  }
  parted_.clear();
  return result;
}

}  // namespace lobe
