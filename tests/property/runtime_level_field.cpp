// The level field: bit for bit its scalar twin, which is its definition; pushes near the interior
// alone, with Euclidean layers from one height off every plane; continuous; never attracts a thin
// sheet or wire.
#include "runtime/field/level_field.h"

#include <gtest/gtest.h>

#include <hwy/targets.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>

#include "runtime/field/tangent_plane.h"
#include "tests/support/every_target.h"
#include "tests/support/random_scenes.h"
#include "tests/support/reference_level.h"

namespace forcelayer::test {
namespace {

std::array<float, 3> as_floats(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

constexpr std::array kMetrics{Metric::kChebyshev, Metric::kEuclidean};

// Boxes, planks and loose voxels, offset by k layers that are whole: the box has room for them. It
// lies across the edges of bricks, nodes and directory cells. The interior may be that of either
// metric: the field reads only the layers around it, which are 26-neighbors with both.
VoxelScene layered_scene(Random& random, std::int64_t k, Metric metric) {
  Voxel min{}, dims{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t edge = std::array<std::int64_t, 4>{0, 8, 64, 512}[random() % 4];
    min[axis] = edge * integer(random, -2, 2) - integer(random, 4, 20);
    dims[axis] = integer(random, 20, 34);
  }
  std::vector<std::array<Voxel, 2>> boxes(static_cast<std::size_t>(integer(random, 1, 5)));
  for (auto& box : boxes)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = integer(random, k + 3, dims[axis] - k - 4);
      const auto b = random() % 3 ? integer(random, k + 3, dims[axis] - k - 4) : a;
      box[0][axis] = min[axis] + std::min(a, b);
      box[1][axis] = min[axis] + std::max(a, b);
    }
  const std::uint64_t salt = random() % 8;
  VoxelScene scene = offset_scene(0.003, min, dims, k, [&](Voxel v) {
    return std::any_of(boxes.begin(), boxes.end(), [&](const auto& box) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (v[axis] < box[0][axis] || v[axis] > box[1][axis]) return false;
      const auto hash =
          static_cast<std::uint64_t>(v[0] * 73856093 ^ v[1] * 19349663 ^ v[2] * 83492791);
      return salt > 1 || hash % 7 <= salt;  // a quarter of the scenes are crumbs
    });
  });
  scene.metric = metric;
  return scene;
}

// A voxel in or just outside the scene's box, in its directory, and half the time not free.
Voxel random_voxel(Random& random, const VoxelScene& scene) {
  Voxel v{};
  const int tries = random() % 2 ? 1 : 20;
  for (int i = 0; i < tries; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t low = scene.min[axis], high = low + scene.dims[axis] - 1;
      v[axis] = std::clamp(integer(random, low - 3, high + 3), low & ~511, high | 511);
    }
    if (scene.at(v) != VoxelValue::kFree) break;
  }
  return v;
}

std::array<float, 3> random_fraction(Random& random) {
  std::array<float, 3> f{};
  for (float& x : f) {
    // Faces and centers of voxels too: that is where a mistake would show.
    x = random() % 8 == 0 ? 0.5f * static_cast<float>(random() % 2)
                          : static_cast<float>(integer(random, 0, (1 << 24) - 1)) * 0x1p-24f;
  }
  return f;
}

std::array<float, 3> direction_of(const field::FieldSamples& samples, std::uint32_t i) {
  return {samples.dx[i], samples.dy[i], samples.dz[i]};
}

// Random points of a scene, some told to be in value 3, and the twin's answers.
struct Probe {
  query::CollectedPoints points;
  std::vector<TwinPush> twins;

