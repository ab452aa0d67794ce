#include "runtime/guard/between_points.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/guard/seat_kernel.h"

namespace forcelayer::guard {
namespace {

// Points with normals nearer than this, as a cosine, lie in one flat face, and those nearer than
// kOneFace in one that bends, unless the path between them lies in the face of one of them:
// its fraction along that normal is at most kInFace.
constexpr float kSameNormal = 0.9f, kOneFace = 0.74f, kInFace = 0.12f;
// Interpolation makes a distance fall by up to kFlatFall per length where there is nothing, in a
// bore of a few voxels. So an edge counts where one of the two falls is larger, and in full from
// kSteepFall on. The other fall may be smaller: it counts from kGentleFall on, and in full from
// kFlatFall on. With half of that, rings stayed on their shafts.
constexpr float kGentleFall = 0.1f, kFlatFall = 0.2f, kSteepFall = 0.4f;

// The distance from the static mesh at a place, interpolated between the centers of voxels; each
// has the least distance that its code allows.
double stored_distance_at_m(const Voxmap& map, const glm::dvec3& world_m) {
  const double s = map.voxel_size_m();
  const glm::dvec3 at = world_m / s - 0.5, low = glm::floor(at), between = at - low;
  double distance_m = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::dvec3 weight = step * between + (1.0 - step) * (1.0 - between);
    const glm::i64vec3 voxel(low + step);
    const double stored_m = map.min_distance_m(voxel.x, voxel.y, voxel.z);
    distance_m += weight.x * weight.y * weight.z * std::max(stored_m, -2 * s);
  }
  return distance_m;
}

// The fraction that counts of what falls by so much per length.
float counted(float fall, float from, float in_full_from) {
  return std::clamp((fall - from) / (in_full_from - from), 0.0f, 1.0f);
}

}  // namespace

std::optional<BetweenPoints::Edge> BetweenPoints::edge_between(std::uint32_t a,
                                                               std::uint32_t b) const noexcept {
  const glm::vec3 path_m = probe_.arm_m(b) - probe_.arm_m(a);
  const float distance_a_m = probe_.stored_distance_m(a),
              distance_b_m = probe_.stored_distance_m(b);
  const float length_m = glm::length(path_m);
  glm::vec3 normal_a = probe_.normal(a), normal_b = probe_.normal(b);
  const float alike = glm::dot(normal_a, normal_b);
  if (alike < kSameNormal) {
    // The normal of a point on a sharp edge is that of no face.
    if (std::abs(glm::dot(path_m, normal_b)) <= kInFace * length_m) {
      normal_a = normal_b;
    } else if (std::abs(glm::dot(path_m, normal_a)) <= kInFace * length_m) {
      normal_b = normal_a;
    } else if (alike < kOneFace) {
      return std::nullopt;
    }
  }
  const auto along = [&](const glm::vec3& n) { return path_m - glm::dot(path_m, n) * n; };
  const float least_m = kGentleFall * length_m;
  float fall_a_m = -glm::dot(probe_.slope(a), along(normal_a));
  if (!(fall_a_m > least_m)) return std::nullopt;
  float fall_b_m = glm::dot(probe_.slope(b), along(normal_b));
  if (!(fall_b_m > least_m)) return std::nullopt;
  const float both = counted(std::max(fall_a_m, fall_b_m) / length_m, kFlatFall, kSteepFall);
  if (!(both > 0)) return std::nullopt;
  fall_a_m *= both * counted(fall_a_m / length_m, kGentleFall, kFlatFall);
  fall_b_m *= both * counted(fall_b_m / length_m, kGentleFall, kFlatFall);
  const float per_fall = 1 / (fall_a_m + fall_b_m);
  const float t = (distance_a_m - distance_b_m + fall_b_m) * per_fall;
  if (!(t > 0 && t < 1)) return std::nullopt;
  const std::uint32_t object = probe_.object_of(a);
  if (probe_.object_of(b) != object) return std::nullopt;
  return Edge{distance_a_m - fall_a_m * t, fall_b_m * per_fall, object};
}

