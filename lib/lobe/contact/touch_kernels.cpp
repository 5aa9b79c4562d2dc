// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/contact/touch_kernels.h"

#include <bit>

#include "lobe/numerics/simd.h"

namespace lobe::LOBE_KERNELS {
namespace {

using T = Pack<double>;
using Row = PointBlock::Row;
constexpr int count = static_cast<int>(T::size());

T load(const Row& row, int first) { return T(&row[std::size_t(first)]); }
void store(const T& value, Row& row, int first) { value.copy_to(&row[std::size_t(first)]); }
Vec3<T> load(const std::array<Row, 3>& rows, int first) {
  return {load(rows[0], first), load(rows[1], first), load(rows[2], first)};
}
void store(const Vec3<T>& value, std::array<Row, 3>& rows, int first) {
  for (int d = 0; d < 3; ++d) store(value[d], rows[std::size_t(d)], first);
}

// Sums in the order of Eigen's products of 3×3 matrices with vectors.
LOBE_FLATTEN void to_axes(const TouchAxes& axes, TouchRows x, TouchRows v, int point_count) {
  const auto turned = [&](const Vec3<T>& a) {
    const auto product = [&](std::size_t d, std::size_t k) { return T(axes.to_tool[d][k]) * a[int(k)]; };
    return Vec3<T>((product(0, 0) + product(0, 1)) + product(0, 2),
                   (product(1, 0) + product(1, 1)) + product(1, 2),
                   product(2, 0) + (product(2, 1) + product(2, 2)));
  };
  const T spin[3] = {T(axes.spin[0]), T(axes.spin[1]), T(axes.spin[2])};
  for (int i = 0; i < point_count; i += count) {
    Vec3<T> place, velocity;
    for (int d = 0; d < 3; ++d) {
      place[d] = T(x.row + d * x.stride + i) - T(axes.position[std::size_t(d)]);
      velocity[d] = T(v.row + d * v.stride + i) - T(axes.velocity[std::size_t(d)]);
    }
    const Vec3<T> at = turned(place), by_itself = turned(velocity);
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3, g = (d + 2) % 3;
      const T speed = by_itself[d] - (spin[e] * at[g] - spin[g] * at[e]);
      at[d].copy_to(x.row + d * x.stride + i);
      speed.copy_to(v.row + d * v.stride + i);
    }
  }
}

template <RigidShape::Kind kind>
DistanceOf<T> distance_to(const TouchShape& shape, const Vec3<T>& x) {
  using Kind = RigidShape::Kind;
  if constexpr (kind == Kind::sphere) return sphere_distance(shape.radius, x);
  if constexpr (kind == Kind::capsule) return capsule_distance(shape.radius, shape.length, x);
  if constexpr (kind == Kind::box)
    return box_distance<T>({shape.size[0] / 2, shape.size[1] / 2, shape.size[2] / 2}, x);
  if constexpr (kind == Kind::plane) return plane_distance(x);
  return jaws_distance(shape.size, shape.opening, x);
}

// Of bit i: lane i. The sum is exact.
unsigned int number_of(const LaneMask<T>& mask) {
  const T bits([](auto lane) { return double(1 << lane); });
  return static_cast<unsigned int>(reduce(pick(mask, bits, T(0))));
}

template <RigidShape::Kind kind>
LOBE_FLATTEN void find_distances_of(const TouchShape& shape, double near, const TouchTriangle* triangles,
                                    TouchBlock* blocks, int block_count) {
  for (TouchBlock* block = blocks; block != blocks + block_count; ++block) {
    const TouchTriangle& triangle = triangles[block->triangle];
    const PointBlock& points = *block->points;
    unsigned int touched = 0;
    for (int first = 0; first < PointBlock::width; first += count) {
      const T along = load(points.along, first), up = load(points.up, first);
      const auto is_turned = is_less(T(0), load(points.turned, first));
      Vec3<T> place;
      for (std::size_t d = 0; d < 3; ++d) place[int(d)] = T(triangle.start[d]) + up * T(triangle.up[d]);
      for (int i = 0; i < points.most_along; ++i) {
        const auto goes_on = is_less(T(i), along);
        for (std::size_t d = 0; d < 3; ++d)
          place[int(d)] = pick(goes_on, T(place[int(d)] + T(triangle.along[d])), place[int(d)]);
      }
      for (std::size_t d = 0; d < 3; ++d)
        place[int(d)] = pick(is_turned, T(place[int(d)] + T(triangle.turn[d])), place[int(d)]);
      store(place, block->place, first);
      store(T(0), block->held, first);
      if constexpr (kind != RigidShape::Kind::mesh) {
        const DistanceOf<T> found = distance_to<kind>(shape, place);
        store(found.value, block->distance, first);
        store(found.gradient, block->gradient, first);
        touched |= number_of(is_less(found.value, T(near))) << first;
      }
    }
    block->touched = touched & points.lanes;
  }
}

void find_distances(const TouchShape& shape, double near, const TouchTriangle* triangles, TouchBlock* blocks,
                    int block_count) {
  using Kind = RigidShape::Kind;
  switch (shape.kind) {
    case Kind::sphere:
      return find_distances_of<Kind::sphere>(shape, near, triangles, blocks, block_count);
    case Kind::capsule:
      return find_distances_of<Kind::capsule>(shape, near, triangles, blocks, block_count);
    case Kind::box:
      return find_distances_of<Kind::box>(shape, near, triangles, blocks, block_count);
    case Kind::plane:
      return find_distances_of<Kind::plane>(shape, near, triangles, blocks, block_count);
    case Kind::jaws:
      return find_distances_of<Kind::jaws>(shape, near, triangles, blocks, block_count);
    case Kind::mesh:
      return find_distances_of<Kind::mesh>(shape, near, triangles, blocks, block_count);
  }
}

// With the law of tool_contact.h. Sums go point by point, so that their bits do not depend on the width.
LOBE_FLATTEN double add_forces(const ContactLaw& law, const TouchShape& shape, const TouchTriangle* triangles,
                               TouchBlock* blocks, int block_count, TouchRows speeds, double* f) {
  using Vectors = PaddedVectors<T>;
  using Four [[gnu::vector_size(4 * sizeof(double))]] = double;
  const bool has_jaws = shape.kind == RigidShape::Kind::jaws, is_unit = shape.kind != RigidShape::Kind::mesh;
  double grip = 0;
  alignas(64) double forces[4 * count];
  for (TouchBlock* block = blocks; block != blocks + block_count; ++block) {
    if (block->touched == 0) continue;
    const TouchTriangle& triangle = triangles[block->triangle];
    const PointBlock& points = *block->points;
    for (int first = 0; first < PointBlock::width; first += count) {
      const unsigned int touched = block->touched >> first & ((1u << count) - 1);
      if (touched == 0) continue;
      const Vec3<T> place = load(block->place, first), gradient = load(block->gradient, first);
      T approach = T(0);
      if (law.damping > 0) {
        if (has_jaws)
          approach = gradient[1] * pick(is_less(place[1], T(0)), T(-shape.opens / 2), T(shape.opens / 2));
        for (std::size_t c = 0; c < 3; ++c) {
          const double* v = speeds.row + triangle.points[c];
          approach -= load(points.weights[c], first) *
                      dot(gradient, {T(v[0]), T(v[speeds.stride]), T(v[2 * speeds.stride])});
        }
      }
      const T pressure = law.pressure(T(-load(block->distance, first)), load(block->held, first),
                                      triangle.stiffness, approach);
      Vec3<T> traction = gradient * pressure;
      if (law.friction > 0) {
        const Vec3<T> way = place - load(block->anchor, first);
        Vec3<T> slip = held_slip(law, triangle.stiffness, way, gradient, is_unit, pressure);
        const auto is_held = is_less(T(0), load(block->has_anchor, first));
        for (int d = 0; d < 3; ++d) slip[d] = pick(is_held, slip[d], T(0));
        traction -= slip * T(ContactLaw::slip_share * triangle.stiffness);
        store(Vec3<T>(place - slip), block->anchor, first);
      }
      Vectors::store(traction * T(triangle.area), forces);
      Four sums[3];
      for (std::size_t c = 0; c < 3; ++c) std::memcpy(&sums[c], f + 4 * triangle.points[c], sizeof sums[c]);
      for (unsigned int rest = touched; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest);
        Four force;
        std::memcpy(&force, forces + Vectors::offset(lane), sizeof force);
        for (std::size_t c = 0; c < 3; ++c) sums[c] += points.weights[c][std::size_t(first + lane)] * force;
        if (has_jaws) grip -= (block->place[1][std::size_t(first + lane)] < 0 ? -0.5 : 0.5) * force[1];
      }
      for (std::size_t c = 0; c < 3; ++c) std::memcpy(f + 4 * triangle.points[c], &sums[c], sizeof sums[c]);
    }
  }
  return grip;
}

}  // namespace

extern const TouchKernels double_touch_kernels{to_axes, find_distances, add_forces};

}  // namespace lobe::LOBE_KERNELS
