#include "lobe/run/recording.h"

#include <type_traits>

#include "lobe/error.h"
#include "lobe/io/scanner.h"
#include "lobe/io/sealed_file.h"
#include "lobe/sim/kept.h"

namespace lobe {
namespace {

constexpr io::Format format{"loberec ", 4, "recording of a world"};

}  // namespace

template <class Real>
std::uint64_t digest(World<Real>& world) {
  const StateView<Real> state = world.state();
  const auto values = [](const auto& matrix) { return std::span(matrix.data(), std::size_t(matrix.size())); };
  const std::uint64_t u = io::digest_of(values(state.u)), v = io::digest_of(values(state.v), u);
  return io::digest_of(std::span(&state.time, 1), v);
}

template <class Real>
Recorded<Real>::Recorded(World<Real>& world) : world_(world) {
  recording_.setup = world.fingerprint();
  recording_.in_double = std::is_same_v<Real, double>;
}

template <class Real>
void Recorded<Real>::apply(const Command& command) {
  world_.apply(command);
  recording_.commands.push_back({command, digest(world_)});
}

template <class Real>
Report Recorded<Real>::advance(double duration) {
  Report report = world_.advance(duration);
  recording_.commands.push_back({Advance{duration}, digest(world_)});
  return report;
}

template <class Real>
Replayed replay(const Recording& recording, World<Real>& world) {
  if (recording.setup != world.fingerprint())
    throw InputError("recording", "is of another scene, mesh or version of them");
  if (recording.in_double != std::is_same_v<Real, double>)
    throw InputError("recording", recording.in_double ? "is in double precision" : "is in single precision");
  Replayed replayed;
  for (const RecordedCommand& recorded : recording.commands) {
    world.apply(recorded.command);
    replayed.same = digest(world) == recorded.digest;
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
template class Recorded<float>;
template class Recorded<double>;
template Replayed replay(const Recording&, World<float>&);
template Replayed replay(const Recording&, World<double>&);

}  // namespace lobe
