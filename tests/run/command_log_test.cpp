// The oracle is a plain list of entries.
#include "lobe/run/command_log.h"

#include <doctest/doctest.h>

#include <random>

#include "lobe/error.h"
#include "lobe/file/fields.h"
#include "lobe/sim/enum_sizes.h"

using namespace lobe;

namespace {

bool same(const RecordedCommand& a, const RecordedCommand& b) {
  if (a.command.index() != b.command.index() || a.digest != b.digest) return false;
  const auto *x = std::get_if<Command>(&a.command), *y = std::get_if<Command>(&b.command);
  return x ? *x == *y : std::get<GoBack>(a.command).entries == std::get<GoBack>(b.command).entries;
}

void check_is(const CommandLog& log, const std::vector<RecordedCommand>& entries) {
  REQUIRE(log.size() == entries.size());
  std::size_t i = 0;
  for (const RecordedCommand& entry : log) REQUIRE(same(entry, entries[i++]));
  REQUIRE(i == entries.size());
  log.for_each_run([&](std::size_t first, const RecordedCommand& entry, std::size_t count) {
    REQUIRE(same(entry, entries[first + count - 1]));
    for (std::size_t k = first; k < first + count; ++k)
      REQUIRE(same({entry.command, entries[k].digest}, entries[k]));
  });
}

// What a session may record, in random order: idle frames, hands that lead, edits, returns.
struct Dice {
  std::mt19937 random;
  int one_of(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); }
  double real() { return std::uniform_real_distribution<double>(-1, 1)(random); }

  Lead lead() {
    const Eigen::Quaterniond turn(Eigen::Vector4d(real(), real(), real(), real()).normalized());
    Lead lead{1 + one_of(one_of(10) == 0 ? 1000 : 3), {Vec3d(real(), real(), real()), turn.coeffs()}};
    if (one_of(3) == 0) lead.target.orientation = {0, 0, 0, 1};
    if (one_of(5) == 0) lead.target.opening = std::abs(real());
    return lead;
  }
  std::variant<Command, GoBack> entry(std::size_t size) {
    switch (one_of(12)) {
      case 0:
        return Command(RemoveTets{std::vector<Index>(std::size_t(one_of(30)), 7)});
      case 1:
        return GoBack{std::uint64_t(one_of(int(size) + 1))};
      case 2:
        return Command(SwitchTool{1 + one_of(3), one_of(2) == 0});
      case 3:
        return Command(Advance{0.01 * real()});
      case 4:
        return Command(Relinearise{0.01 * real()});
      case 5:
      case 6:
      case 7:
        return Command(lead());
      default:
        return Command(Advance{0.01});
    }
  }
};

CommandLog read_back(const CommandLog& log) {
  io::ByteWriter out;
  io::put(out, log);
  io::ByteReader in("log", out.bytes());
  CommandLog read;
  io::get(in, read);
  return read;
}

// In `frames` frames, in each of which a hand leads a tool if `leads`. [bytes]
double bytes_per_frame(bool leads, int frames) {
  CommandLog log;
  log.push_back(Command(SwitchTool{1, true}), 1);
  const std::size_t before = log.bytes();
  for (int i = 0; i < frames; ++i) {
    const double s = 0.05 * i;
    const Vec3d position(0.04 + 0.02 * std::sin(s), 0.04 + 0.02 * std::cos(0.7 * s),
                         0.05 * std::sin(0.3 * s));
    if (leads) log.push_back(Command(Lead{1, {position}}), log.last_digest());
    log.push_back(Command(Advance{1.0 / 120}), std::uint64_t(i), i % 1024 == 0);
  }
  return double(log.bytes() - before) / frames;
}

}  // namespace

