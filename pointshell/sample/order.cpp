#include "pointshell/sample/order.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pointshell/part/parallel.h"
#include "pointshell/part/triangle_tree.h"
#include "pointshell/sample/smallest_ball.h"
#include "pointshell/sample/stored_position.h"

namespace forcelayer::sample {
namespace {

struct Place {
  part::Vec3 position;
  std::uint32_t index;
};

// The order along an axis; total for distinct indices.
struct AxisOrder {
  int axis;
  bool operator()(const Place& a, const Place& b) const {
    const double x = part::coordinate(a.position, axis), y = part::coordinate(b.position, axis);
    if (x != y) return x < y;
    if (!(a.position == b.position)) return part::lexicographic_less(a.position, b.position);
    return a.index < b.index;
  }
};

int longest_side(std::span<const Place> places) {
  part::Box box;
  for (const Place& place : places) box.grow(place.position);
  return box.longest_axis();
}

void halve(std::span<Place> places, std::size_t block, std::size_t super_block) {
  const AxisOrder before{longest_side(places)};
  if (places.size() <= block) return std::sort(places.begin(), places.end(), before);
  const std::size_t unit = places.size() > block * super_block ? block * super_block : block;
  const std::size_t units = (places.size() + unit - 1) / unit;
  const std::size_t half = (units + 1) / 2 * unit;
  std::nth_element(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(half), places.end(),
                   before);
  const auto first = [&] { halve(places.first(half), block, super_block); };
  const auto second = [&] { halve(places.subspan(half), block, super_block); };
  constexpr std::size_t kWorthATask = 1 << 14;
  if (places.size() < kWorthATask) return first(), second();
  tbb::parallel_invoke(first, second);
}

float rounded_up(double value) {
  const float nearest = static_cast<float>(value);
  return nearest >= value ? nearest
                          : std::nextafter(nearest, std::numeric_limits<float>::infinity());
}

BoundingSphere sphere_around(std::span<const part::Vec3> points) {
  const part::Vec3 center = as_stored(smallest_ball(points).center);
  double squared = 0;
  for (const part::Vec3& p : points) {
    squared = std::max(squared, part::length_squared(p - center));
  }
  // 2^-40 is far more than the rounding of a distance in double precision.
  const float radius = rounded_up(std::sqrt(squared) * (1 + 0x1p-40));
  return {static_cast<float>(center.x), static_cast<float>(center.y), static_cast<float>(center.z),
          radius};
}

}  // namespace

std::vector<std::uint32_t> block_order(std::span<const part::Vec3> points, std::size_t block,
                                       std::size_t super_block) {
  std::vector<Place> places(points.size());
  for (std::uint32_t n = 0; n < places.size(); ++n) places[n] = {points[n], n};
  halve(places, block, super_block);
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t n = 0; n < order.size(); ++n) order[n] = places[n].index;
  return order;
}

std::vector<BoundingSphere> bounding_spheres(std::span<const part::Vec3> points,
                                             std::size_t group) {
  std::vector<BoundingSphere> spheres((points.size() + group - 1) / group);
  part::parallel_for_each_index(spheres.size(), 16, [&](std::size_t n) {
    const std::size_t first = n * group;
    spheres[n] = sphere_around(points.subspan(first, std::min(group, points.size() - first)));
  });
  return spheres;
}

}  // namespace forcelayer::sample
