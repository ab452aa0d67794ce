#include "formats/bulk_checks.h"

#include <algorithm>
#include <cmath>

namespace forcelayer {
namespace {

// A unit vector computed in single precision has a squared length this close to 1.
constexpr double kUnitTolerance = 2e-6;

// Without branches, so that the loop below is vectorized.
bool is_bad_entry(std::uint32_t entry, const EntryRule& rule) {
  const std::uint32_t value = entry & rule.value_mask;
  const std::uint32_t allowed = value == 0 ? rule.clearance_mask : 0;
  const std::uint32_t rest = entry & ~(kUniformBit | rule.value_mask);
  const bool bad_value = (value > rule.max_value) | ((rest & ~allowed) != 0);
  const bool bad_child = entry >= rule.child_count;
  return is_uniform(entry) ? bad_value : bad_child;
}

double squared_distance(const PshellView& v, std::size_t i, const BoundingSphere& sphere) {
  const double dx = double{v.x[i]} - sphere.x, dy = double{v.y[i]} - sphere.y,
               dz = double{v.z[i]} - sphere.z;
  return dx * dx + dy * dy + dz * dz;
}

PointFault fault_of(const PshellView& v, std::size_t i, double limit) {
  if (!(squared_distance(v, i, BoundingSphere{0, 0, 0, 0}) <= limit)) return PointFault::kPosition;
  const double nx = v.nx[i], ny = v.ny[i], nz = v.nz[i];
  if (!(std::abs(nx * nx + ny * ny + nz * nz - 1) <= kUnitTolerance)) return PointFault::kNormal;
  if (!(std::isfinite(v.weight_m2[i]) && v.weight_m2[i] >= 0)) return PointFault::kWeight;
  if (v.cone_cos && !(v.cone_cos[i] >= -1 && v.cone_cos[i] <= 1)) return PointFault::kCone;
  if (v.two_sided && v.two_sided[i] > 1) return PointFault::kSides;
  return PointFault::kNone;
}

}  // namespace

std::size_t first_bad_entry(std::span<const std::uint32_t> entries, const EntryRule& rule) {
  constexpr std::size_t kChunk = 4096;
  for (std::size_t begin = 0; begin < entries.size(); begin += kChunk) {
    const auto chunk = entries.subspan(begin, std::min(kChunk, entries.size() - begin));
    unsigned bad = 0;
    for (const std::uint32_t entry : chunk) bad |= is_bad_entry(entry, rule);
    if (bad == 0) continue;
    const auto found = std::find_if(chunk.begin(), chunk.end(),
                                    [&](std::uint32_t entry) { return is_bad_entry(entry, rule); });
    return begin + static_cast<std::size_t>(found - chunk.begin());
  }
  return entries.size();
}

bool holds_points(const BoundingSphere& sphere, const PshellView& v, std::size_t begin,
                  std::size_t end) {
  const double limit = double{sphere.radius} * sphere.radius * (1 + kSphereTolerance);
  unsigned outside = 0;
  for (std::size_t i = begin; i < end; ++i) outside |= !(squared_distance(v, i, sphere) <= limit);
  return outside == 0;
}

PointsChecked check_points(const PshellView& v, double bounding_radius_m) {
  const double limit = bounding_radius_m * bounding_radius_m * (1 + kSphereTolerance);
  PointsChecked checked;
  for (std::size_t i = 0; i < v.point_count; ++i) {
    checked.fault = fault_of(v, i, limit);
    checked.bad = i;
    if (checked.fault != PointFault::kNone) break;
    checked.area_m2 += v.weight_m2[i];
  }
  return checked;
}

}  // namespace forcelayer
