// Packs rows of numbers that change smoothly, such as the poses of a tool, into few bytes, without loss.
#pragma once

#include <array>
#include <string>

#include "lobe/file/sealed_file.h"

namespace lobe::io {

// A pose: position, x, y and z of a unit quaternion, time, w of the quaternion, opening.
using PoseNumbers = std::array<double, 9>;

// Writes rows one after the other. A number is the difference of its bits from those that the three rows
// before lead to; one that is as expected takes nothing. A row of a tool that a hand moves takes 12 to 20
// bytes, and as many again where it turns.
class RowPacker {
 public:
  void put(const PoseNumbers& row, std::string& out);
  PoseNumbers get(ByteReader& in);  // throws InputError where the bytes end

 private:
  double expected(std::size_t number, const PoseNumbers& row) const;
  void keep(const PoseNumbers& row);

  std::array<PoseNumbers, 3> last_ = {};  // rows, the newest first
  bool is_first_ = true;
};

}  // namespace lobe::io
