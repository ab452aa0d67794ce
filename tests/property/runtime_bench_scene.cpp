// The benchmarks' analytic scenes have their layers where the body is near, at the borders of their
// box too.
#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>

#include "tests/bench/wrench_bench_scene.h"

namespace forcelayer::bench {
namespace {

TEST(BenchScene, LayersLieNearTheBody) {
  constexpr double kVoxelM = 0.005;
  constexpr int kLayers = 2;
  AnalyticStatic body;
  body.kind = StaticKind::kPlane;
  body.rotation = glm::mat3_cast(glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3))));
  for (const VoxelKind kind : {VoxelKind::kChebyshev, VoxelKind::kLean, VoxelKind::kFull}) {
    const test::VoxelScene scene =
        bake(kind, body, kVoxelM, kLayers, glm::dvec3(-0.1), glm::dvec3(0.1));
    int layer = 0;
    for (std::int64_t x = 0; x < scene.dims[0]; ++x) {
      for (std::int64_t y = 0; y < scene.dims[1]; ++y) {
        for (std::int64_t z = 0; z < scene.dims[2]; ++z) {
          const test::Voxel v{scene.min[0] + x, scene.min[1] + y, scene.min[2] + z};
          const VoxelValue value = scene.at(v);
          if (value == VoxelValue::kFree || value == VoxelValue::kInterior) continue;
          ++layer;
          const glm::dvec3 center = (glm::dvec3(v[0], v[1], v[2]) + 0.5) * kVoxelM;
          // The diagonal of the outermost layer's voxels from the surface.
          EXPECT_LT(body.distance_m(center), (kLayers + 1.5) * std::sqrt(3.0) * kVoxelM);
        }
      }
    }
    EXPECT_GT(layer, 1000);
  }
}

}  // namespace
}  // namespace forcelayer::bench
