#include "formats/mesh/readers/polygon_splitter.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {
namespace {

// A polygon that leaves its plane by more than this share of its extent draws a warning. Rounding
// to six printed digits stays below it.
constexpr double kPlanarShare = 1e-4;

Vec3d minus(const Vec3d& a, const Vec3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

double dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Twice the polygon's area vector (Newell).
Vec3d area_vector(std::span<const std::uint32_t> corners, const Mesh& mesh) {
  const Vec3d& origin = mesh.vertices[corners[0]];
  Vec3d sum{0, 0, 0};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3d part = cross(minus(mesh.vertices[corners[i]], origin),
                             minus(mesh.vertices[corners[i + 1]], origin));
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += part[axis];
  }
  return sum;
}

std::size_t largest_axis(const Vec3d& v) {
  std::size_t largest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (std::abs(v[axis]) > std::abs(v[largest])) largest = axis;
  }
  return largest;
}

void fan(std::span<const std::uint32_t> corners, Mesh& mesh) {
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    mesh.triangles.push_back({corners[0], corners[i], corners[i + 1]});
  }
}

// Counts the changes of sign around a ring of steps; steps of zero have none.
class SignChanges {
 public:
  void add(double step) {
    const int sign = (step > 0) - (step < 0);
    if (sign == 0) return;
    if (first_ == 0) first_ = sign;
    if (last_ != 0 && sign != last_) ++changes_;
    last_ = sign;
  }
  int around() const { return changes_ + (first_ != last_ ? 1 : 0); }

 private:
  int first_ = 0;
  int last_ = 0;
  int changes_ = 0;
};

}  // namespace

void PolygonSplitter::split(std::span<const std::uint32_t> corners, Mesh& mesh) {
  if (corners.size() == 3) return fan(corners, mesh);
  const Vec3d normal = area_vector(corners, mesh);
  if (normal[largest_axis(normal)] == 0) return fan(corners, mesh);  // no area, no plane
  note_planarity(corners, mesh, normal);
  project(corners, mesh, normal);
  if (is_convex()) return fan(corners, mesh);
  clip_ears(corners, mesh);
}

void PolygonSplitter::note_planarity(std::span<const std::uint32_t> corners, const Mesh& mesh,
                                     const Vec3d& normal) {
  const double length = std::sqrt(dot(normal, normal));
  double lowest = 0, highest = 0, extent = 0;
  for (const std::uint32_t corner : corners) {
    const Vec3d offset = minus(mesh.vertices[corner], mesh.vertices[corners[0]]);
    const double height = dot(offset, normal) / length;
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
    extent = std::max(extent, dot(offset, offset));
  }
  const double deviation = highest - lowest;
  if (!(deviation > kPlanarShare * std::sqrt(extent))) return;
  ++not_planar_;
  largest_deviation_units_ = std::max(largest_deviation_units_, deviation);
}

void PolygonSplitter::project(std::span<const std::uint32_t> corners, const Mesh& mesh,
                              const Vec3d& normal) {
  const std::size_t dropped = largest_axis(normal);
  std::size_t x = (dropped + 1) % 3, y = (dropped + 2) % 3;
  if (normal[dropped] < 0) std::swap(x, y);
  points_.clear();
  for (const std::uint32_t corner : corners) {
    points_.push_back({mesh.vertices[corner][x], mesh.vertices[corner][y]});
  }
}

// Twice the signed area of the corners a, b, c: positive for a turn to the left.
double PolygonSplitter::turn(std::size_t a, std::size_t b, std::size_t c) const {
  const Point &p = points_[a], &q = points_[b], &r = points_[c];
  return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

bool PolygonSplitter::is_convex() const {
  const std::size_t count = points_.size();
  SignChanges x_steps, y_steps;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = (i + 1) % count;
    if (turn(i, j, (i + 2) % count) < 0) return false;
    x_steps.add(points_[j].x - points_[i].x);
    y_steps.add(points_[j].y - points_[i].y);
  }
  return x_steps.around() <= 2 && y_steps.around() <= 2;  // else it winds more than once
}

bool PolygonSplitter::is_ear(std::size_t tip) {
  const std::size_t a = previous_[tip], c = next_[tip];
  Blocker& known = blockers_[tip];
  if (known.previous == a && known.next == c && previous_[known.corner] != kClipped) return false;
  const double area = turn(a, tip, c);
  if (area <= 0) return area == 0;  // a straight corner covers nothing and can go
  const auto same = [&](std::size_t i, std::size_t j) {
    return points_[i].x == points_[j].x && points_[i].y == points_[j].y;
  };
  for (std::size_t p = next_[c]; p != a; p = next_[p]) {
    // A corner that two parts of the outline share (a bridge to a hole) does not block.
    if (same(p, a) || same(p, tip) || same(p, c)) continue;
    if (turn(a, tip, p) >= 0 && turn(tip, c, p) >= 0 && turn(c, a, p) >= 0) {
      known = {a, c, p};
      return false;
    }
  }
  return true;
}

// The next ear from `from` on; where there is none (the outline crosses itself), the widest corner.
std::size_t PolygonSplitter::find_ear(std::size_t from, std::size_t left) {
  std::size_t widest = from;
  for (std::size_t i = 0, tip = from; i < left; ++i, tip = next_[tip]) {
    if (is_ear(tip)) return tip;
    if (turn(previous_[tip], tip, next_[tip]) > turn(previous_[widest], widest, next_[widest])) {
      widest = tip;
    }
  }
  return widest;
}

void PolygonSplitter::clip_ears(std::span<const std::uint32_t> corners, Mesh& mesh) {
  const std::size_t count = corners.size();
  next_.resize(count);
  previous_.resize(count);
  blockers_.assign(count, {});
  for (std::size_t i = 0; i < count; ++i) {
    next_[i] = (i + 1) % count;
    previous_[i] = (i + count - 1) % count;
  }
  double area = 0, area_without_sign = 0;
  for (std::size_t left = count, tip = 1; left >= 3; --left) {
    tip = find_ear(tip, left);
    const std::size_t a = previous_[tip], c = next_[tip];
    mesh.triangles.push_back({corners[a], corners[tip], corners[c]});
    area += turn(a, tip, c);
    area_without_sign += std::abs(turn(a, tip, c));
    next_[a] = c;
    previous_[c] = a;
    previous_[tip] = kClipped;
    tip = next_[c];  // not its neighbor: cutting alternate ears makes fewer slivers
  }
  // The triangles' signed areas always sum to the polygon's; they cover it once only where none
  // is inverted. 1e-9 leaves room for the rounding of `turn`.
  if (area_without_sign > (1 + 1e-9) * area) ++crossing_;
}

void PolygonSplitter::add_warnings(std::vector<std::string>& warnings) const {
  if (not_planar_ > 0) {
    std::ostringstream text;
    text << counted(not_planar_, "polygon") << " not planar, by up to " << largest_deviation_units_
         << " file units; split into triangles in one of several equal ways";
    warnings.push_back(text.str());
  }
  if (crossing_ > 0) {
    warnings.push_back(counted(crossing_, "polygon") +
                       " with an outline that crosses itself; split into triangles that overlap");
  }
}

}  // namespace forcelayer::mesh
