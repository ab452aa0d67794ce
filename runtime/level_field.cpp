#include "runtime/level_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace forcelayer {
namespace {

constexpr float kAgreeing = 0.9f;     // cosine of slope and normal: push along the normal
constexpr float kDisagreeing = 0.7f;  // push along the slope
constexpr float kWeakSlope = 0.1f;    // per voxel: below, the slope fades
constexpr float kBuried = -0.5f;      // phi: below, the normal alone begins to count
constexpr float kTiny = 1e-6f;        // lengths below are directionless

// Of values 0 free, 1 interior, 2 surface, 3 proximity.
constexpr std::array<int, 4> kLevelOfValue{2, -1, 0, 1};

// Sums over the 2x2x2 voxels around each corner of a voxel; corner 4 x + 2 y + z.
struct CornerSums {
  std::array<int, 8> level;                      // 8 times the mean
  std::array<std::array<int, 8>, 3> difference;  // 4 times the mean difference along an axis
};

CornerSums corner_sums(const std::array<int, 27>& levels) {
  CornerSums sums{};
  for (int corner = 0; corner < 8; ++corner) {
    for (int voxel = 0; voxel < 8; ++voxel) {
      const int x = (corner >> 2) + (voxel >> 2);
      const int y = (corner >> 1 & 1) + (voxel >> 1 & 1);
      const int z = (corner & 1) + (voxel & 1);
      const int level = levels[9 * x + 3 * y + z];
      sums.level[corner] += level;
      sums.difference[0][corner] += voxel & 4 ? level : -level;
      sums.difference[1][corner] += voxel & 2 ? level : -level;
      sums.difference[2][corner] += voxel & 1 ? level : -level;
    }
  }
  return sums;
}

float mix(float a, float b, float share) { return a + share * (b - a); }

// Trilinear between the corners; along z first, x last.
float between_corners(const std::array<int, 8>& at, const std::array<float, 3>& fraction) {
  std::array<float, 4> edges{};
  for (int edge = 0; edge < 4; ++edge) {
    edges[edge] =
        mix(static_cast<float>(at[2 * edge]), static_cast<float>(at[2 * edge + 1]), fraction[2]);
  }
  return mix(mix(edges[0], edges[1], fraction[1]), mix(edges[2], edges[3], fraction[1]),
             fraction[0]);
}

using Vector = std::array<float, 3>;

float dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

float clamp01(float x) { return std::min(std::max(x, 0.0f), 1.0f); }

// phi (voxels) and its slope (per voxel, world axes) at a point.
struct LevelSample {
  float phi;
  Vector slope;
};

LevelSample sample(const std::array<int, 27>& levels, const Vector& fraction) {
  const CornerSums sums = corner_sums(levels);
  return {between_corners(sums.level, fraction) * 0.125f,
          {between_corners(sums.difference[0], fraction) * 0.25f,
           between_corners(sums.difference[1], fraction) * 0.25f,
           between_corners(sums.difference[2], fraction) * 0.25f}};
}

// The vector v of the class comment: its length and direction are those of the push.
Vector push(const LevelSample& sample, const Vector& n) {
  const Vector& g = sample.slope;
  const float steepness = std::sqrt(dot(g, g));
  const float per_steepness = 1.0f / std::max(steepness, kTiny);
  const float t =
      clamp01((dot(g, n) * per_steepness - kDisagreeing) * (1.0f / (kAgreeing - kDisagreeing)));
  const float w = t * t * (3.0f - 2.0f * t);
  const float f = std::min(steepness * (1.0f / kWeakSlope), 1.0f);
  const float h = clamp01((kBuried - sample.phi) * 4.0f);
  const float along_normal = f * w + (0.5f - 0.5f * f) * h;
  const float along_slope = (f - f * w) * per_steepness;
  return {along_normal * n[0] + along_slope * g[0], along_normal * n[1] + along_slope * g[1],
          along_normal * n[2] + along_slope * g[2]};
}

}  // namespace

