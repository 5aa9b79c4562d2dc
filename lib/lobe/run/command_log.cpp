#include "lobe/run/command_log.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>
#include <utility>

#include "lobe/error.h"
#include "lobe/file/fields.h"
#include "lobe/sim/enum_sizes.h"

namespace lobe {
namespace {

using Entry = std::variant<Command, GoBack>;
using Digest = std::optional<std::uint64_t>;

constexpr std::size_t capacity = 64 << 10;  // of a chunk [bytes]; one with a large command is larger
constexpr std::uint16_t longest_run = 0xffff;

// The first byte of an entry. That of a pose also says at which place its tool is in Context::poses.
struct Tag {
  enum : std::uint8_t { other = 1, back = 2, frame = 3, run = 4, duration = 5, kinds = 15 };
};
struct Flag {
  enum : std::uint8_t { noted = 0x10, unchanged = 0x20, pose = 0x80 };  // unchanged: the digest before holds
};
struct PoseFlag {
  enum : std::uint8_t { opening = 0x10, another_tool = 0x20 };
};

template <class Value>
void put(Value value, std::string& out) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

bool is_about_tools(const Entry& entry) {
  const auto* command = std::get_if<Command>(&entry);
  return command &&
         std::visit([]<class Any>(const Any&) { return std::is_constructible_v<ToolCommand, Any>; },
                    *command);
}

bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

io::PoseNumbers numbers_of(const ToolPose& pose) {
  const Vec3d& x = pose.position;
  const Eigen::Vector4d& q = pose.orientation;
  return {x[0], x[1], x[2], q[0], q[1], q[2], 0, q[3], pose.opening.value_or(0)};
}

}  // namespace

// ---- Writing

CommandLog::CommandLog(const std::vector<RecordedCommand>& entries) {
  for (const RecordedCommand& entry : entries)
    push_back(entry.command, entry.digest.value_or(last_digest_), entry.digest.has_value());
}

void CommandLog::push_back(const Entry& entry, std::uint64_t digest, bool is_noted) {
  const Digest note = is_noted ? Digest(digest) : Digest();
  const bool is_unchanged = !empty() && digest == last_digest_ && is_about_tools(entry);
  const auto* command = std::get_if<Command>(&entry);
  const auto* advance = command ? std::get_if<Advance>(command) : nullptr;
  const auto* lead = command ? std::get_if<Lead>(command) : nullptr;
  if (advance)
    push_frame(advance->duration, note);
  else if (lead && is_unchanged)
    push_lead(*lead);
  else
    push_other(entry, note, is_unchanged);
  if (!is_unchanged) last_noted_ = note;
  last_digest_ = digest;
  ++size_;
}

void CommandLog::push_frame(double length, Digest digest) {
  make_room(32);
  std::string& bytes = open_.bytes;
  if (!same(length, context_.duration)) {
    put(Tag::duration, bytes);
    put(context_.duration = length, bytes);
    run_ = none;
  }
  std::uint16_t count = 0;
  if (run_ != none && bytes[run_] == char(Tag::run))
    std::memcpy(&count, &bytes[run_ + 1], sizeof count);
  else if (run_ != none)
    count = 1;
  if (count == 0 || count == longest_run) {
    run_ = bytes.size();
    put(Tag::frame, bytes);
    count = 0;
  } else if (count == 1) {
    bytes[run_] = char(Tag::run);
    put(std::uint16_t(0), bytes);
  }
  if (++count > 1) std::memcpy(&bytes[run_ + 1], &count, sizeof count);
  if (!digest) return;
  bytes[run_] = char(bytes[run_] | Flag::noted);
  put(*digest, bytes);
  run_ = none;
}

void CommandLog::push_lead(const Lead& lead) {
  make_room(128);
  run_ = none;
  std::uint8_t flags = lead.target.opening ? PoseFlag::opening : 0, place = 0;
  while (place < context_.poses.size() && context_.poses[place].tool != lead.tool) ++place;
  if (place == context_.poses.size()) {
    flags |= PoseFlag::another_tool;
    place = std::exchange(context_.next_place, (context_.next_place + 1) % context_.poses.size());
    context_.poses[place] = {lead.tool};
  }
  put(std::uint8_t(Flag::pose | flags | place), open_.bytes);
  if (flags & PoseFlag::another_tool) put(lead.tool, open_.bytes);
  context_.poses[place].packer.put(numbers_of(lead.target), open_.bytes);
}

void CommandLog::push_other(const Entry& entry, Digest digest, bool is_unchanged) {
  io::ByteWriter out;
  const bool is_back = std::holds_alternative<GoBack>(entry);
  out.put(std::uint8_t((is_back ? Tag::back : Tag::other) | (is_unchanged ? Flag::unchanged
                                                             : digest     ? Flag::noted
                                                                          : 0)));
  std::visit([&](const auto& any) { io::put(out, any); }, entry);
  if (digest && !is_unchanged) out.put(*digest);
  make_room(out.bytes().size());
  run_ = none;
  open_.bytes += out.bytes();
}

// A chunk that is full stays where it is. The next one begins with what it will hold.
void CommandLog::make_room(std::size_t bytes) {
  if (!open_.bytes.empty() && open_.bytes.size() + bytes > capacity) {
    full_.push_back(std::make_shared<const Chunk>(std::move(open_)));
    open_ = {size_, last_noted_, {}};
    context_ = {};
    run_ = none;
  }
  if (open_.bytes.capacity() < capacity) open_.bytes.reserve(std::max(bytes, capacity));
}

std::size_t CommandLog::bytes() const {
  std::size_t bytes = open_.bytes.capacity();
  for (const auto& chunk : full_) bytes += chunk->bytes.capacity();
  return bytes;
}

// ---- Reading

// Reads the runs from the start of a chunk on.
class CommandLog::Reader {
 public:
  Reader(const CommandLog& log, std::size_t chunk) : log_(&log), chunk_(chunk) { begin_chunk(); }