// Finds the pairs of neighbors near one object with an edge between them, and gives each to `take`.
// Some edges that are not below `highest_m` are left out. Where the distance falls by less than
// kFlatFall per length, an edge lies hardly deeper than the point: only points that are nearer than
// `gentle_m` are read there.
template <typename Take>
void BetweenPoints::for_each_edge(float highest_m, float gentle_m, const Take& take) noexcept {
  constexpr float kMargin = 1.001f;  // exceeds rounding
  constexpr float kMaxSum = 1.2f;
  const float reach_m = kMargin * neighbor_m_;
  const TiltedPoints found = find_tilted(probe_,
                                         {neighbor_m_, gentle_m, kGentleFall * kGentleFall,
                                          kFlatFall * kFlatFall, highest_m, reach_m * reach_m},
                                         steep_.data(), gentle_.data());
  const std::span<const std::uint32_t> steep(steep_.data(), found.steep),
      gentle(gentle_.data(), found.gentle);
  for (const std::uint32_t i : steep) position_[probe_.point(i)] = i;
  for (const std::uint32_t i : gentle) position_[probe_.point(i)] = i | kGentle;
  const auto take_edge = [&](std::uint32_t a, std::uint32_t b) {
    // A slope is hardly above 1: two points that are farther from the scene than apart have nothing
    // in it between them.
    const glm::vec3 path_m = probe_.arm_m(b) - probe_.arm_m(a);
    const float sum_m = probe_.stored_distance_m(a) + probe_.stored_distance_m(b);
    if (sum_m > 0 && sum_m * sum_m > kMaxSum * kMaxSum * glm::dot(path_m, path_m)) return;
    if (const std::optional<Edge> edge = edge_between(a, b)) take(a, b, *edge);
  };
  for (const std::uint32_t a : steep) {
    for (const std::uint32_t point : neighbors_->after(probe_.point(a))) {
      const std::uint32_t b = position_[point];
      if (b != field::ContactSet::kNone) take_edge(a, b & ~kGentle);
    }
  }
  for (const std::uint32_t a : gentle) {
    for (const std::uint32_t point : neighbors_->after(probe_.point(a))) {
      const std::uint32_t b = position_[point];
      if ((b & kGentle) == 0) take_edge(a, b);
    }
  }
  for (const std::uint32_t i : steep) position_[probe_.point(i)] = field::ContactSet::kNone;
  for (const std::uint32_t i : gentle) position_[probe_.point(i)] = field::ContactSet::kNone;
}

// How near to the scene a point is read whose distance falls by less than kFlatFall per length.
float BetweenPoints::gentle_reach_m(float onset_m) const noexcept {
  return onset_m + kFlatFall * neighbor_m_;
}

bool BetweenPoints::bars_any(const Seat& seat, std::span<const std::uint8_t> left_out) noexcept {
  float highest_m = -neighbor_m_, onset_m = -neighbor_m_;
  for (const SeatObject& object : seat.objects()) {
    if (!object.feels_between) continue;
    highest_m = std::max(highest_m, object.between_floor_m);
    onset_m = std::max(onset_m, object.between_m);
  }
  bool barred = false;
  const auto bar = [&](std::uint32_t, std::uint32_t, const Edge& edge) {
    if (!(edge.distance_m < highest_m)) return;
    const SeatObject* const object = seat.find(edge.object);
    if (object == nullptr || !object->feels_between) return;
    if (edge.object < left_out.size() && left_out[edge.object] != 0) return;
    barred = barred || edge.distance_m < object->between_floor_m;
  };
  for_each_edge(highest_m, gentle_reach_m(onset_m), bar);
  return barred;
}

