#include "tests/bench/wrench_bench_level_set.h"

#include <openvdb/tools/Interpolation.h>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

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

}  // namespace

LevelSetFrame::LevelSetFrame(openvdb::FloatGrid::Ptr distance_m, const AnalyticShell& shell,
                             double voxel_size_m, double offset_m)
    : distance_m_(std::move(distance_m)), shell_(shell), s_(voxel_size_m), offset_m_(offset_m) {}

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
    const glm::dvec3 force =
        shell_.areas_m2[i] * (offset_m_ - distance_m) * glm::normalize(slope(data, f));
    sum.force_n += force;
    sum.torque_nm += glm::cross(arm, force);
  }
  return sum;
}

}  // namespace forcelayer::bench
