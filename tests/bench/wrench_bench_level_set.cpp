#include "tests/bench/wrench_bench_level_set.h"

#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numeric>

namespace forcelayer::bench {
namespace {

glm::dvec3 slope(const float (&data)[2][2][2], const glm::dvec3& f) {
  glm::dvec3 sum(0);
  for (int n = 0; n < 8; ++n) {
    const int i = n >> 2, j = n >> 1 & 1, k = n & 1;
    const double x = i ? f.x : 1 - f.x, y = j ? f.y : 1 - f.y, z = k ? f.z : 1 - f.z;
    sum += double{data[i][j][k]} *
           glm::dvec3((i ? 1 : -1) * y * z, (j ? 1 : -1) * x * z, (k ? 1 : -1) * x * y);
  }
  return sum;
}

openvdb::FloatGrid::Ptr grid_of(const DenseDistances& box) {
  const float far_m = *std::max_element(box.distance_m.begin(), box.distance_m.end());
  auto grid = openvdb::FloatGrid::create(far_m);
  auto accessor = grid->getAccessor();
  const float* distance_m = box.distance_m.data();
  for (std::int32_t x = 0; x < box.dims[0]; ++x) {
    for (std::int32_t y = 0; y < box.dims[1]; ++y) {
      for (std::int32_t z = 0; z < box.dims[2]; ++z, ++distance_m) {
        if (*distance_m == far_m) continue;
        accessor.setValueOn(
            openvdb::Coord(static_cast<int>(box.low[0]) + x, static_cast<int>(box.low[1]) + y,
                           static_cast<int>(box.low[2]) + z),
            *distance_m);
      }
    }
  }
  return grid;
}

}  // namespace

LevelSetFrame::LevelSetFrame(const DenseDistances& distances, const AnalyticShell& shell,
                             double voxel_size_m, double offset_m)
    : distance_m_(grid_of(distances)),
      shell_(shell),
      s_(voxel_size_m),
      offset_m_(offset_m),
      mean_area_m2_(std::accumulate(shell.areas_m2.begin(), shell.areas_m2.end(), 0.0) /
                    static_cast<double>(shell.areas_m2.size())) {}

Wrench LevelSetFrame::at(const Pose& world_from_center) const {
  const auto accessor = distance_m_->getConstAccessor();
  const glm::dmat3 rotation = glm::mat3_cast(world_from_center.orientation);
  Wrench sum;
  for (std::size_t i = 0; i < shell_.points_m.size(); ++i) {
    const glm::dvec3 arm = rotation * shell_.points_m[i];
    const glm::dvec3 centered = (arm + world_from_center.position_m) / s_ - 0.5;
    const glm::dvec3 low = glm::floor(centered), f = centered - low;
    float data[2][2][2];
    openvdb::tools::BoxSampler::getValues(
        data, accessor,
        openvdb::Coord(static_cast<int>(low.x), static_cast<int>(low.y), static_cast<int>(low.z)));
    const double distance_m =
        openvdb::tools::BoxSampler::trilinearInterpolation(data, openvdb::Vec3R(f.x, f.y, f.z));
    if (!(distance_m < offset_m_)) continue;
    const glm::dvec3 force = shell_.areas_m2[i] / mean_area_m2_ * (offset_m_ - distance_m) *
                             glm::normalize(slope(data, f));
    sum.force_n += force;
    sum.torque_nm += glm::cross(arm, force);
  }
  return sum;
}

}  // namespace forcelayer::bench
