#include "lobe/run/recording.h"

#include <type_traits>

#include "lobe/error.h"
#include "lobe/io/scanner.h"
#include "lobe/io/sealed_file.h"
#include "lobe/sim/checkpoint.h"

namespace lobe {
namespace {

constexpr io::Format format{"loberec ", 3, "recording of a world"};

}  // namespace

template <class Real>
std::uint64_t digest(const World<Real>& world) {
  const auto& state = world.state();
  const auto values = [](const auto& matrix) { return std::span(matrix.data(), std::size_t(matrix.size())); };
  const std::uint64_t u = io::digest_of(values(state.u)), v = io::digest_of(values(state.v), u);
  return io::digest_of(std::span(&state.time, 1), v);
}

template <class Real>
Recorded<Real>::Recorded(World<Real>& world) : world_(world) {
  recording_.setup = world.save().setup;
  recording_.in_double = std::is_same_v<Real, double>;
}

template <class Real>
RecordedCall& Recorded<Real>::add(RecordedCall::Kind kind) {
  RecordedCall& call = recording_.calls.emplace_back();
  call.kind = kind;
  call.digest = digest(world_);
  return call;
}

template <class Real>
Report Recorded<Real>::advance(double duration) {
  Report report = world_.advance(duration);
  add(RecordedCall::Kind::advance).duration = duration;
  return report;
}

template <class Real>
Index Recorded<Real>::remove_tets(const std::vector<Index>& tets) {
  const Index removed = world_.remove_tets(tets);
  add(RecordedCall::Kind::remove_tets).tets = tets;
  return removed;
}

template <class Real>
double Recorded<Real>::set_region(const std::vector<Index>& tets, RegionModel model) {
  const double energy_change = world_.set_region(tets, model);
  RecordedCall& call = add(RecordedCall::Kind::set_region);
  call.tets = tets;
  call.model = model;
  return energy_change;
}

template <class Real>
void Recorded<Real>::expand() {
  world_.expand();
  add(RecordedCall::Kind::expand);
}

template <class Real>
void Recorded<Real>::condense() {
  world_.condense();
  add(RecordedCall::Kind::condense);
}

template <class Real>
void Recorded<Real>::renew(double delay) {
  world_.renew(delay);
  add(RecordedCall::Kind::renew).duration = delay;
}

template <class Real>
void Recorded<Real>::set_mass_degree(int degree) {
  world_.set_mass_degree(degree);
  add(RecordedCall::Kind::mass_degree).degree = degree;
}

template <class Real>
Replayed replay(const Recording& recording, World<Real>& world) {
  if (recording.setup != world.save().setup)
    throw InputError("recording", "is of another scene, mesh or version of them");
  if (recording.in_double != std::is_same_v<Real, double>)
    throw InputError("recording", recording.in_double ? "is in double precision" : "is in single precision");
  Replayed replayed;
  for (const RecordedCall& call : recording.calls) {
    if (call.kind == RecordedCall::Kind::advance) world.advance(call.duration);
    if (call.kind == RecordedCall::Kind::remove_tets) world.remove_tets(call.tets);
    if (call.kind == RecordedCall::Kind::set_region) world.set_region(call.tets, call.model);
    if (call.kind == RecordedCall::Kind::expand) world.expand();
    if (call.kind == RecordedCall::Kind::condense) world.condense();
    if (call.kind == RecordedCall::Kind::renew) world.renew(call.duration);
    if (call.kind == RecordedCall::Kind::mass_degree) world.set_mass_degree(call.degree);
    replayed.same = digest(world) == call.digest;
    if (!replayed.same) break;
    ++replayed.calls;
  }
  replayed.time = world.time();
  return replayed;
}

void write_recording(const std::filesystem::path& file, const Recording& recording) {
  io::ByteWriter out;
  out.put(recording.setup);
  out.put(std::uint8_t(recording.in_double));
  out.put(std::uint64_t(recording.calls.size()));
  for (const RecordedCall& call : recording.calls) {
    out.put(call.kind);
    out.put(call.duration);
    out.put(call.model);
    out.put(call.degree);
    out.put_all(std::span(call.tets));
    out.put(call.digest);
  }
  io::write_sealed(file, format, out.bytes());
}

Recording parse_recording(const std::string& name, std::string_view bytes) {
  io::ByteReader in(name, io::unseal(name, bytes, format));
  Recording recording;
  recording.setup = in.get<std::uint64_t>();
  recording.in_double = in.get_choice(2) == 1;
  for (std::size_t left = in.get_count(1); left > 0; --left) {
    RecordedCall& call = recording.calls.emplace_back();
    call.kind = RecordedCall::Kind(in.get_choice(7));
    call.duration = in.get<double>();
    call.model = RegionModel(in.get_choice(3));
    call.degree = in.get<int>();
    call.tets = in.get_all<Index>();
    call.digest = in.get<std::uint64_t>();
  }
  in.expect_end();
  return recording;
}

Recording read_recording(const std::filesystem::path& file) {
  return parse_recording(file.string(), io::read_file(file));
}

template std::uint64_t digest(const World<float>&);
template std::uint64_t digest(const World<double>&);
template class Recorded<float>;
template class Recorded<double>;
template Replayed replay(const Recording&, World<float>&);
template Replayed replay(const Recording&, World<double>&);

}  // namespace lobe
