#include "pointshell/order.h"

#include <tbb/parallel_sort.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "pointshell/parallel.h"
#include "pointshell/smallest_ball.h"
#include "pointshell/stored_position.h"
#include "pointshell/triangle_tree.h"

namespace forcelayer {
namespace {

constexpr int kBits = 21;

// Place along the Hilbert curve of a cell with kBits an axis (Skilling's transposed form, then its
// bits interleaved).
std::uint64_t hilbert_index(std::array<std::uint32_t, 3> x) {
  for (std::uint32_t q = 1u << (kBits - 1); q > 1; q >>= 1) {
    const std::uint32_t p = q - 1;
    for (int i = 0; i < 3; ++i) {
      if (x[i] & q) {
        x[0] ^= p;
      } else {
        const std::uint32_t t = (x[0] ^ x[i]) & p;
        x[0] ^= t;
        x[i] ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = 1u << (kBits - 1); q > 1; q >>= 1) {
    if (x[2] & q) t ^= q - 1;
  }
  std::uint64_t index = 0;
  for (int bit = kBits - 1; bit >= 0; --bit) {
    for (int i = 0; i < 3; ++i) index = index << 1 | ((x[i] ^ t) >> bit & 1u);
  }
  return index;
}

float rounded_up(double value) {
  const float nearest = static_cast<float>(value);
  return nearest >= value ? nearest
                          : std::nextafter(nearest, std::numeric_limits<float>::infinity());
}

BoundingSphere sphere_around(std::span<const Vec3> points) {
  const Vec3 centre = as_stored(smallest_ball(points).centre);
  double squared = 0;
  for (const Vec3& p : points) {
    squared = std::max(squared, length_squared(p - centre));
  }
  // The distance is exact to a few units of double precision; one in 2^40 is far more.
  const float radius = rounded_up(std::sqrt(squared) * (1 + 0x1p-40));
  return {static_cast<float>(centre.x), static_cast<float>(centre.y), static_cast<float>(centre.z),
          radius};
}

}  // namespace

std::vector<std::uint32_t> hilbert_order(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& p : points) box.grow(p);
  const Vec3 size = points.empty() ? Vec3{} : box.high - box.low;
  const double edge = std::max({size.x, size.y, size.z, std::numeric_limits<double>::min()});
  constexpr double kLast = (1u << kBits) - 1;
  const auto cell = [&](double offset) {
    return static_cast<std::uint32_t>(std::min(offset / edge * kLast, kLast));
  };
  struct Keyed {
    std::uint64_t key;
    std::uint32_t index;
  };
  std::vector<Keyed> keyed(points.size());
  parallel_for_each_index(points.size(), 4096, [&](std::size_t n) {
    const Vec3 offset = points[n] - box.low;
    keyed[n] = {hilbert_index({cell(offset.x), cell(offset.y), cell(offset.z)}),
                static_cast<std::uint32_t>(n)};
  });
  tbb::parallel_sort(keyed.begin(), keyed.end(), [&](const Keyed& a, const Keyed& b) {
    if (a.key != b.key) return a.key < b.key;
    const Vec3 &p = points[a.index], &q = points[b.index];
    return p == q ? a.index < b.index : lexicographic_less(p, q);
  });
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t n = 0; n < order.size(); ++n) order[n] = keyed[n].index;
  return order;
}

std::vector<BoundingSphere> bounding_spheres(std::span<const Vec3> points, std::size_t group) {
  std::vector<BoundingSphere> spheres((points.size() + group - 1) / group);
  parallel_for_each_index(spheres.size(), 16, [&](std::size_t n) {
    const std::size_t first = n * group;
    spheres[n] = sphere_around(points.subspan(first, std::min(group, points.size() - first)));
  });
  return spheres;
}

}  // namespace forcelayer
