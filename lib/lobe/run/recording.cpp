#include "lobe/run/recording.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <map>
#include <span>
#include <type_traits>

#include "lobe/error.h"
#include "lobe/file/scanner.h"
#include "lobe/file/sealed_file.h"
#include "lobe/sim/enum_sizes.h"

namespace lobe {
namespace {

constexpr io::Format format{"loberec ", 19, "recording of a world"};

// Whether a command only says what tools do in the next frame. Such a command does not change the state.
bool is_about_tools(const Command& command) {
  return std::visit([]<class Any>(const Any&) { return std::is_constructible_v<ToolCommand, Any>; }, command);
}

void mix(std::uint64_t word, std::uint64_t& digest) {
  digest = (digest ^ word) * 0x9e3779b97f4a7c15u;
  digest ^= digest >> 32;
}

// A digest that takes four words at a time, each into a digest of its own. That is so fast that a frame of a
// recording does not cost more to digest than to publish.
template <class Real>
std::uint64_t mixed(std::span<const Real> values, std::uint64_t start) {
  constexpr std::size_t lanes = 4, bytes_at_once = lanes * sizeof(std::uint64_t);
  std::array<std::uint64_t, lanes> digests{start, start + 1, start + 2, start + 3}, words{};
  const auto* bytes = reinterpret_cast<const char*>(values.data());
  const auto mix_words = [&] {
    for (std::size_t lane = 0; lane < lanes; ++lane) mix(words[lane], digests[lane]);
  };
  std::size_t left = values.size_bytes();
  for (; left >= bytes_at_once; left -= bytes_at_once, bytes += bytes_at_once) {
    std::memcpy(words.data(), bytes, bytes_at_once);
    mix_words();
  }
  if (left > 0) {
    words = {};
    std::memcpy(words.data(), bytes, left);
    mix_words();
  }
  for (std::size_t lane = 1; lane < lanes; ++lane) mix(digests[lane], digests[0]);
  return digests[0];
}

template <class Real>
std::uint64_t digest_of(const Eigen::Ref<const Mat3X<Real>>& u, const Eigen::Ref<const Mat3X<Real>>& v,
                        double time) {
  const auto values = [](const auto& matrix) { return std::span(matrix.data(), std::size_t(matrix.size())); };
  return mixed(std::span<const double>(&time, 1), mixed(values(v), mixed(values(u), io::digest({}))));
}

// The states to which a recording goes back, stored while it is played.
template <class Real>
class Returns {
 public:
  explicit Returns(const Recording& recording) {
    recording.commands.for_each_run([&](std::size_t i, const RecordedCommand& entry, std::size_t) {
      const auto* back = std::get_if<GoBack>(&entry.command);
      if (!back) return;
      if (back->entries > i) throw InputError("recording", "goes back to what comes later");
      checkpoints_[back->entries] = {};
    });
  }
  void keep(std::size_t entries, const World<Real>& world) {
    if (const auto at = checkpoints_.find(entries); at != checkpoints_.end()) at->second = world.save();
  }
  void go_back(const GoBack& back, World<Real>& world) const { world.restore(checkpoints_.at(back.entries)); }