TEST_CASE("a log is the list of its entries, and so are its copies and what is read from its file") {
  Dice dice{std::mt19937(5)};
  std::vector<RecordedCommand> entries;
  CommandLog log;
  std::vector<std::pair<CommandLog, std::vector<RecordedCommand>>> copies;
  std::uint64_t digest = 0;
  for (int i = 0; i < 30000; ++i) {
    const auto entry = dice.entry(entries.size());
    const auto* command = std::get_if<Command>(&entry);
    const bool is_lead = command && std::holds_alternative<Lead>(*command);
    const bool is_frame = command && std::holds_alternative<Advance>(*command);
    const bool is_unchanged = is_lead && !entries.empty();
    if (!is_unchanged) ++digest;
    const bool is_noted = !is_frame || dice.one_of(10) == 0;
    log.push_back(entry, digest, is_noted);
    entries.push_back({entry, digest});
    if (is_unchanged)
      entries.back().digest = entries[entries.size() - 2].digest;
    else if (!is_noted)
      entries.back().digest.reset();
    if (i % 5000 == 2500) copies.emplace_back(log, entries);
    if (i % 7000 == 3500) log = read_back(log);
    if (i % 5000 == 4999)
      CHECK(same({log[std::size_t(i) / 3].command, {}}, {entries[std::size_t(i) / 3].command, {}}));
  }
  CHECK(log.as_saved().chunks.size() > 6);
  check_is(log, entries);
  check_is(read_back(log), entries);
  CHECK(log.last_digest() == digest);
  CHECK(log.back().digest == digest);
  for (const std::size_t i : {0, 1, 777, 12345, 29999})
    CHECK(same({log[i].command, {}}, {entries[i].command, {}}));
  for (const auto& [copy, own] : copies) check_is(copy, own);
  for (RecordedCommand& entry : entries) entry.digest = digest;  // of a list in which each has one
  check_is(CommandLog(entries), entries);
}

TEST_CASE("a command that attaches tissue to the world is read back") {
  StrandSetup strand;
  strand.from = {3, {0.25, 0.25, 0.25, 0.25}};
  strand.anchor = {0.1, 0.2, 0.3};
  strand.stiffness = 7;
  CommandLog log;
  log.push_back(Command(Attach{{"ligament", 0.5, 3, {strand}}}), 1, true);
  strand.to = {4, {1, 0, 0, 0}};
  log.push_back(Command(Attach{{"bed", 0.5, 3, {strand, strand}}}), 2, true);
  log.push_back(Command(Detach{"bed"}), 3, true);
  check_is(read_back(log), log.all());
  strand.from.tet = -1;
  log.push_back(Command(Attach{{"nowhere", 0.5, 3, {strand}}}), 4, true);
  CHECK_THROWS_AS(read_back(log).all(), InputError);
}

TEST_CASE("frames in which nothing is done take no memory, poses of a hand 20 bytes, and nothing is moved") {
  CHECK(bytes_per_frame(false, 1'000'000) == 0);
  CHECK(bytes_per_frame(true, 100'000) < 24);
  CommandLog log;
  for (int i = 0; i < 10000; ++i) log.push_back(Command(RemoveTets{{i}}), 0);
  const std::size_t bytes = log.bytes();
  const std::vector<CommandLog> copies(100, log);
  CHECK(copies.back().bytes() < bytes);  // a copy has as much as it needs of the chunk that grows
  CHECK(copies.back().size() == 10000);
}

TEST_CASE("chunks that hold anything else are refused") {
  Dice dice{std::mt19937(6)};
  CommandLog log;
  for (int i = 0; i < 300; ++i) log.push_back(dice.entry(log.size()), std::uint64_t(i));
  const CommandLog::Saved good = log.as_saved();
  REQUIRE(good.chunks.size() == 1);
  long refused = 0;
  for (std::size_t at = 0; at < good.chunks[0].size(); ++at) {
    for (const int flip : {1, 16, 128}) {
      CommandLog::Saved saved = good;
      saved.chunks[0][at] = char(saved.chunks[0][at] ^ flip);
      try {
        const CommandLog read = CommandLog::from_saved(saved);
        long entries = 0;
        for (const RecordedCommand& entry : read) entries += entry.command.index() < 2;
        CHECK(entries == long(read.size()));
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  CHECK(refused > 100);
  CommandLog::Saved cut_off = good;
  cut_off.chunks[0].resize(cut_off.chunks[0].size() - 3);
  CHECK_THROWS_AS(CommandLog::from_saved(cut_off), InputError);
}