  Probe(Random& random, const VoxelScene& scene, const Voxmap& voxmap, std::uint32_t cropped,
        std::uint32_t count) {
    points.reserve(count);
    const std::uint64_t near_in_ten = random() % 10;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Voxel v = random_voxel(random, scene);
      const auto fraction = random_fraction(random);
      const auto normal = as_floats(random_direction(random));
      const bool near = random() % 10 < near_in_ten;
      collect(points, voxmap, v, near ? VoxelValue::kProximity : VoxelValue::kSurface, fraction,
              normal);
      twins.push_back(float_push(scene, v, fraction, normal, cropped));
    }
  }
};

// One field against the twin; how many points have depth.
std::uint32_t compare_with_twin(const field::LevelField& field, const Probe& probe) {
  field::FieldSamples samples;
  samples.reserve(probe.points.count);
  field.measure(probe.points, samples);
  std::uint32_t pushes = 0;
  for (std::uint32_t i = 0; i < probe.points.count; ++i) {
    const TwinPush& twin = probe.twins[i];
    EXPECT_EQ(samples.depth_m[i], twin.depth_m) << "point " << i;
    EXPECT_EQ(direction_of(samples, i), twin.direction) << "point " << i;
    EXPECT_EQ((std::array{samples.gx[i], samples.gy[i], samples.gz[i]}), twin.slope) << i;
    if (testing::Test::HasFailure()) break;
    pushes += twin.depth_m > 0;
  }
  return pushes;
}

// Every width of vectors that this machine has, one after the other.
class LevelFieldOnEveryTarget : public EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, LevelFieldOnEveryTarget,
                         testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

TEST_P(LevelFieldOnEveryTarget, EqualsItsScalarTwinBitForBit) {
  std::uint32_t pushes = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Metric metric = kMetrics[seed % 2];
    const VoxelScene scene = layered_scene(random, integer(random, 1, 3), metric);
    const auto cropped = static_cast<std::uint32_t>(random() % 2 ? random() % 64 : 0);
    const Voxmap voxmap = make_voxmap(scene, cropped);
    const field::LevelField field(voxmap);
    for (int frame = 0; frame < 3; ++frame) {  // the second finds its bricks decoded
      const auto count = static_cast<std::uint32_t>(integer(random, 0, 900));
      pushes += compare_with_twin(field, Probe(random, scene, voxmap, cropped, count));
      ASSERT_FALSE(HasFailure());
    }
  }
  EXPECT_GT(pushes, 1000u);
}

TEST_P(LevelFieldOnEveryTarget, HoldsWhereBricksReplaceEachOther) {
  // Noise, so that no brick equals another; enough bricks that some share a slot.
  Random random(7);
  const VoxelScene scene = VoxelScene::filled(0.003, {-64, 0, 100}, {400, 400, 12},
                                              [&](Voxel) { return VoxelValue(random() % 4); });
  std::map<std::uint32_t, int> slots_used;
  const Voxmap voxmap = make_voxmap(scene);
  const auto& origin = voxmap.header().directory_origin;
  const auto strides = field::LevelBricks(voxmap).strides();
  for (std::int64_t i = 0; i < 50; ++i)
    for (std::int64_t j = 0; j < 50; ++j) {
      const auto bx = static_cast<std::uint32_t>((scene.min[0] - origin[0]) / 8 + i);
      const auto by = static_cast<std::uint32_t>((scene.min[1] - origin[1]) / 8 + j);
      const auto bz = static_cast<std::uint32_t>((scene.min[2] - origin[2]) / 8);
      ++slots_used[field::LevelBricks::slot(bx * strides[0] + by * strides[1] + bz)];
    }
  ASSERT_LT(slots_used.size(), 2450u) << "2500 bricks, and none shares a slot";
  const field::LevelField field(voxmap);
  EXPECT_GT(compare_with_twin(field, Probe(random, scene, voxmap, 0, 5000)), 0u);
}