LevelField::LevelField(const Voxmap& voxmap)
    : map_(voxmap.view()),
      voxel_size_m_(static_cast<float>(voxmap.voxel_size_m())),
      euclidean_layers_(voxmap.header().metric == static_cast<std::uint32_t>(Metric::kEuclidean)) {
  const VoxmapHeader& header = voxmap.header();
  for (unsigned axis = 0; axis < 3; ++axis) {
    const bool cut_min = (header.cropped_sides >> (2 * axis)) & 1u;
    const bool cut_max = (header.cropped_sides >> (2 * axis + 1)) & 1u;
    const std::int64_t origin = header.directory_origin[axis];
    known_min_[axis] =
        cut_min ? header.valid_min_voxel[axis] - origin : std::numeric_limits<std::int64_t>::min();
    known_max_[axis] =
        cut_max ? header.valid_max_voxel[axis] - origin : std::numeric_limits<std::int64_t>::max();
  }
}

std::optional<Error> LevelField::unreadable(const Voxmap& voxmap) {
  const VoxmapHeader& header = voxmap.header();
  if (header.bits_per_voxel != 2) {
    return Error{ErrorCode::kUsage, "", "level field",
                 "the scene stores distances of " + std::to_string(header.bits_per_voxel) +
                     " bits, the level field reads two-bit values",
                 "bake the scene with --bits 2, or use --force tangent-plane"};
  }
  if (header.offset_layers == 0) {
    return Error{ErrorCode::kUsage, "", "level field",
                 "the scene has no offset layers, so its values jump from interior to proximity",
                 "bake the scene with --layers 1 or more, or use --force tangent-plane"};
  }
  return std::nullopt;
}

int LevelField::level(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept {
  std::array<std::int64_t, 3> v{x, y, z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    v[axis] = std::min(std::max(v[axis], known_min_[axis]), known_max_[axis] - 1);
    if (v[axis] < 0 || v[axis] >= std::int64_t{512} * map_.directory_dims[axis]) {
      return kLevelOfValue[0];
    }
  }
  return kLevelOfValue[map_.lookup(static_cast<std::int32_t>(v[0]), static_cast<std::int32_t>(v[1]),
                                   static_cast<std::int32_t>(v[2]))
                           .code &
                       3u];
}

LevelField::Measured LevelField::measured(const CollectedPoints& points,
                                          std::uint32_t i) const noexcept {
  std::array<int, 27> levels{};
  for (int n = 0; n < 27; ++n) {
    levels[n] =
        level(std::int64_t{points.vx[i]} + n / 9 - 1, std::int64_t{points.vy[i]} + n / 3 % 3 - 1,
              std::int64_t{points.vz[i]} + n % 3 - 1);
  }
  const Vector normal{points.nx[i], points.ny[i], points.nz[i]};
  const LevelSample at = sample(levels, {points.fx[i], points.fy[i], points.fz[i]});
  const Vector v = push(at, normal);
  const float length = std::sqrt(dot(v, v));
  if (!(length > kTiny)) return {at.phi < 0.0f ? 0.0f : -at.phi * voxel_size_m_, normal};
  const float slant = euclidean_layers_ ? length : std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]);
  const float per_length = 1.0f / length;
  return {-at.phi * slant * voxel_size_m_,
          {v[0] * per_length, v[1] * per_length, v[2] * per_length}};
}

void LevelField::evaluate(const CollectedPoints& points, FieldSamples& samples) const noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (points.value[i] == static_cast<std::uint8_t>(VoxelValue::kProximity)) continue;
    const Measured at = measured(points, i);
    if (!(at.depth_m > 0.0f)) continue;
    samples.set(count++, i, at.depth_m, at.direction);
  }
  samples.count = count;
}

void LevelField::measure(const CollectedPoints& points, FieldSamples& samples) const noexcept {
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const Measured at = measured(points, i);
    samples.set(i, i, at.depth_m, at.direction);
  }
  samples.count = points.count;
}

}  // namespace forcelayer
