// The path of a tool. It grows by a row per frame while a hand moves the tool. A state of the world has a
// copy of each path, and sessions store a state twice a second, so copies share all rows but the last few.
#pragma once

#include <memory>
#include <vector>

#include "lobe/tool/paths.h"

namespace lobe {

class GrowingPath {
 public:
  using Rows = std::vector<PathPoint>;
  static constexpr std::size_t few = 64;

  GrowingPath() = default;
  GrowingPath(Rows rows);  // of a scene: copies share them all

  bool empty() const { return recent().empty(); }
  std::size_t size() const;
  const PathPoint& front() const { return past_.empty() ? recent_.front() : past_.front()->front(); }
  const PathPoint& back() const { return recent().back(); }
  // The end of the path, for path_at() and its like: at least the last `few` rows that were added, and all
  // rows of a path that has not grown. Valid until the path changes.
  const Rows& recent() const { return recent_.empty() && !past_.empty() ? *past_.back() : recent_; }
  Rows all() const;

  // Amortised O(1).
  void push_back(const PathPoint& row);
  void forget_after(double time);  // the rows of a frame that failed
  // Call it when the path will hardly grow any more. Copies then share all of it.
  void settle();

  // In files and digests it is the list of its rows.
  Rows as_saved() const { return all(); }
  static GrowingPath from_saved(Rows rows) { return GrowingPath(std::move(rows)); }
  std::size_t unshared_bytes() const;  // that it does not share

 private:
  void reopen();

  std::vector<std::shared_ptr<const Rows>> past_;  // none of them empty
  Rows recent_;                                    // after those
};

}  // namespace lobe