TEST(LevelField, TwinIsTheWeightedSumOverTwentySevenVoxels) {
  Random random(5);
  const VoxelScene scene = layered_scene(random, 2, Metric::kChebyshev);
  for (int i = 0; i < 20000; ++i) {
    const Voxel v = random_voxel(random, scene);
    const auto fraction = random_fraction(random);
    const ExactLevels exact = exact_levels(scene, v, fraction);
    // Shares along x and y lose up to 2^-15 each, at one per voxel; two interpolations are rounded
    // to 2^-13, half of which they may be off; what single precision adds is a hundredth of that.
    EXPECT_NEAR(float_push(scene, v, fraction, {0, 0, 1}).phi, exact.phi, 0x1p-14 + 0x1p-13 + 2e-6);
  }
}

// With Chebyshev layers only points in values 1 and 2, with Euclidean ones none in free voxels; and
// all in interior ones: even at their corners something is left of the depth.
TEST(LevelField, PushesNoPointsButThoseNearTheInterior) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Metric metric = kMetrics[seed % 2];
    const VoxelScene scene = layered_scene(random, integer(random, 1, 3), metric);
    const Voxmap voxmap = make_voxmap(scene);
    const field::LevelField field(voxmap);
    constexpr std::uint32_t kCount = 20000;
    query::CollectedPoints points;
    points.reserve(kCount);
    std::vector<VoxelValue> values;
    std::vector<double> steepness;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const Voxel v = random_voxel(random, scene);
      const auto fraction = random_fraction(random);
      values.push_back(scene.at(v));
      steepness.push_back(glm::length(exact_levels(scene, v, fraction).slope));
      // Told that every point is in value 2, the field has only phi to go by.
      collect(points, voxmap, v, VoxelValue::kSurface, fraction,
              as_floats(random_direction(random)));
    }
    field::FieldSamples samples;
    samples.reserve(kCount);
    field.measure(points, samples);
    std::uint32_t pushed = 0, interior = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      // A slope this long leaves a push its whole strength.
      if (values[i] == VoxelValue::kInterior && steepness[i] > 0.2) {
        ++interior;
        ASSERT_GT(samples.depth_m[i], 0.12 * scene.voxel_size_m);
        if (metric == Metric::kEuclidean) {
          ASSERT_GT(samples.depth_m[i], 0.216 * scene.voxel_size_m);
        }
      }
      if (!(samples.depth_m[i] > 0)) continue;
      ++pushed;
      ASSERT_NE(values[i], VoxelValue::kFree);
      if (values[i] == VoxelValue::kProximity) {
        ASSERT_EQ(metric, Metric::kEuclidean);
      }
      ASSERT_NEAR(std::hypot(samples.dx[i], samples.dy[i], samples.dz[i]), 1, 1e-6);
      ASSERT_LE(samples.depth_m[i], 1.7321 * scene.voxel_size_m);
    }
    EXPECT_GT(pushed, 0u);
    EXPECT_GT(interior, 0u);
  }
}

TEST(LevelField, PushIsContinuousAcrossVoxels) {
  // Per voxel of motion phi changes by at most sqrt(3), the slope by 6 (Frobenius norm of its
  // derivatives) and w by 1.5 * 16 * 4 * 6; a direction by that over |u| >= 0.1, below which the
  // push fades: in all below 10^4. A jump, be it a hundredth of a voxel, would be far above that
  // times a step of 10^-7 voxels.
  constexpr double kStep = 1e-7, kBound = 1e4 * kStep + 1e-4;  // the latter for single precision
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const VoxelScene scene = layered_scene(random, integer(random, 1, 3), kMetrics[seed % 2]);
    for (int i = 0; i < 5000; ++i) {
      const Voxel v = random_voxel(random, scene);
      const auto normal = as_floats(random_direction(random));
      auto here = random_fraction(random), there = here;
      Voxel next = v;
      const auto axis = static_cast<std::size_t>(random() % 3);
      if (random() % 2) {  // across a face
        here[axis] = 1 - 0x1p-24f;
        there[axis] = 0;
        ++next[axis];
      } else {
        there[axis] = std::min(here[axis] + static_cast<float>(kStep), 1 - 0x1p-24f);
      }
      const TwinPush a = float_push(scene, v, here, normal);
      const TwinPush b = float_push(scene, next, there, normal);
      for (std::size_t d = 0; d < 3; ++d) {
        ASSERT_NEAR(std::max(a.depth_m, 0.0f) * a.direction[d] / scene.voxel_size_m,
                    std::max(b.depth_m, 0.0f) * b.direction[d] / scene.voxel_size_m, kBound)
            << "voxel " << v[0] << " " << v[1] << " " << v[2] << " fraction " << here[0] << " "
            << here[1] << " " << here[2] << " axis " << axis;
      }
    }
  }
}

