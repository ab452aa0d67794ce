#include "runtime/contact_query.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>

namespace forcelayer {
namespace {

constexpr std::size_t kLanePadding = 64;  // elements that a vector store may spill behind the last
constexpr float kBelowOne = 0x1.fffffep-1f;

// VoxelValue of every stored code of a map (voxmap_format.md, bricks).
std::array<std::uint8_t, 256> value_table(const VoxmapHeader& header) {
  std::array<std::uint8_t, 256> table{};
  for (std::uint32_t code = 0; code < table.size(); ++code) {
    VoxelValue value = VoxelValue::kFree;
    if (header.bits_per_voxel == 2) {
      value = static_cast<VoxelValue>(code & 3u);
    } else if (code < header.surface_code) {
      value = VoxelValue::kInterior;
    } else if (code < header.proximity_code) {
      value = VoxelValue::kSurface;
    } else if (code < header.free_code) {
      value = VoxelValue::kProximity;
    }
    table[code] = static_cast<std::uint8_t>(value);
  }
  return table;
}

float dot(const std::array<float, 3>& row, float x, float y, float z) {
  return row[0] * x + row[1] * y + row[2] * z;
}

}  // namespace

void CollectedPoints::reserve(std::uint64_t points) {
  const std::size_t room = points + kLanePadding;
  index.resize(room);
  value.resize(room);
  for (auto* values : {&vx, &vy, &vz}) values->resize(room);
  for (auto* values : {&fx, &fy, &fz, &rx, &ry, &rz, &nx, &ny, &nz}) values->resize(room);
}

void CollectedPoints::clear() noexcept {
  count = interior_count = surface_count = proximity_count = 0;
  outside_map = false;
}

ContactQuery::ContactQuery(const Voxmap& voxmap, const Pshell& shell)
    : voxmap_(voxmap),
      shell_(shell),
      radius_voxels_(shell.header().bounding_radius_m / voxmap.voxel_size_m()),
      voxel_size_m_(static_cast<float>(voxmap.voxel_size_m())),
      value_of_code_(value_table(voxmap.header())) {
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

VoxelPose ContactQuery::voxel_pose(const Pose& world_from_center) const noexcept {
  VoxelPose pose{};
  const glm::dmat3 rotation = glm::mat3_cast(world_from_center.orientation);  // column-major
  const double s = voxmap_.voxel_size_m();
  const VoxmapView& map = voxmap_.view();
  const double reach = radius_voxels_ + 2;
  pose.within_reach = true;
  for (int axis = 0; axis < 3; ++axis) {
    for (int column = 0; column < 3; ++column) {
      pose.rotation[axis][column] = static_cast<float>(rotation[column][axis]);
      pose.turn[axis][column] = static_cast<float>(rotation[column][axis] / s);
    }
    const double position = world_from_center.position_m[axis] / s;
    const double whole = std::floor(position);
    const double relative = whole - static_cast<double>(map.directory_origin[axis]);
    const double extent = 512.0 * map.directory_dims[axis];
    if (!(relative > -reach && relative < extent + reach)) {  // NaN too
      pose.within_reach = false;
      continue;
    }
    pose.fraction[axis] = static_cast<float>(position - whole);
    pose.whole[axis] = static_cast<std::int32_t>(relative);
  }
  return pose;
}

double ContactQuery::rounding_bound_m() const {
  // Per axis, in voxels, u = 2^-24, R the radius: rounding the matrix, three products and two sums
  // costs at most 4u R (Cauchy-Schwarz on the row), rounding the fraction u, adding it u (R + 1);
  // doubled for higher orders. The centre itself is double: 2^-52 of the largest index at reach.
  const VoxmapView& map = voxmap_.view();
  const double u = std::ldexp(1.0, -24);
  double error2 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double origin = static_cast<double>(map.directory_origin[axis]);
    const double far =
        std::max(std::abs(origin), std::abs(origin + 512.0 * map.directory_dims[axis]));
    const double error =
        2 * u * (5 * radius_voxels_ + 2) + std::ldexp(far + radius_voxels_ + 2, -52);
    error2 += error * error;
  }
  return std::sqrt(error2) * voxmap_.voxel_size_m();
}

bool ContactQuery::beyond_cropped_side(std::int32_t x, std::int32_t y,
                                       std::int32_t z) const noexcept {
  return x < known_min_[0] || x >= known_max_[0] || y < known_min_[1] || y >= known_max_[1] ||
         z < known_min_[2] || z >= known_max_[2];
}

bool ContactQuery::sphere_beyond_cropped_side(const glm::dvec3& center_m) const noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const double relative = center_m[axis] / voxmap_.voxel_size_m() -
                            static_cast<double>(voxmap_.view().directory_origin[axis]);
    const double low = relative - radius_voxels_ - 1, high = relative + radius_voxels_ + 1;
    if (low < static_cast<double>(known_min_[axis])) return true;
    if (high >= static_cast<double>(known_max_[axis])) return true;
  }
  return false;
}

void ContactQuery::collect_point(const VoxelPose& pose, std::uint32_t point,
                                 CollectedPoints& out) noexcept {
  const PshellView& shell = shell_.view();
  std::array<float, 3> offset{}, fraction{};  // voxels, from the centre; in the point's voxel
  std::array<std::int32_t, 3> voxel{};
  for (int axis = 0; axis < 3; ++axis) {
    offset[axis] = dot(pose.turn[axis], shell.x[point], shell.y[point], shell.z[point]);
    const float position = offset[axis] + pose.fraction[axis];
    const float whole = std::floor(position);
    voxel[axis] = pose.whole[axis] + static_cast<std::int32_t>(whole);
    fraction[axis] = std::min(position - whole, kBelowOne);
  }
  if (beyond_cropped_side(voxel[0], voxel[1], voxel[2])) out.outside_map = true;
  const VoxmapView& map = voxmap_.view();
  if (!map.contains(voxel[0], voxel[1], voxel[2])) return;
  const auto value = value_of_code_[map.lookup(voxel[0], voxel[1], voxel[2]).code & 0xff];
  if (value == 0) return;

  const std::uint32_t at = out.count++;
  out.index[at] = point;
  out.value[at] = value;
  out.vx[at] = voxel[0], out.vy[at] = voxel[1], out.vz[at] = voxel[2];
  out.fx[at] = fraction[0], out.fy[at] = fraction[1], out.fz[at] = fraction[2];
  out.rx[at] = offset[0] * voxel_size_m_;
  out.ry[at] = offset[1] * voxel_size_m_;
  out.rz[at] = offset[2] * voxel_size_m_;
  out.nx[at] = dot(pose.rotation[0], shell.nx[point], shell.ny[point], shell.nz[point]);
  out.ny[at] = dot(pose.rotation[1], shell.nx[point], shell.ny[point], shell.nz[point]);
  out.nz[at] = dot(pose.rotation[2], shell.nx[point], shell.ny[point], shell.nz[point]);
  out.interior_count += value == 1;
  out.surface_count += value == 2;
  out.proximity_count += value == 3;
}

void ContactQuery::run(const Pose& world_from_center, CollectedPoints& out) noexcept {
  out.clear();
  const VoxelPose pose = voxel_pose(world_from_center);
  if (!pose.within_reach) {
    out.outside_map = sphere_beyond_cropped_side(world_from_center.position_m);
    return;
  }
  const auto points = static_cast<std::uint32_t>(shell_.view().point_count);
  for (std::uint32_t point = 0; point < points; ++point) collect_point(pose, point, out);
}

}  // namespace forcelayer
