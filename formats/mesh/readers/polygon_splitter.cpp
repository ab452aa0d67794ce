#include "formats/mesh/readers/polygon_splitter.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {
namespace {

// A polygon that leaves its plane by more than this fraction of its extent draws a warning.
// Rounding to six printed digits stays below it.
constexpr double kPlanarFraction = 1e-4;

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
  if (!(deviation > kPlanarFraction * std::sqrt(extent))) return;
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

double PolygonSplitter::turn(std::size_t a, std::size_t b, std::size_t c) const {
  return PlanePoints::turn(points_[a], points_[b], points_[c]);
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

// A corner that two parts of the outline share (a bridge to a hole) does not block.
bool PolygonSplitter::is_ear(std::size_t tip) {
  const std::size_t a = previous_[tip], c = next_[tip];
  const double area = turn(a, tip, c);
  if (area <= 0) return area == 0;  // a straight corner covers nothing and can go
  const std::size_t blocker = in_ring_.find_in(a, tip, c);
  if (blocker != PlanePoints::kNone) blocked_by_[blocker].push_back(tip);
  return blocker == PlanePoints::kNone;
}

// The next ear from `from` on; where there is none (the outline crosses itself), the widest corner.
// A tangle of very many corners is clipped as it comes.
std::size_t PolygonSplitter::find_ear(std::size_t from, std::size_t left) {
  while (!open_.empty()) {
    auto tip = open_.lower_bound(from);
    if (tip == open_.end()) tip = open_.begin();
    if (is_ear(*tip)) return *tip;
    open_.erase(tip);  // until a neighbor goes, or what blocks it
  }
  if (looks_left_ < left) return from;
  looks_left_ -= left;
  std::size_t widest = from;
  for (std::size_t i = 0, tip = from; i < left; ++i, tip = next_[tip]) {
    if (turn(previous_[tip], tip, next_[tip]) > turn(previous_[widest], widest, next_[widest])) {
      widest = tip;
    }
  }
  return widest;
}

void PolygonSplitter::clip(std::size_t tip) {
  const std::size_t a = previous_[tip], c = next_[tip];
  next_[a] = c;
  previous_[c] = a;
  next_[tip] = tip;  // no corner of the ring
  open_.erase(tip);
  open_.insert({a, c});
  if (!in_ring_.remove(tip)) return;
  // In an outline that does not cross itself these are no ears now either.
  std::vector<std::size_t>& blocked = blocked_by_[in_ring_.place_of(tip)];
  for (const std::size_t corner : blocked) {
    if (next_[corner] == corner || looks_left_ == 0) continue;
    --looks_left_;
    open_.insert(corner);
  }
  blocked.clear();
}

void PolygonSplitter::clip_ears(std::span<const std::uint32_t> corners, Mesh& mesh) {
  const std::size_t count = corners.size();
  next_.resize(count);
  previous_.resize(count);
  open_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    next_[i] = (i + 1) % count;
    previous_[i] = (i + count - 1) % count;
    open_.insert(open_.end(), i);
  }
  in_ring_.assign(points_);
  blocked_by_.assign(in_ring_.places(), {});
  looks_left_ = 1'000'000 + 64 * count;
  double area = 0, area_without_sign = 0;
  for (std::size_t left = count, tip = 1; left >= 3; --left) {
    tip = find_ear(tip, left);
    const std::size_t a = previous_[tip], c = next_[tip];
    mesh.triangles.push_back({corners[a], corners[tip], corners[c]});
    area += turn(a, tip, c);
    area_without_sign += std::abs(turn(a, tip, c));
    clip(tip);
    tip = next_[c];  // not its neighbor: cutting alternate ears makes fewer slivers
  }
  // The triangles' signed areas always sum to the polygon's; they cover it once only where none
  // is inverted. 1e-9 leaves room for the rounding of `turn`.
  if (area_without_sign > (1 + 1e-9) * area) ++crossing_;
}

void PolygonSplitter::add_warnings(std::vector<std::string>& warnings) const {
  if (not_planar_ > 0) {
    std::ostringstream text;
    text << counted(not_planar_, "polygon") << (not_planar_ == 1 ? " is" : " are")
         << " not planar: corners are up to " << largest_deviation_units_
         << " file units off a plane, so the intended surface may differ from the triangles";
    warnings.push_back(text.str());
  }
  if (crossing_ > 0) {
    warnings.push_back(counted(crossing_, "polygon") + (crossing_ == 1 ? " has" : " have") +
                       " an outline that crosses itself, so that triangles overlap");
  }
}

}  // namespace forcelayer::mesh