// A half-space below the plane n . x = 0 through the origin, with whole layers in the box.
VoxelScene half_space(const glm::dvec3& n, std::int64_t k) {
  const double reach = 0.5 * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  return offset_scene(0.01, {-14, -14, -14}, {28, 28, 28}, k, [&](Voxel v) {
    const glm::dvec3 c(static_cast<double>(v[0]) + 0.5, static_cast<double>(v[1]) + 0.5,
                       static_cast<double>(v[2]) + 0.5);
    return glm::dot(n, c) <= reach;
  });
}

// The interior of Euclidean layers ends at the same distance from a plane whatever its orientation,
// and so does the push begin: sqrt(3)/2 voxels before that.
TEST(LevelField, EuclideanLayersPushFromOneHeightOffEveryPlane) {
  Random random(11);
  std::vector<glm::dvec3> normals{{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {2, 1, 0}};
  while (normals.size() < 12) normals.push_back(random_direction(random));
  for (const glm::dvec3& direction : normals) {
    const glm::dvec3 n = glm::normalize(direction);
    double error_sum = 0;
    int points = 0;
    for (int scene_number = 0; scene_number < 16; ++scene_number) {
      const double end = (scene_number + 0.5) / 8 - 1;  // evenly over the lattice's period
      VoxelScene scene = offset_scene(0.01, {-10, -10, -10}, {20, 20, 20}, 1, [&](Voxel v) {
        const glm::dvec3 c(static_cast<double>(v[0]) + 0.5, static_cast<double>(v[1]) + 0.5,
                           static_cast<double>(v[2]) + 0.5);
        return glm::dot(n, c) <= end;
      });
      scene.metric = Metric::kEuclidean;
      for (int i = 0; i < 200; ++i) {
        const double height = uniform(random, 0.2, std::sqrt(3.0) / 2);  // above the interior's end
        glm::dvec3 p(uniform(random, -4, 4), uniform(random, -4, 4), uniform(random, -4, 4));
        p += (end + height - glm::dot(n, p)) * n;
        const glm::dvec3 whole = glm::floor(p);
        const Voxel v{static_cast<std::int64_t>(whole.x), static_cast<std::int64_t>(whole.y),
                      static_cast<std::int64_t>(whole.z)};
        const TwinPush push = float_push(scene, v, as_floats(p - whole), as_floats(n));
        error_sum += push.depth_m / scene.voxel_size_m - (std::sqrt(3.0) / 2 - height);
        ++points;
      }
    }
    // 0.016 along a space diagonal, where the layers' steps are least smoothed; without the earlier
    // beginning it would be 0.37 along the grid.
    EXPECT_NEAR(error_sum / points, 0, 0.02) << n.x << " " << n.y << " " << n.z;
  }
}

struct Surface {
  std::vector<glm::dvec3> points, normals;  // voxels; inward
};

// Both sides of a square sheet.
Surface sheet(double edge, double thickness) {
  Surface s;
  for (double x = -edge / 2; x <= edge / 2; x += 0.4)
    for (double y = -edge / 2; y <= edge / 2; y += 0.4)
      for (const double side : {-0.5, 0.5}) {
        s.points.emplace_back(x, y, side * thickness);
        s.normals.emplace_back(0, 0, side > 0 ? -1 : 1);
      }
  return s;
}

Surface wire(double length, double thickness) {
  Surface s;
  for (double z = -length / 2; z <= length / 2; z += 0.3)
    for (int i = 0; i < 6; ++i) {
      const double a = M_PI / 3 * i;
      s.points.emplace_back(thickness / 2 * std::cos(a), thickness / 2 * std::sin(a), z);
      s.normals.emplace_back(-std::cos(a), -std::sin(a), 0);
    }
  return s;
}

// Sum over the surface of depth * direction, in voxels.
glm::dvec3 total_push(const field::ForceField& field, const Voxmap& voxmap, const VoxelScene& scene,
                      const Surface& surface, const glm::dquat& turn, const glm::dvec3& place) {
  query::CollectedPoints points;
  points.reserve(surface.points.size());
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const glm::dvec3 p = turn * surface.points[i] + place;
    const glm::dvec3 whole = glm::floor(p);
    const Voxel v{static_cast<std::int64_t>(whole.x), static_cast<std::int64_t>(whole.y),
                  static_cast<std::int64_t>(whole.z)};
    if (scene.at(v) == VoxelValue::kFree) continue;
    collect(points, voxmap, v, scene.at(v), as_floats(p - whole),
            as_floats(turn * surface.normals[i]));
  }
  field::FieldSamples samples;
  samples.reserve(points.count);
  field.measure(points, samples);
  glm::dvec3 sum(0);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (!(samples.depth_m[i] > 0)) continue;
    sum += double{samples.depth_m[i]} * glm::dvec3(samples.dx[i], samples.dy[i], samples.dz[i]);
  }
  return sum / scene.voxel_size_m;
}

