// Points, directions and boxes of the part's frame, in double precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace forcelayer::part {

struct Vec3 {
  double x = 0, y = 0, z = 0;

  friend bool operator==(const Vec3&, const Vec3&) = default;
  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
};

inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline double length_squared(const Vec3& a) { return dot(a, a); }
inline double length(const Vec3& a) { return std::sqrt(length_squared(a)); }

// `a` scaled to length 1; zero where `a` is zero.
inline Vec3 normalized(const Vec3& a) {
  const double norm = length(a);
  return norm > 0 ? (1 / norm) * a : Vec3{};
}

// Largest absolute coordinate.
inline double max_abs(const Vec3& a) {
  return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)});
}

// The largest integer not above `x`, |x| < 2^62. Without the call that std::floor is where the
// compiler may not assume SSE4.1.
inline std::int64_t floor_to_int(double x) {
  const auto truncated = static_cast<std::int64_t>(x);
  return truncated - (x < static_cast<double>(truncated));
}

// A cube of a grid of cubes with this edge.
using Cube = std::array<std::int64_t, 3>;
inline Cube cube_at(const Vec3& p, double edge) {
  const Vec3 scaled = (1 / edge) * p;
  return {floor_to_int(scaled.x), floor_to_int(scaled.y), floor_to_int(scaled.z)};
}
struct CubeHash {
  std::size_t operator()(const Cube& cube) const {
    std::uint64_t hash = 0;
    for (const std::int64_t i : cube) {
      hash = (hash ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

// Some unit vector at a right angle to the unit vector `n`.
inline Vec3 any_perpendicular(const Vec3& n) {
  return normalized(std::abs(n.x) < 0.5 ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0}));
}

// The component along axis 0, 1 or 2.
inline double coordinate(const Vec3& p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

inline bool is_finite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

// Lexicographic: a total order for finite coordinates.
inline bool lexicographic_less(const Vec3& a, const Vec3& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

// The box around some points.
struct Box {
  Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
           std::numeric_limits<double>::infinity()};
  Vec3 high = -low;

  void grow(const Vec3& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  double distance_squared(const Vec3& p) const {
    const double x = std::max(std::max(low.x - p.x, p.x - high.x), 0.0);
    const double y = std::max(std::max(low.y - p.y, p.y - high.y), 0.0);
    const double z = std::max(std::max(low.z - p.z, p.z - high.z), 0.0);
    return x * x + y * y + z * z;
  }

  // 0, 1 or 2: the axis along which the box is longest, the first of equals.
  int longest_axis() const {
    const Vec3 size = high - low;
    if (size.x >= size.y && size.x >= size.z) return 0;
    return size.y >= size.z ? 1 : 2;
  }
};

}  // namespace forcelayer::part
