#include "runtime/query/enclosed_object.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <vector>

#include "formats/voxmap_walk.h"

namespace forcelayer::query {
namespace {

// A group of neighboring points: a sphere around them, and the sum of areas times inward normals.
struct Group {
  glm::dvec3 center_m, facing_m2{0};
  double radius_m;

  explicit Group(const BoundingSphere& s) : center_m(s.x, s.y, s.z), radius_m(s.radius) {}
  double distance_m(const glm::dvec3& place) const {
    return glm::length(place - center_m) - radius_m;
  }
};

// The solid angle of a small piece of surface that faces away from the place, by its distance.
double solid_angle(const glm::dvec3& facing_m2, const glm::dvec3& to_m) {
  const double distance_m = std::max(1e-12, glm::length(to_m));
  return glm::dot(facing_m2, to_m) / (distance_m * distance_m * distance_m);
}

// The shell as a surface: how far it is, and how often it winds round a place. Places are in the
// part's axes from its centroid, m.
class ShellSurface {
 public:
  explicit ShellSurface(const PshellView& shell) : shell_(shell) {
    for (std::uint64_t n = 0; n < shell.super_block_count; ++n) {
      super_blocks_.emplace_back(shell.super_blocks[n]);
    }
    for (std::uint64_t block = 0; block < shell.block_count; ++block) {
      Group& group = blocks_.emplace_back(shell.blocks[block]);
      for_each_point(block, [&](std::uint64_t i) { group.facing_m2 += facing_m2(i); });
      super_blocks_[block / shell.super_block_blocks].facing_m2 += group.facing_m2;
    }
  }

  // The distance of the nearest point; infinity where all are farther than `at_most_m`.
  double distance_m(const glm::dvec3& place, double at_most_m) const {
    double min_m = std::nextafter(at_most_m, std::numeric_limits<double>::infinity());
    bool found = false;
    for_each_block([&](const Group& group) { return group.distance_m(place) < min_m; },
                   [&](std::uint64_t block) {
                     for_each_point(block, [&](std::uint64_t i) {
                       const double distance = glm::length(place - point_m(i));
                       if (distance < min_m) min_m = distance, found = true;
                     });
                   });
    return found ? min_m : std::numeric_limits<double>::infinity();
  }

  // 1 inside, 0 outside. Each point is a piece of surface of its own area that faces along its
  // normal; groups far off are one piece.
  double winding(const glm::dvec3& place) const {
    constexpr double kFar = 3;  // radii beyond the sphere
    double sum = 0;
    for_each_block(
        [&](const Group& group) {
          if (!(group.distance_m(place) > kFar * group.radius_m)) return true;
          sum += solid_angle(group.facing_m2, place - group.center_m);
          return false;
        },
        [&](std::uint64_t block) {
          for_each_point(block, [&](std::uint64_t i) {
            sum += solid_angle(facing_m2(i), place - point_m(i));
          });
        });
    return sum / (4 * M_PI);
  }

 private:
  // Visits every block that `enters` is true of, and of whose super-block it is.
  template <typename Enters, typename Visit>
  void for_each_block(Enters enters, Visit visit) const {
    for (std::uint64_t n = 0; n < super_blocks_.size(); ++n) {
      if (!enters(super_blocks_[n])) continue;
      const std::uint64_t first = n * shell_.super_block_blocks;
      const std::uint64_t end =
          std::min<std::uint64_t>(blocks_.size(), first + shell_.super_block_blocks);
      for (std::uint64_t block = first; block < end; ++block) {
        if (enters(blocks_[block])) visit(block);
      }
    }
  }
  template <typename Visit>
  void for_each_point(std::uint64_t block, Visit visit) const {
    const std::uint64_t first = block * shell_.block_points;
    const std::uint64_t end = std::min(shell_.point_count, first + shell_.block_points);
    for (std::uint64_t i = first; i < end; ++i) visit(i);
  }
  glm::dvec3 point_m(std::uint64_t i) const { return {shell_.x[i], shell_.y[i], shell_.z[i]}; }
  glm::dvec3 facing_m2(std::uint64_t i) const {
    return double{shell_.weight_m2[i]} * glm::dvec3(shell_.nx[i], shell_.ny[i], shell_.nz[i]);
  }

  const PshellView& shell_;
  std::vector<Group> super_blocks_, blocks_;
};

using Index = std::array<std::int64_t, 3>;

class EnclosedSearch {
 public:
  EnclosedSearch(const Voxmap& voxmap, const Pshell& shell, const Pose& world_from_center,
                 std::span<const std::uint32_t> felt, std::uint64_t max_bricks)
      : voxmap_(voxmap),
        felt_(felt),
        bricks_left_(max_bricks),
        surface_(shell.view()),
        center_from_world_(inverse(world_from_center)),
        size_m_(voxmap.voxel_size_m()),
        covering_m_(shell.header().covering_radius_m) {
    glm::dvec3 low_m(1e300), high_m(-1e300);
    const PshellView& points = shell.view();
    for (std::uint64_t i = 0; i < points.point_count; ++i) {
      const glm::dvec3 world_m =
          world_from_center.position_m +
          world_from_center.orientation * glm::dvec3(points.x[i], points.y[i], points.z[i]);
      low_m = glm::min(low_m, world_m), high_m = glm::max(high_m, world_m);
    }
    low_ = low_m / size_m_, high_ = high_m / size_m_;
  }