// Whether the object between two points of one flat face goes on into the part, behind the face,
// for three voxels or more: as a sheet that runs through it, and not as an edge that lies against
// it. Where it goes on, the distance is small along its plane and grows to both sides. The part
// itself must be there: in a groove that the object stands in, shell points are near.
bool BetweenPoints::runs_through(const Pose& world_from_center, std::uint32_t a, std::uint32_t b,
                                 const Edge& edge) const {
  constexpr double kDeepVoxels = 3, kBesideVoxels = 2, kOnVoxels = 0.75, kGrowsVoxels = 0.75;
  if (glm::dot(probe_.normal(a), probe_.normal(b)) < kSameNormal) return false;
  const Voxmap& map = probe_.voxmap();
  const double s = map.voxel_size_m();
  const glm::dvec3 arm_a(probe_.arm_m(a)), arm_b(probe_.arm_m(b));
  const glm::dvec3 inward = glm::normalize(glm::dvec3(probe_.normal(a) + probe_.normal(b)));
  const glm::dvec3 across = glm::normalize(arm_b - arm_a);
  const glm::dvec3 on_face = glm::mix(arm_b, arm_a, double{edge.weight});
  const auto stands_at = [&](double deep_voxels) {
    const glm::dvec3 at = world_from_center.position_m + on_face + deep_voxels * s * inward;
    const double here_m = stored_distance_at_m(map, at);
    if (!(here_m < kOnVoxels * s)) return false;
    for (const double side : {-1.0, 1.0}) {
      const double beside_m = stored_distance_at_m(map, at + side * kBesideVoxels * s * across);
      if (!(beside_m > here_m + kGrowsVoxels * s)) return false;
    }
    return true;
  };
  if (!stands_at(0.5 * kDeepVoxels) || !stands_at(kDeepVoxels)) return false;
  const glm::dquat part_from_world = glm::conjugate(world_from_center.orientation);
  const glm::dvec3 first = part_from_world * on_face, way = part_from_world * inward;
  const glm::dvec3 deepest = first + kDeepVoxels * s * way;
  // The walls of a groove that holds the object are a voxel from its middle, or nearer.
  const double covering_m = probe_.query().shell().header().covering_radius_m;
  const PshellView& shell = probe_.query().shell().view();
  bool is_thin = false;  // the part ends before: points of both faces of a wall cover it together
  for (std::uint64_t i = 0; i < shell.point_count; ++i) {
    const glm::dvec3 point(shell.x[i], shell.y[i], shell.z[i]);
    if (glm::length(point - deepest) < covering_m + s) return false;
    const glm::dvec3 normal(shell.nx[i], shell.ny[i], shell.nz[i]);
    const double along_m = std::clamp(glm::dot(point - first, way), 0.0, kDeepVoxels * s);
    is_thin = is_thin || (glm::dot(normal, way) < -kSameNormal &&
                          glm::length(point - first - along_m * way) <= 2 * covering_m);
  }
  // Behind a thin wall an object may stand that does not pierce it. One that does stands
  // before it, too.
  return !is_thin || stands_at(-0.5 * kDeepVoxels);
}

void BetweenPoints::find(const Pose& world_from_center, Seat& seat) {
  if (!neighbors_) {
    const Pshell& shell = probe_.query().shell();
    neighbor_m_ = static_cast<float>(2 * shell.header().covering_radius_m);
    neighbors_.emplace(shell.view(), double{neighbor_m_});
    position_.assign(shell.view().point_count, field::ContactSet::kNone);
    steep_.resize(shell.view().point_count), gentle_.resize(shell.view().point_count);
  }
  float highest_m = -neighbor_m_;
  for (const SeatObject& object : seat.objects()) {
    highest_m = std::max(highest_m, object.between_m);
  }
  const auto take = [&](std::uint32_t a, std::uint32_t b, const Edge& edge) {
    for (SeatObject& object : seat.entries()) {
      if (object.object != edge.object) continue;
      object.between_m = std::min(object.between_m, edge.distance_m);
      object.runs_through = object.runs_through || runs_through(world_from_center, a, b, edge);
    }
  };
  for_each_edge(neighbor_m_, gentle_reach_m(highest_m), take);
}

void BetweenPoints::press(const Seat& seat, field::ContactSet& out) noexcept {
  float highest_m = -neighbor_m_;
  for (const SeatObject& object : seat.objects()) {
    if (object.feels_between) highest_m = std::max(highest_m, object.between_m);
  }
  const auto press_edge = [&](std::uint32_t a, std::uint32_t b, const Edge& edge) {
    if (edge.distance_m < highest_m) press_pair(a, b, edge, seat, out);
  };
  for_each_edge(highest_m, gentle_reach_m(highest_m), press_edge);
}

// An edge between two points presses both, where it is deeper than they are.
void BetweenPoints::press_pair(std::uint32_t a, std::uint32_t b, const Edge& edge, const Seat& seat,
                               field::ContactSet& out) const noexcept {
  const SeatObject* const object = seat.find(edge.object);
  if (object == nullptr || !object->feels_between) return;
  const float depth_m = object->between_m - edge.distance_m;
  const glm::vec3 push = glm::mix(probe_.slope(b), probe_.slope(a), edge.weight);
  const float length = glm::length(push);
  if (!(depth_m > 0 && length >= field::kMinSlope)) return;
  const glm::vec3 u = push / length;
  const glm::vec3 arm = glm::mix(probe_.arm_m(b), probe_.arm_m(a), edge.weight);
  const bool barred = edge.distance_m < object->between_floor_m;
  for (const std::uint32_t i : {a, b}) {
    if (barred && out.is_barred[i] == 0) out.is_barred[i] = 1, ++out.barred;
    if (depth_m <= out.depth_m[i]) continue;
    out.depth_m[i] = depth_m;
    out.ux[i] = u.x, out.uy[i] = u.y, out.uz[i] = u.z;
    out.rx[i] = arm.x, out.ry[i] = arm.y, out.rz[i] = arm.z;
  }
}

}  // namespace forcelayer::guard
