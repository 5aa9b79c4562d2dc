// Every run gives the bits that are kept in digests.txt, on 1, 2 and 7 threads. They hold on x86-64, whatever
// instructions the wide kernels use. LOBE_WRITE_GOLDEN=FILE writes the digests of one thread to a file
// instead; with LOBE_GOLDEN_RUNS="a;b" those of the runs a and b alone, for a processor that is emulated. A
// run that another world takes over at half time, from a checkpoint, gives the same bits.
#include "golden/golden.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <map>
#include <sstream>

using namespace lobe;
using namespace lobe::test;

namespace {

// A line for each run: its name, a colon, its digests.
std::map<std::string, Digests> kept_digests() {
  std::ifstream file(std::string(LOBE_GOLDEN_DIR) + "/digests.txt");
  std::map<std::string, Digests> kept;
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (line.starts_with("#") || colon == std::string::npos) continue;
    std::istringstream values(line.substr(colon + 1));
    Digests& digests = kept[line.substr(0, colon)];
    for (std::uint64_t digest; values >> std::hex >> digest;) digests.push_back(digest);
  }
  return kept;
}

bool is_asked_for(const std::string& run) {
  const char* const runs = std::getenv("LOBE_GOLDEN_RUNS");
  return !runs || (';' + std::string(runs) + ';').find(';' + run + ';') != std::string::npos;
}

void write_digests(const std::string& path, const std::vector<GoldenRun>& runs) {
  std::ofstream file(path, std::ios::app);
  for (const GoldenRun& run : runs) {
    if (!is_asked_for(run.name)) continue;
    file << run.name << ':';
    for (std::uint64_t digest : run.play(1))
      file << ' ' << std::hex << std::setw(16) << std::setfill('0') << digest;
    file << '\n';
  }
  REQUIRE(file.good());
}

template <class Play>
void check_that_it_gives_what_is_kept(const GoldenRun& run, const Play& play, int threads,
                                      const std::map<std::string, Digests>& kept) {
  CAPTURE(run.name);
  CAPTURE(threads);
  REQUIRE(kept.contains(run.name));
  const Digests found = play(threads);
  REQUIRE(found.size() == golden_times);
  std::size_t same = 0;  // times
  while (same < golden_times && found[same] == kept.at(run.name)[same]) ++same;
  CHECK(same == golden_times);
}

void check(const std::vector<GoldenRun>& runs) {
  if (const char* path = std::getenv("LOBE_WRITE_GOLDEN")) return write_digests(path, runs);
#ifdef __x86_64__
  const std::map<std::string, Digests> kept = kept_digests();
  for (const GoldenRun& run : runs)
    for (int threads : {1, 2, 7}) check_that_it_gives_what_is_kept(run, run.play, threads, kept);
#endif
}

void check_taken_over(const std::vector<GoldenRun>& runs) {
  if (std::getenv("LOBE_WRITE_GOLDEN")) return;
#ifdef __x86_64__
  const std::map<std::string, Digests> kept = kept_digests();
  for (const GoldenRun& run : runs)
    if (run.take_over) check_that_it_gives_what_is_kept(run, run.take_over, 1, kept);
#endif
}

}  // namespace

TEST_CASE("the shipped scenes give the bits that are kept, on any number of threads") {
  check(shipped_scenes());
}

TEST_CASE("every option gives the bits that are kept, on any number of threads") { check(option_scenes()); }

TEST_CASE("every element and law gives the bits that are kept, on any number of threads") {
  check(element_scenes());
}

TEST_CASE("every force term gives the bits that are kept, on any number of threads") { check(term_scenes()); }

TEST_CASE("a run that another world takes over at half time gives the bits of the straight one") {
  check_taken_over(option_scenes());
  check_taken_over(element_scenes());
  check_taken_over(term_scenes());
}
