// The list of a recording. A session adds to it for hours, in the thread that keeps time. So its entries are
// packed into chunks. A chunk that is full never moves again, and copies of the list share it. Frames in
// which nothing is done take no memory, however many; a pose of a hand takes some 12 to 20 bytes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lobe/file/row_packer.h"
#include "lobe/sim/command.h"

namespace lobe {

// An entry: the world went back to its state after the first `entries` entries of the recording; 0: to its
// start.
struct GoBack {
  std::uint64_t entries = 0;
  static constexpr auto fields = std::tuple(&GoBack::entries);
};

struct RecordedCommand {
  std::variant<Command, GoBack> command;
  // Digest of displacements, velocities and time after it. A session notes it for some of the frames only.
  std::optional<std::uint64_t> digest = {};
};

class CommandLog {
 public:
  CommandLog() = default;
  explicit CommandLog(const std::vector<RecordedCommand>& entries);

  // O(1) for poses and frames; nothing that is there already is copied. `digest` is that of the state after
  // the entry, also where the entry does not note it. Up to 65,535 successive frames of equal length become
  // one run, of which only the last may note it.
  void push_back(const std::variant<Command, GoBack>& command, std::uint64_t digest, bool is_noted = true);

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::uint64_t last_digest() const { return last_digest_; }
  RecordedCommand back() const;  // with its digest in any case; O(chunk), as the next
  RecordedCommand operator[](std::size_t i) const;
  std::vector<RecordedCommand> all() const;
  std::size_t bytes() const;  // size of all chunks

  // Visits the runs: visit(number of the first entry, entry, count). Equal frames are a run, whose last frame
  // has the digest. All others are runs of one.
  void for_each_run(const std::function<void(std::size_t, const RecordedCommand&, std::size_t)>& visit) const;

  class Iterator;  // over the entries, one by one
  Iterator begin() const;
  std::default_sentinel_t end() const { return {}; }

  // The log in a file: the chunks as they are, and the number of entries of each.
  struct Saved {
    std::uint64_t last_digest = 0;
    std::vector<std::string> chunks;
    std::vector<std::uint64_t> sizes;
    static constexpr auto fields = std::tuple(&Saved::last_digest, &Saved::chunks, &Saved::sizes);
  };
  Saved as_saved() const;
  static CommandLog from_saved(const Saved& saved);  // throws InputError for chunks that do not fit

 private:
  struct Chunk {
    std::size_t first = 0;                            // number of its first entry
    std::optional<std::uint64_t> digest_before = {};  // digest of the entry before it, if that one notes it
    std::string bytes;
  };
  // What the entries of a chunk are packed against. It begins anew with each chunk.
  struct Poses {
    ToolId tool = 0;
    io::RowPacker packer = {};
  };
  struct Context {
    std::array<Poses, 16> poses;
    std::uint8_t next_place = 0;  // place for another tool
    double duration = 0;          // duration of the frames [s]
  };
  class Reader;

  void push_frame(double duration, std::optional<std::uint64_t> digest);
  void push_lead(const Lead& lead);
  void push_other(const std::variant<Command, GoBack>& command, std::optional<std::uint64_t> digest,
                  bool is_unchanged);
  void make_room(std::size_t bytes);
  std::size_t chunks() const { return full_.size() + 1; }
  std::size_t end_of(std::size_t chunk_number) const {  // number of the entry after its last one
    return chunk_number < full_.size() ? chunk(chunk_number + 1).first : size_;
  }
  const Chunk& chunk(std::size_t i) const { return i < full_.size() ? *full_[i] : open_; }

  static constexpr std::size_t none = SIZE_MAX;
  std::vector<std::shared_ptr<const Chunk>> full_;
  Chunk open_;
  Context context_;         // context of open_
  std::size_t run_ = none;  // place in open_ of the run that may grow
  std::size_t size_ = 0;
  std::uint64_t last_digest_ = 0;
  std::optional<std::uint64_t> last_noted_ = {};  // digest that the last entry notes
};

class CommandLog::Iterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = RecordedCommand;
  using difference_type = std::ptrdiff_t;
  using pointer = const RecordedCommand*;
  using reference = const RecordedCommand&;

  explicit Iterator(const CommandLog& log, std::size_t from = 0);
  reference operator*() const { return entry_; }
  pointer operator->() const { return &entry_; }
  Iterator& operator++();
  bool operator==(std::default_sentinel_t) const { return left_ == 0; }

 private:
  void next_run();

  std::shared_ptr<Reader> reader_;
  RecordedCommand entry_;
  std::optional<std::uint64_t> digest_;  // digest of the run
  std::size_t left_ = 0;                 // entries of the run, with this one; 0: at the end
};

}  // namespace lobe
