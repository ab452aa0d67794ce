// The guard of a pose against exact distances, on both sides of its thresholds.
//
// A proven distance is below the exact one by the rounding of codes and between centers, so a test
// at random places would not see a threshold that is a micrometer too low. Here the points are at
// the centers of voxels in front of a plane, at a distance that is a whole number of codes: there
// the proven distance is the exact one, less some 1e-7 m. The maps have a standoff: there the
// distance decides alone.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "runtime/guard/pose_guard.h"
#include "tests/support/distance_scene.h"
#include "tests/support/point_part.h"
#include "tests/support/random_numbers.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;
constexpr double kMicrometer = 1e-6;

// A floor, in whose map the centers of a layer of voxels have a distance of exactly kCodes codes.
struct Floor {
  static constexpr int kCodes = 60;
  // By the definition: two layers, less a fifth of a voxel.
  static constexpr double kGuardM = (1 + 888.0 / 1024 - 0.2) * kS;
  static constexpr double kCenterM = 2.5 * kS;  // their height
  static constexpr double kBelowCode = 1e-12;   // voxels: what rounds down to the code, surely

  // `distance_m`: of these centers from the floor. `guard_m`: the guard's distance in the header.
  explicit Floor(double distance_m, double guard_m = kGuardM) {
    DistanceDefinition definition(2, 253 * distance_m / kS / kCodes - 3);
    VoxelScene scene = distance_scene(
        kS, {-12, -12, -8}, {24, 24, 24},
        [&](const glm::dvec3& p) { return p.z - kCenterM + distance_m + kBelowCode * kS; }, 0,
        definition);
    scene.force_depth_voxels += (kGuardM - guard_m) / kS;
    map = std::make_unique<Voxmap>(make_voxmap(scene));
  }
  std::unique_ptr<Voxmap> map;
};

// A part of points before a floor, its guard, and what that finds.
struct Guarded {
  Guarded(const Voxmap& map, const PointPart& part)
      : shell(make_pshell(part)),
        field(field::make_force_field(Model::kDefault, ForceKind::kDistance, map).value()),
        query(map, shell) {
    points.reserve(shell.view().point_count);
    samples.reserve(shell.view().point_count);
    contacts.reserve(shell.view().point_count);
    guard = std::make_unique<guard::PoseGuard>(query, *field, points, samples);
  }
  // Whether the guard bars the i-th point with the part at a pose.
  bool bars(const Pose& pose, std::uint32_t i = 0) {
    guard->query_pose(pose, contacts);
    for (std::uint32_t n = 0; n < contacts.count; ++n) {
      if (contacts.point[n] == i) return contacts.is_barred[n] != 0;
    }
    return false;
  }
  Pshell shell;
  std::unique_ptr<field::ForceField> field;
  query::ContactQuery query;
  query::CollectedPoints points;
  field::FieldSamples samples;
  field::ContactSet contacts;
  std::unique_ptr<guard::PoseGuard> guard;
};

PointPart one_point() {
  PointPart part;
  part.add({0, 0, 0}, {0, 0, 1});
  part.add({0, 0, 0.02}, {0, 0, 1});  // far away
  return part;
}

// At the center of a voxel of the layer.
Pose at_center() { return {{0.5 * kS, 0.5 * kS, Floor::kCenterM}, {1, 0, 0, 0}}; }

TEST(GuardDistance, BarsAPointThatIsNearerByAMicrometer) {
  const double quantum_m = Floor::kGuardM / Floor::kCodes;
  for (const double step_m : {kMicrometer, quantum_m}) {
    SCOPED_TRACE(testing::Message() << "a step of " << step_m << " m");
    const Floor nearer(Floor::kGuardM - step_m), farther(Floor::kGuardM + step_m);
    EXPECT_TRUE(Guarded(*nearer.map, one_point()).bars(at_center()))
        << "unsafe: the point is nearer than the guard's distance";
    EXPECT_FALSE(Guarded(*farther.map, one_point()).bars(at_center()))
        << "over-cautious: the point keeps the guard's distance";
  }
}

// The same scene with the guard's distance on both sides of what is proven of the point.
TEST(GuardDistance, BarsAPointThatIsNearerByOneUnitInTheLastPlace) {
  const Floor floor(Floor::kGuardM);
  Guarded guarded(*floor.map, one_point());
  guarded.bars(at_center());
  const double proven_m = double{guarded.samples.distance_m[0]};
  ASSERT_NEAR(proven_m, Floor::kGuardM, 0.5 * kMicrometer);
  ASSERT_LE(proven_m, Floor::kGuardM);
  constexpr double kLess = 1e-13;  // m: less than a float's step, more than a double's
  for (const double beyond_m : {-kLess, kLess}) {
    const Floor same(Floor::kGuardM, proven_m + beyond_m);
    Guarded there(*same.map, one_point());
    const bool barred = there.bars(at_center());
    ASSERT_EQ(double{there.samples.distance_m[0]}, proven_m);
    EXPECT_EQ(barred, beyond_m > 0)
        << (beyond_m > 0 ? "unsafe: less than the guard's distance is proven"
                         : "over-cautious: the guard's distance is proven");
  }
}