  bool next();  // false at the end
  // At the end: whether the last chunk has as many bytes and entries as it should.
  bool is_whole() const {
    in_.expect_end();
    return first + count == log_->end_of(chunk_);
  }

  RecordedCommand entry;  // of the run; its digest is that of the last frame
  std::size_t first = 0, count = 0;

 private:
  void begin_chunk();
  void read_lead(std::uint8_t tag);
  void read(std::uint8_t tag);

  const CommandLog* log_;
  std::size_t chunk_;
  io::ByteReader in_{"", {}};
  Context context_;
};

void CommandLog::Reader::begin_chunk() {
  const Chunk& chunk = log_->chunk(chunk_);
  in_ = io::ByteReader("recording", chunk.bytes);
  context_ = {};
  entry.digest = chunk.digest_before;
  first = chunk.first;
  count = 0;
}

bool CommandLog::Reader::next() {
  while (first + count >= log_->end_of(chunk_)) {
    if (chunk_ + 1 == log_->chunks()) return false;
    ++chunk_;
    begin_chunk();
  }
  first += count;
  count = 1;
  const auto tag = in_.get<std::uint8_t>();
  if (tag & Flag::pose)
    read_lead(tag);
  else
    read(tag);
  return true;
}

void CommandLog::Reader::read_lead(std::uint8_t tag) {
  Poses& poses = context_.poses[tag & 15];
  if (tag & PoseFlag::another_tool) poses = {in_.get<ToolId>()};
  in_.expect(poses.tool != 0 && !(tag & 0x40));
  const io::PoseNumbers n = poses.packer.get(in_);
  ToolPose pose{{n[0], n[1], n[2]}, {n[3], n[4], n[5], n[7]}};
  if (tag & PoseFlag::opening) pose.opening = n[8];
  entry.command = Command(Lead{poses.tool, pose});
}

void CommandLog::Reader::read(std::uint8_t tag) {
  if (tag == Tag::duration) {
    context_.duration = in_.get<double>();
    tag = in_.get<std::uint8_t>();
  }
  switch (tag & Tag::kinds) {
    case Tag::frame:
    case Tag::run:
      if ((tag & Tag::kinds) == Tag::run) count = in_.get<std::uint16_t>();
      entry.command = Command(Advance{context_.duration});
      break;
    case Tag::other: {
      Command command;
      io::get(in_, command);
      entry.command = std::move(command);
      break;
    }
    case Tag::back: {
      GoBack back;
      io::get(in_, back);
      entry.command = back;
      break;
    }
    default:
      in_.fail();
  }
  in_.expect(count > 0 && tag < 2 * Flag::unchanged);
  if (tag & Flag::noted)
    entry.digest = in_.get<std::uint64_t>();
  else if (!(tag & Flag::unchanged))
    entry.digest.reset();
}

void CommandLog::for_each_run(
    const std::function<void(std::size_t, const RecordedCommand&, std::size_t)>& visit) const {
  for (Reader reader(*this, 0); reader.next();) visit(reader.first, reader.entry, reader.count);
}

CommandLog::Iterator::Iterator(const CommandLog& log, std::size_t from) {
  std::size_t chunk = log.chunks() - 1;
  while (chunk > 0 && log.chunk(chunk).first > from) --chunk;
  reader_ = std::make_shared<Reader>(log, chunk);
  next_run();
  while (left_ > 0 && reader_->first + reader_->count <= from) next_run();
  for (std::size_t at = reader_->first; left_ > 0 && at < from; ++at) ++*this;
}

void CommandLog::Iterator::next_run() {
  left_ = reader_->next() ? reader_->count : 0;
  if (left_ == 0) return;
  entry_ = reader_->entry;
  digest_ = left_ > 1 ? std::exchange(entry_.digest, std::nullopt) : entry_.digest;
}

auto CommandLog::Iterator::operator++() -> Iterator& {
  if (--left_ == 0)
    next_run();
  else if (left_ == 1)
    entry_.digest = digest_;
  return *this;
}

auto CommandLog::begin() const -> Iterator { return Iterator(*this); }

RecordedCommand CommandLog::operator[](std::size_t i) const { return *Iterator(*this, i); }

RecordedCommand CommandLog::back() const {
  RecordedCommand last = (*this)[size_ - 1];
  last.digest = last_digest_;
  return last;
}

std::vector<RecordedCommand> CommandLog::all() const {
  std::vector<RecordedCommand> all;
  for (const RecordedCommand& entry : *this) all.push_back(entry);
  return all;
}

// ---- Files

auto CommandLog::as_saved() const -> Saved {
  Saved saved{last_digest_, {}, {}};
  for (std::size_t i = 0; i < chunks(); ++i) {
    saved.chunks.push_back(chunk(i).bytes);
    saved.sizes.push_back(end_of(i) - chunk(i).first);
  }
  return saved;
}

CommandLog CommandLog::from_saved(const Saved& saved) {
  const auto expect = [](bool holds) {
    if (!holds) throw InputError("recording", "holds chunks that this program has not written");
  };
  CommandLog log;
  log.last_digest_ = saved.last_digest;
  expect(saved.sizes.size() == saved.chunks.size());
  for (std::size_t i = 0; i < saved.chunks.size(); ++i) {
    if (saved.sizes[i] == 0) continue;
    CommandLog one;
    one.open_ = {log.size_, log.last_noted_, saved.chunks[i]};
    one.size_ = log.size_ + saved.sizes[i];
    expect(one.size_ > log.size_);
    Reader reader(one, 0);
    while (reader.next()) log.last_noted_ = reader.entry.digest;
    expect(reader.is_whole());
    log.size_ = one.size_;
    log.full_.push_back(std::make_shared<const Chunk>(std::move(one.open_)));
  }
  log.open_.first = log.size_;
  log.open_.digest_before = log.last_noted_;
  return log;
}

}  // namespace lobe
