#include "lobe/file/row_packer.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lobe::io {
namespace {

constexpr std::size_t numbers = std::tuple_size_v<PoseNumbers>, often = 7;  // that change often come first
constexpr std::size_t real_part = 7;                                        // w, which the others determine

// Bytes in halves.
class HalfBytes {
 public:
  void put(unsigned half) { halves_[count_++] = static_cast<unsigned char>(half); }
  void append_to(std::string& out) const {
    for (std::size_t i = 0; i < count_; i += 2)
      out.push_back(static_cast<char>(halves_[i] | (i + 1 < count_ ? halves_[i + 1] << 4 : 0)));
  }

 private:
  std::array<unsigned char, 3 + numbers * 17> halves_{};
  std::size_t count_ = 0;
};

class HalfByteReader {
 public:
  explicit HalfByteReader(ByteReader& in) : in_(in) {}
  unsigned get() {
    is_second_ = !is_second_;
    if (!is_second_) return byte_ >> 4;
    byte_ = in_.get<std::uint8_t>();
    return byte_ & 15;
  }

 private:
  ByteReader& in_;
  unsigned byte_ = 0;
  bool is_second_ = false;
};

// Of bit patterns; small differences of either sign are small numbers.
std::uint64_t difference(double x, double expected) {
  const std::uint64_t d = std::bit_cast<std::uint64_t>(x) - std::bit_cast<std::uint64_t>(expected);
  return d << 1 ^ (d >> 63 ? ~std::uint64_t(0) : 0);
}
double sum(double expected, std::uint64_t difference) {
  const std::uint64_t d = difference >> 1 ^ (difference & 1 ? ~std::uint64_t(0) : 0);
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(expected) + d);
}

}  // namespace

// A parabola through the last three; numbers that rest are expected exactly.
double RowPacker::expected(std::size_t number, const PoseNumbers& row) const {
  if (is_first_) return 0;
  if (number == real_part) {
    const double left = 1 - (row[3] * row[3] + row[4] * row[4] + row[5] * row[5]);
    return std::copysign(std::sqrt(std::max(left, 0.0)), last_[0][real_part]);
  }
  return (last_[0][number] - last_[1][number]) * 3 + last_[2][number];
}

void RowPacker::keep(const PoseNumbers& row) {
  if (is_first_) last_.fill(row);
  is_first_ = false;
  last_ = {row, last_[0], last_[1]};
}

void RowPacker::put(const PoseNumbers& row, std::string& out) {
  std::array<std::uint64_t, numbers> differences;
  unsigned changed = 0, seldom = 0;
  for (std::size_t i = 0; i < numbers; ++i) {
    differences[i] = difference(row[i], expected(i, row));
    if (differences[i] != 0) (i < often ? changed : seldom) |= 1u << (i < often ? i : i - often);
  }
  if (seldom) changed |= 1u << often;
  HalfBytes halves;
  halves.put(changed & 15);
  halves.put(changed >> 4);
  if (seldom) halves.put(seldom);
  for (const std::uint64_t d : differences) {
    if (d == 0) continue;
    const unsigned length = (std::bit_width(d) + 3) / 4;
    halves.put(length - 1);
    for (unsigned i = 0; i < length; ++i) halves.put(d >> (4 * i) & 15);
  }
  halves.append_to(out);
  keep(row);
}

PoseNumbers RowPacker::get(ByteReader& in) {
  HalfByteReader halves(in);
  unsigned changed = halves.get();
  changed |= halves.get() << 4;
  const unsigned seldom = changed >> often ? halves.get() : 0;
  PoseNumbers row{};
  for (std::size_t i = 0; i < numbers; ++i) {
    const bool differs = i < often ? changed >> i & 1 : seldom >> (i - often) & 1;
    std::uint64_t d = 0;
    if (differs)
      for (unsigned k = 0, length = halves.get() + 1; k < length; ++k)
        d |= std::uint64_t(halves.get()) << (4 * k);
    row[i] = sum(expected(i, row), d);
  }
  keep(row);
  return row;
}

}  // namespace lobe::io