// Wherever the point stands among those collected.
TEST(GuardDistance, SkipsNoPoint) {
  const Floor floor(Floor::kGuardM - kMicrometer);
  for (const std::uint32_t count : {1u, 2u, 17u, 64u, 67u}) {
    for (std::uint32_t near = 0; near < count; ++near) {
      PointPart part;
      for (std::uint32_t i = 0; i < count; ++i) {
        part.add({kS * (i % 7 - 3.0), kS * (i / 7 % 9 - 4.0), i == near ? 0 : kS}, {0, 0, 1});
      }
      Guarded guarded(*floor.map, part);
      guarded.bars(at_center());
      ASSERT_EQ(guarded.contacts.count, count);
      ASSERT_EQ(guarded.contacts.barred, 1u)
          << "unsafe: point " << near << " of " << count << " is skipped";
      ASSERT_TRUE(guarded.bars(at_center(), near));
    }
  }
}

// Spheres and boxes by their formulas: no point that is accepted is nearer than the guard's
// distance.
TEST(GuardDistance, NoAcceptedPointIsNearer) {
  int accepted = 0, barred = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const glm::dvec3 at = kS * glm::dvec3(uniform(random, 0, 1), uniform(random, 0, 1), 0.3);
    const double radius_m = uniform(random, 0, 5) * kS;
    const bool is_box = seed % 2 == 0;
    const auto exact_m = [&](const glm::dvec3& p) {
      if (!is_box) return glm::length(p - at) - radius_m;
      return glm::length(glm::max(glm::abs(p - at) - glm::dvec3(radius_m), glm::dvec3(0)));
    };
    const Voxmap map = make_voxmap(
        distance_scene(kS, {-12, -12, -12}, {24, 24, 24}, exact_m, 0, DistanceDefinition(2)));
    Guarded guarded(map, one_point());
    for (int i = 0; i < 3000; ++i) {
      const double reach_m = (is_box ? 1.7 : 1.0) * radius_m + uniform(random, 1, 3) * kS;
      const Pose pose{at + reach_m * random_direction(random), {1, 0, 0, 0}};
      if (guarded.bars(pose)) {
        ++barred;
        continue;
      }
      ++accepted;
      ASSERT_GE(exact_m(pose.position_m) + guarded.query.rounding_bound_m(), Floor::kGuardM)
          << "unsafe: pose " << i;
    }
  }
  EXPECT_GT(accepted, 5000);
  EXPECT_GT(barred, 5000);
}

// In a seat: as deep as the floor that the seat's own depth gives, and not a float's step deeper.
TEST(GuardDistance, ASeatedPointIsBarredBelowTheSeatsFloor) {
  for (const double depth_m : {0.0, 0.1 * kS, 0.3 * kS}) {
    SCOPED_TRACE(testing::Message() << "a seat " << depth_m << " m deep");
    const Voxmap map = make_voxmap(distance_scene(
        kS, {-12, -12, -8}, {24, 24, 24}, [](const glm::dvec3& p) { return p.z; }, 2,
        DistanceDefinition(2)));
    Guarded guarded(map, one_point());
    ASSERT_TRUE(guarded.guard->find_seat({{0.001, 0.002, -depth_m}, {1, 0, 0, 0}}));
    ASSERT_FALSE(guarded.guard->seat().empty());
    const auto zero_force_m = static_cast<float>(map.header().zero_force_m);
    const auto s = static_cast<float>(kS),
               step_m = static_cast<float>(map.header().distance_quantum_m);
    const float in_seat_m = std::min(0.0f, zero_force_m + guarded.samples.from_zero_force_m[0]);
    // By the definition: a quarter of a voxel, or 0.05 voxels below the seat, and a code's step.
    const float floor_m = std::min(in_seat_m - 0.05f * s, -0.25f * s) - step_m;
    guarded.guard->open_seat(true);
    // The heights on both sides of where the guard begins to bar, down to the last bit.
    double barred_m = -1.2 * kS, free_m = -depth_m;
    const auto at_height = [](double z) { return Pose{{0.001, 0.002, z}, {1, 0, 0, 0}}; };
    ASSERT_TRUE(guarded.bars(at_height(barred_m)));
    ASSERT_FALSE(guarded.bars(at_height(free_m)));
    while (true) {
      const double middle_m = (barred_m + free_m) / 2;
      if (!(middle_m > barred_m && middle_m < free_m)) break;
      (guarded.bars(at_height(middle_m)) ? barred_m : free_m) = middle_m;
    }
    for (const double z : {barred_m, free_m}) {
      const bool barred = guarded.bars(at_height(z));
      const float distance_m = zero_force_m + guarded.samples.from_zero_force_m[0];
      EXPECT_EQ(barred, distance_m < floor_m)
          << (barred ? "over-cautious: " : "unsafe: ") << distance_m << " m, the floor at "
          << floor_m << " m";
      EXPECT_EQ(guarded.guard->is_pushed_into_seat(at_height(z), {}), barred);
    }
    EXPECT_LT(free_m - barred_m, 1e-9);
  }
}

}  // namespace
}  // namespace forcelayer::test
