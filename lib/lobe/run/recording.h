// What was done to a world, call by call, with a digest of the state after each: played again on a world of the same
// setup, on any number of threads, it must give the same bits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "lobe/sim/world.h"

namespace lobe {

struct RecordedCall {
  enum class Kind : std::uint8_t { advance, remove_tets, set_region, expand, condense, renew, mass_degree };
  Kind kind = Kind::advance;
  double duration = 0;  // of advance(), or the delay of renew() [s]
  RegionModel model = RegionModel::nonlinear;
  int degree = 1;            // of set_mass_degree()
  std::vector<Index> tets;   // of remove_tets() and set_region()
  std::uint64_t digest = 0;  // of displacements, velocities and time after it
};

struct Recording {
  std::uint64_t setup = 0;  // fingerprint() of the world's
  bool in_double = false;
  std::vector<RecordedCall> calls;
};

template <class Real>
std::uint64_t digest(const World<Real>& world);

// A world that is played by these calls keeps their record.
template <class Real>
class Recorded {
 public:
  explicit Recorded(World<Real>& world);

  Report advance(double duration);
  Index remove_tets(const std::vector<Index>& tets);
  double set_region(const std::vector<Index>& tets, RegionModel model);
  void expand();
  void condense();
  void renew(double delay);
  void set_mass_degree(int degree);
  const Recording& recording() const { return recording_; }

 private:
  RecordedCall& add(RecordedCall::Kind kind);

  World<Real>& world_;
  Recording recording_;
};

struct Replayed {
  std::size_t calls = 0;  // that gave the recorded bits
  bool same = true;       // false: the next one did not
  double time = 0;        // of the world, where it ended [s]
};

// Plays a recording on a world as it was when the recording began; throws InputError for one of another setup or
// precision. Stops at the first call after which the state differs.
template <class Real>
Replayed replay(const Recording& recording, World<Real>& world);

// Reading throws InputError for a file that is damaged, cut off or of another version.
void write_recording(const std::filesystem::path& file, const Recording& recording);
Recording read_recording(const std::filesystem::path& file);
Recording parse_recording(const std::string& name, std::string_view bytes);

}  // namespace lobe
