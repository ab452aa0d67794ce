// The benchmarks' dense distance field (Barbic and James) gives what plain trilinear interpolation
// in double precision does, with vectors of every width.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "tests/bench/wrench_bench_dense.h"
#include "tests/support/every_target.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::bench {
namespace {

constexpr double kVoxelM = 0.005, kOffsetM = 0.012;

class DensePeer : public test::EveryTarget {
 protected:
  DensePeer() {
    box_.low = {-3, 500, 7};  // beside a border of the map's 512-voxel cells
    box_.dims = {9, 14, 11};
    std::uniform_real_distribution<float> distance_m(-0.01f, 0.03f);
    for (int i = 0; i < 9 * 14 * 11; ++i) box_.distance_m.push_back(distance_m(random_));
  }

  // A point at `voxel`, world lattice, and a fraction of it.
  void add(const test::Voxel& voxel, const glm::dvec3& fraction) {
    const auto& origin = voxmap_.header().directory_origin;
    const std::uint32_t i = points_.count++;
    points_.vx[i] = static_cast<std::int32_t>(voxel[0] - origin[0]);
    points_.vy[i] = static_cast<std::int32_t>(voxel[1] - origin[1]);
    points_.vz[i] = static_cast<std::int32_t>(voxel[2] - origin[2]);
    points_.fx[i] = static_cast<float>(fraction.x);
    points_.fy[i] = static_cast<float>(fraction.y);
    points_.fz[i] = static_cast<float>(fraction.z);
  }

  // The slow twin: eight corners, one by one. The distance, m, and its gradient, m a voxel; false
  // outside the box.
  bool read(const test::Voxel& voxel, const glm::dvec3& fraction, double& distance_m,
            glm::dvec3& slope) const {
    distance_m = 0, slope = glm::dvec3(0);
    std::array<std::int64_t, 3> first{};
    glm::dvec3 between;
    for (int d = 0; d < 3; ++d) {
      const auto i = static_cast<std::size_t>(d);
      const double at = static_cast<double>(voxel[i]) + fraction[d] - 0.5;
      first[i] = static_cast<std::int64_t>(std::floor(at));
      between[d] = at - std::floor(at);
      if (first[i] < box_.low[i] || first[i] + 1 >= box_.low[i] + box_.dims[i]) return false;
    }
    for (int n = 0; n < 8; ++n) {
      const int at[3] = {n >> 2, n >> 1 & 1, n & 1};
      glm::dvec3 weight, sign;
      for (int d = 0; d < 3; ++d) {
        weight[d] = at[d] == 1 ? between[d] : 1 - between[d], sign[d] = at[d] == 1 ? 1 : -1;
      }
      const double value = double{
          box_.distance_m[box_.index({first[0] + at[0], first[1] + at[1], first[2] + at[2]})]};
      distance_m += value * weight.x * weight.y * weight.z;
      slope += value * glm::dvec3(sign.x * weight.y * weight.z, weight.x * sign.y * weight.z,
                                  weight.x * weight.y * sign.z);
    }
    return true;
  }

  std::mt19937_64 random_{20260101};
  DenseDistances box_;
  Voxmap voxmap_ = test::make_voxmap(test::VoxelScene::filled(
      kVoxelM, {-8, 490, 0}, {20, 30, 30}, [](test::Voxel) { return VoxelValue::kSurface; }));
  query::CollectedPoints points_;
  field::FieldSamples samples_;
};

TEST_P(DensePeer, IsPlainTrilinearInterpolation) {
  constexpr int kPoints = 4001;  // no whole number of vectors
  points_.reserve(kPoints), samples_.reserve(kPoints);
  std::vector<std::pair<test::Voxel, glm::dvec3>> places;
  for (int i = 0; i < kPoints; ++i) {
    test::Voxel voxel{};
    glm::dvec3 fraction;
    for (int d = 0; d < 3; ++d) {  // a voxel beyond the box too
      const auto n = static_cast<std::size_t>(d);
      voxel[n] = std::uniform_int_distribution<std::int64_t>(box_.low[n] - 1,
                                                             box_.low[n] + box_.dims[n])(random_);
      fraction[d] = std::uniform_int_distribution<int>(0, 1023)(random_) / 1024.0;
    }
    places.emplace_back(voxel, fraction);
    add(voxel, fraction);
  }
  const DenseField field(voxmap_, box_, kOffsetM);
  field.measure(points_, samples_);
  int inside = 0;
  for (int i = 0; i < kPoints; ++i) {
    const auto n = static_cast<std::size_t>(i);
    double distance_m = 0;
    glm::dvec3 slope;
    if (!read(places[n].first, places[n].second, distance_m, slope)) {
      EXPECT_LT(samples_.depth_m[n], 0) << i;
      continue;
    }
    ++inside;
    EXPECT_NEAR(double{samples_.depth_m[n]}, kOffsetM - distance_m, 1e-8) << i;
    const glm::dvec3 along = glm::normalize(slope);
    // Single precision: a slope that nearly cancels is known less well.
    const double tolerance = 1e-7 * (1 + 0.04 / glm::length(slope));
    EXPECT_NEAR(double{samples_.dx[n]}, along.x, tolerance) << i;
    EXPECT_NEAR(double{samples_.dy[n]}, along.y, tolerance) << i;
    EXPECT_NEAR(double{samples_.dz[n]}, along.z, tolerance) << i;
    EXPECT_NEAR(double{samples_.gx[n]}, slope.x / kVoxelM, 1e-5) << i;
  }
  EXPECT_GT(inside, kPoints / 3);
  EXPECT_LT(inside, kPoints);
}

INSTANTIATE_TEST_SUITE_P(Vectors, DensePeer,
                         ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

}  // namespace
}  // namespace forcelayer::bench