TEST(LevelField, NeverAttractsASheetOrAWireThinnerThanAVoxel) {
  double worst = 0, worst_tangent_plane = 0;
  int pushed = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const glm::dvec3 n = random_direction(random);
    const auto k = integer(random, 1, 3);
    const VoxelScene scene = half_space(n, k);
    const Voxmap voxmap = make_voxmap(scene);
    const field::LevelField level(voxmap);
    const field::TangentPlaneField tangent_plane(voxmap.voxel_size_m());
    const double slant = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    for (int i = 0; i < 60; ++i) {
      const double thickness = uniform(random, 0, 1);
      const Surface part = random() % 2 ? sheet(4, thickness) : wire(4, thickness);
      // Parallel to the wall, or any way round; from before the force layer to buried.
      glm::dquat turn = random_orientation(random);
      if (random() % 2) {
        const glm::dvec3 axis = glm::cross(glm::dvec3(0, 0, 1), n);
        turn = glm::angleAxis(std::atan2(glm::length(axis), n.z),
                              glm::normalize(axis + glm::dvec3(1e-12, 0, 0)));
      }
      const double depth = uniform(random, -1, 2.5) * slant;
      const glm::dvec3 place = n * (static_cast<double>(k) * slant + 0.5 * slant - depth) +
                               random_direction(random) * uniform(random, 0, 0.7);
      const double along = glm::dot(n, total_push(level, voxmap, scene, part, turn, place));
      pushed += along > 0.1;
      worst = std::min(worst, along);
      worst_tangent_plane =
          std::min(worst_tangent_plane,
                   glm::dot(n, total_push(tangent_plane, voxmap, scene, part, turn, place)));
      // Single precision: a few hundred terms of at most sqrt(3), relative error below 1e-6.
      ASSERT_GE(along, -1e-3) << "seed " << seed << " pose " << i << " thickness " << thickness
                              << " depth " << depth << " k " << k;
    }
  }
  EXPECT_GT(pushed, 500);
  EXPECT_LT(worst_tangent_plane, -0.1) << "the test has lost its teeth";
}

}  // namespace
}  // namespace forcelayer::test
