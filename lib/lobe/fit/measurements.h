// What was measured on a body, read from a table of comma-separated values.
//
// The first line names the columns: quantity, at, component, value, unit, and, if wanted, sigma and time.
// Each other line is one number:
//
//   quantity,at,component,value,unit,sigma
//   displacement,0.1 0 0.024,z,-6.54,mm,0.05      of the point that is at x y z [m] at rest
//   displacement,0.1 0 0.024,length,6.54,mm,0.05  its distance from there
//   force,0,z,0.51,N,0.01                         on the body, of entry 0 of the scene's "boundary"
//   frequency,1,,7.7,Hz,0.1                       the lowest natural one
//
// With times [s], the numbers are of the scene's motion, and a tool has forces, too:
//
//   quantity,at,component,time,value,unit
//   displacement,0.1 0 0.024,z,0.02,-1.2,mm
//   force,forceps,z,0.02,0.4,N                    on the body, of the tool "forceps"
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lobe/types.h"

namespace lobe {

enum class Quantity : std::uint8_t { displacement, force, frequency };
inline constexpr int length_of_vector = 3;  // value of `component` for the length

struct Measurement {
  Quantity quantity = Quantity::displacement;
  Vec3d point = Vec3d::Zero();      // point of a displacement, at rest [m]
  int number = 0;                   // number of the entry of "boundary", from 0; of the frequency, from 1
  std::string tool = {};            // name of the tool, in place of an entry
  int component = 0;                // x, y, z, or length_of_vector
  double value = 0;                 // [m], [N] or [Hz]
  double sigma = 0;                 // standard deviation, in the unit of the value; 0: not told
  std::optional<double> time = {};  // time since the scene began [s]; none: of the equilibrium
  int line = 0;                     // line of the file
};

// Throws one InputError for all that is wrong in `text`; `file` names it.
std::vector<Measurement> parse_measurements(std::string_view text, const std::string& file);
std::vector<Measurement> read_measurements(const std::filesystem::path& file);

}  // namespace lobe