 private:
  std::map<std::uint64_t, Checkpoint<Real>> checkpoints_;
};

}  // namespace

void visit_to_the_end(const Recording& recording,
                      const std::function<void(const Command&, std::size_t)>& visit) {
  struct Range {
    std::size_t begin, end;
  };
  std::vector<Range> ranges{{0, 0}};  // of entries, what was undone left out
  recording.commands.for_each_run([&](std::size_t first, const RecordedCommand& entry, std::size_t count) {
    const auto* back = std::get_if<GoBack>(&entry.command);
    ranges.back().end = first + (back ? 0 : count);
    if (!back) return;
    while (ranges.size() > 1 && ranges.back().begin >= back->entries) ranges.pop_back();
    ranges.back().end = std::min<std::size_t>(ranges.back().end, back->entries);
    ranges.push_back({first + 1, first + 1});
  });
  auto range = ranges.begin();
  recording.commands.for_each_run([&](std::size_t first, const RecordedCommand& entry, std::size_t count) {
    const auto* command = std::get_if<Command>(&entry.command);
    for (; range != ranges.end() && range->begin < first + count; ++range) {
      const std::size_t from = std::max(range->begin, first), to = std::min(range->end, first + count);
      if (command && from < to) visit(*command, to - from);
      if (range->end > first + count) break;
    }
  });
}

template <class Real>
std::uint64_t digest(World<Real>& world) {
  const StateView<Real> state = world.state();
  return digest_of<Real>(state.u, state.v, state.time);
}

template <class Real>
CommandRecorder<Real>::CommandRecorder(World<Real>& world, NotedFrames noted) : world_(world), noted_(noted) {
  recording_.setup = world.journal().setup;
  recording_.sleep = world.body().sleep.tolerance();
  recording_.in_double = std::is_same_v<Real, double>;
}

template <class Real>
void CommandRecorder<Real>::apply(const Command& command) {
  const auto* frame = std::get_if<Advance>(&command);
  if (frame) {
    advance(frame->duration);
    return;
  }
  world_.apply(command);
  frames_idle_ = 0;
  if (!std::holds_alternative<Lead>(command)) frames_ = 0;
  const bool is_same = is_about_tools(command) && !recording_.commands.empty();
  recording_.commands.push_back(command, is_same ? recording_.commands.last_digest() : digest(world_));
}

template <class Real>
Report CommandRecorder<Real>::advance(double duration) {
  Report report = world_.advance(duration);
  recording_.commands.push_back(Command(Advance{duration}), digest(world_), notes_next_frame());
  return report;
}

template <class Real>
bool CommandRecorder<Real>::notes_next_frame() {
  ++frames_;
  ++frames_idle_;
  const std::uint32_t longest = frames_idle_ < frames_ ? 16 : 1024;
  return noted_ == NotedFrames::all || std::has_single_bit(frames_) || frames_ % longest == 0;
}

template <class Real>
void CommandRecorder<Real>::go_back(const Checkpoint<Real>& checkpoint, std::size_t entries) {
  world_.restore(checkpoint);
  frames_ = frames_idle_ = 0;
  recording_.commands.push_back(GoBack{entries}, digest(world_));
}

template <class Real>
void CommandRecorder<Real>::go_on(const Checkpoint<Real>& checkpoint, Recording recording) {
  const State<Real>& state = checkpoint.state;
  const bool is_its_end = recording.commands.empty() ||
                          digest_of<Real>(state.u, state.v, state.time) == recording.commands.last_digest();
  if (recording.setup != checkpoint.setup || recording.in_double != recording_.in_double || !is_its_end)
    throw InputError("recording", "does not lead to the state that was saved with it");
  world_.restore(checkpoint);
  recording_ = std::move(recording);
  frames_ = frames_idle_ = 0;
}

Setup as_recorded(const Recording& recording, Setup setup) {
  setup.sleep = recording.sleep;
  return setup;
}

template <class Real>
ReplayResult replay(const Recording& recording, World<Real>& world) {
  if (recording.setup != world.journal().setup)
    throw InputError("recording", "is of another scene, mesh or version of them");
  if (recording.in_double != std::is_same_v<Real, double>)
    throw InputError("recording", recording.in_double ? "is in double precision" : "is in single precision");
  ReplayResult replayed;
  Returns<Real> returns(recording);
  for (const RecordedCommand& recorded : recording.commands) {
    returns.keep(replayed.commands, world);
    if (const auto* back = std::get_if<GoBack>(&recorded.command))
      returns.go_back(*back, world);
    else
      world.apply(std::get<Command>(recorded.command));
    replayed.same = !recorded.digest || digest(world) == recorded.digest;
    if (!replayed.same) break;
    ++replayed.commands;
  }
  replayed.time = world.time();
  return replayed;
}

void write_recording(const std::filesystem::path& file, const Recording& recording) {
  io::ByteWriter out;
  io::put(out, recording);
  io::write_sealed(file, format, out.bytes());
}

Recording parse_recording(const std::string& name, std::string_view bytes) {
  io::ByteReader in(name, io::unseal(name, bytes, format));
  Recording recording;
  io::get(in, recording);
  in.expect_end();
  return recording;
}

Recording read_recording(const std::filesystem::path& file) {
  return parse_recording(file.string(), io::read_file(file));
}

template std::uint64_t digest(World<float>&);
template std::uint64_t digest(World<double>&);
template class CommandRecorder<float>;
template class CommandRecorder<double>;
template ReplayResult replay(const Recording&, World<float>&);
template ReplayResult replay(const Recording&, World<double>&);

}  // namespace lobe
