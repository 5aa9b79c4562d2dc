// The path of a tool. It grows by a row per frame while a hand moves the tool, for hours. A state of the
// world has a copy of each path, and sessions store a state twice a second, so copies share all rows but the
// last few, and the shared rows are packed (file/row_packer.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lobe/shared_chain.h"
#include "lobe/tool/paths.h"

namespace lobe {

class GrowingPath {
 public:
  using Rows = std::vector<PathPoint>;
  static constexpr std::size_t few = 64, most = 256;  // rows at hand

  GrowingPath() = default;
  GrowingPath(Rows rows);  // takes the path of a scene: copies share all rows

  bool empty() const { return recent().empty(); }
  std::size_t size() const;
  const PathPoint& front() const;
  const PathPoint& back() const { return recent().back(); }
  // The end of the path, for path_at() and its like: at least the last `few` rows that were added; all rows
  // if the path has not grown; at least the last two if it is settled. Valid until the path
  // changes.
  const Rows& recent() const { return settled_ ? *settled_ : recent_; }
  Rows all() const;  // O(rows)

  void push_back(const PathPoint& row);  // O(1); once in 192 rows it packs these, which takes some 10 µs
  void forget_after(double time);        // the rows of a frame that failed
  // Call it when the path will hardly grow any more. Copies then share all of it.
  void settle();

  // Saved in files and digests as the list of its rows.
  Rows as_saved() const { return all(); }
  static GrowingPath from_saved(Rows rows) { return GrowingPath(std::move(rows)); }
  std::size_t unshared_bytes() const { return recent_.size() * sizeof(PathPoint); }

 private:
  struct Part {                              // part of the path: packed rows, after those of the part before
    std::shared_ptr<const PathPoint> first;  // row of the path
    std::size_t end = 0;                     // rows of the path up to its last one
    std::size_t count = 0;
    std::string packed;
    void unpack_to(PathPoint* rows) const;
  };

  void reopen();
  void pack(std::size_t count);
  std::size_t past_rows() const { return past_.empty() ? 0 : past_.back().end; }

  SharedChain<Part> past_;               // parts before the rows at hand
  std::shared_ptr<const Rows> settled_;  // the rows at hand, or else:
  Rows recent_;
};

}  // namespace lobe
