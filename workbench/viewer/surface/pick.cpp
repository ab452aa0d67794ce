#include "workbench/viewer/surface/pick.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcelayer::viewer {
namespace {

// The stretch of a line at + t along that lies in a box, in voxels.
struct Stretch {
  double begin = 0, end = std::numeric_limits<double>::infinity();

  void keep(double at, double along, double low, double high) {
    if (along == 0) {
      if (at < low || at >= high) end = -1;
      return;
    }
    const double a = (low - at) / along, b = (high - at) / along;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
};

}  // namespace

std::optional<std::array<std::int64_t, 3>> interior_on(const Voxmap& voxmap, const Ray& ray,
                                                       const std::optional<Cut>& cut,
                                                       const HiddenObjects& hidden) {
  const ShownVoxels shown(voxmap, hidden);
  const VoxmapHeader& header = voxmap.header();
  const glm::dvec3 from = ray.from_m / header.voxel_size_m;
  std::array<std::int64_t, 3> low{}, high{};  // inclusive
  Stretch inside;
  for (int axis = 0; axis < 3; ++axis) {
    const auto d = static_cast<std::size_t>(axis);
    low[d] = header.origin_voxel[d];
    high[d] = low[d] + static_cast<std::int64_t>(header.dims_voxels[d]) - 1;
    if (cut && cut->axis == axis) {
      const double at = cut->at_m / header.voxel_size_m;
      if (cut->keep_low) high[d] = std::min(high[d], static_cast<std::int64_t>(std::ceil(at)) - 1);
      if (!cut->keep_low) low[d] = std::max(low[d], static_cast<std::int64_t>(std::floor(at)));
    }
    if (high[d] < low[d]) return std::nullopt;
    inside.keep(from[axis], ray.along[axis], static_cast<double>(low[d]),
                static_cast<double>(high[d] + 1));
  }
  if (!(inside.begin < inside.end)) return std::nullopt;
  // From voxel to voxel over the face that the ray meets first (Amanatides and Woo 1987).
  std::array<std::int64_t, 3> voxel{}, step{};
  std::array<double, 3> next{}, length{};  // along the ray: to the next face, from face to face
  for (int axis = 0; axis < 3; ++axis) {
    const auto d = static_cast<std::size_t>(axis);
    const double along = ray.along[axis], at = from[axis] + inside.begin * along;
    voxel[d] = std::clamp(static_cast<std::int64_t>(std::floor(at)), low[d], high[d]);
    step[d] = along > 0 ? 1 : along < 0 ? -1 : 0;
    const double face = static_cast<double>(voxel[d] + (along > 0));
    next[d] = along == 0 ? std::numeric_limits<double>::infinity() : (face - from[axis]) / along;
    length[d] = along == 0 ? 0 : std::abs(1 / along);
  }
  const auto& origin = voxmap.view().directory_origin;
  const auto is_interior = [&] {
    RelativeVoxel at{};
    for (std::size_t d = 0; d < 3; ++d) at[d] = static_cast<std::int32_t>(voxel[d] - origin[d]);
    return shown.value(at) == VoxelValue::kInterior;
  };
  while (!is_interior()) {
    const auto d =
        static_cast<std::size_t>(std::min_element(next.begin(), next.end()) - next.begin());
    voxel[d] += step[d];
    next[d] += length[d];
    if (voxel[d] < low[d] || voxel[d] > high[d]) return std::nullopt;
  }
  return voxel;
}

double entry_of(const Voxmap& voxmap, const Ray& ray, const std::array<std::int64_t, 3>& voxel) {
  Stretch inside;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = static_cast<double>(voxel[static_cast<std::size_t>(axis)]);
    inside.keep(ray.from_m[axis] / voxmap.voxel_size_m(), ray.along[axis] / voxmap.voxel_size_m(),
                low, low + 1);
  }
  return inside.begin;
}

std::string_view object_of(const Voxmap& voxmap, const std::array<std::int64_t, 3>& voxel) {
  return voxmap.object_name(voxmap.nearest_object(voxel[0], voxel[1], voxel[2]));
}

}  // namespace forcelayer::viewer