  Result<std::optional<EnclosedObject>> run() {
    for_each_region_where(
        voxmap_.view(),
        [this](const Index& low, std::int64_t edge) {
          return !found_ && !too_many_bricks_ && meets(low, edge);
        },
        [this](const VoxmapRegion& region) { look_at(region); });
    if (!too_many_bricks_) return found_;
    return Error{
        ErrorCode::kUsage, "", "",
        "cannot look for objects inside the part: the scene around it has too many details",
        "bake the scene with larger voxels"};
  }

 private:
  bool meets(const Index& low, std::int64_t edge) const {
    for (int axis = 0; axis < 3; ++axis) {
      const auto from = static_cast<double>(low[static_cast<std::size_t>(axis)]);
      if (from > high_[axis] || from + static_cast<double>(edge) < low_[axis]) return false;
    }
    return true;
  }

  // A region that the shell does not pass through is on one side of it.
  void look_at(const VoxmapRegion& region) {
    if (!region.is_brick) {
      if (uniform_value(region.entry) != static_cast<std::uint32_t>(VoxelValue::kInterior)) return;
      const auto half = static_cast<std::int64_t>(region.edge_voxels / 2);
      // Not all of it need be solid: a hole may be narrower than the layers around its wall.
      const Index middle{region.low[0] + half, region.low[1] + half, region.low[2] + half};
      keep_if_enclosed(middle, mesh_within_m(middle));
      return;
    }
    if (bricks_left_ == 0) {
      too_many_bricks_ = true;
      return;
    }
    --bricks_left_;
    const double half_m = 0.5 * kBrickEdge * size_m_;
    const glm::dvec3 middle_m =
        size_m_ * glm::dvec3(region.low[0], region.low[1], region.low[2]) + half_m;
    const glm::dvec3 place_m = in_part(middle_m);
    const bool one_side = std::isinf(surface_.distance_m(place_m, 2 * half_m + covering_m_));
    if (one_side && !(surface_.winding(place_m) > 0.5)) return;
    // A voxel of the solid in each of eight parts: some may be inside, and others not.
    for (std::int64_t part = 0; part < 8 && !found_; ++part) {
      look_at_part({region.low[0] + 4 * (part >> 2), region.low[1] + 4 * (part >> 1 & 1),
                    region.low[2] + 4 * (part & 1)});
    }
  }

  // The voxel of 4^3 that is deepest in the solid.
  void look_at_part(const Index& low) {
    double min_m = std::numeric_limits<double>::infinity();
    Index deepest{};
    for (std::int64_t n = 0; n < 64; ++n) {
      const Index voxel{low[0] + (n >> 4), low[1] + (n >> 2 & 3), low[2] + (n & 3)};
      if (voxmap_.value(voxel[0], voxel[1], voxel[2]) != VoxelValue::kInterior) continue;
      const double mesh_m = mesh_within_m(voxel);
      if (mesh_m < min_m) min_m = mesh_m, deepest = voxel;
    }
    if (min_m < std::numeric_limits<double>::infinity()) keep_if_enclosed(deepest, min_m);
  }

  // An upper bound of the object's distance from the voxel's center.
  double mesh_within_m(const Index& voxel) const {
    if (voxmap_.distances() == nullptr) {
      return std::sqrt(3.0) * std::max(1u, voxmap_.header().offset_layers) * size_m_;
    }
    return std::max(0.0, voxmap_.max_distance_m(voxel[0], voxel[1], voxel[2]));
  }

  void keep_if_enclosed(const Index& voxel, double mesh_m) {
    const glm::dvec3 world_m = size_m_ * (glm::dvec3(voxel[0], voxel[1], voxel[2]) + 0.5);
    const glm::dvec3 place_m = in_part(world_m);
    if (!(surface_.winding(place_m) > 0.5)) return;
    const double room_m = mesh_m + covering_m_;
    if (surface_.distance_m(place_m, room_m) <= room_m) return;
    const std::uint32_t object = voxmap_.nearest_object(voxel[0], voxel[1], voxel[2]);
    if (object != 0 && std::find(felt_.begin(), felt_.end(), object) != felt_.end()) return;
    found_ = EnclosedObject{object, world_m};
  }

  glm::dvec3 in_part(const glm::dvec3& world_m) const {
    return center_from_world_.position_m + center_from_world_.orientation * world_m;
  }

  const Voxmap& voxmap_;
  std::span<const std::uint32_t> felt_;
  std::uint64_t bricks_left_;
  bool too_many_bricks_ = false;
  ShellSurface surface_;
  Pose center_from_world_;
  double size_m_, covering_m_;
  glm::dvec3 low_, high_;  // box of the shell's points, voxels
  std::optional<EnclosedObject> found_;
};

}  // namespace

Result<std::optional<EnclosedObject>> find_enclosed_object(const Voxmap& voxmap,
                                                           const Pshell& shell,
                                                           const Pose& world_from_center,
                                                           std::span<const std::uint32_t> felt,
                                                           std::uint64_t max_bricks) {
  if (shell.header().mass_source != static_cast<std::uint32_t>(MassSource::kVolume)) {
    return std::optional<EnclosedObject>{};
  }
  return EnclosedSearch(voxmap, shell, world_from_center, felt, max_bricks).run();
}

}  // namespace forcelayer::query
