// The guard's threshold, comparison and decision, on both sides of each boundary.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "runtime/guard/point_rule.h"
#include "tests/support/random_numbers.h"

namespace forcelayer::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kMicrometer = 1e-6;

// Euclidean layers with stored distances; of `layers` 0, a standoff.
VoxmapHeader scene(std::uint32_t layers, double voxel_size_m, double zero_force_voxels) {
  VoxmapHeader header{};
  header.voxel_size_m = voxel_size_m;
  header.offset_layers = layers;
  header.metric = static_cast<std::uint32_t>(Metric::kEuclidean);
  header.zero_force_m = zero_force_voxels * voxel_size_m;
  header.force_depth_m = (layers == 0 ? 0.1 : 1) * voxel_size_m;
  header.distance_quantum_m = 0.03 * voxel_size_m;
  header.distance_zero_code = 90;
  return header;
}

// By the definition: a fifth of a voxel behind the force layer.
double guard_m(const VoxmapHeader& h) {
  return h.zero_force_m - h.force_depth_m - 0.2 * h.voxel_size_m;
}

std::vector<VoxmapHeader> scenes() {
  std::vector<VoxmapHeader> all;
  Random random(41);
  for (int i = 0; i < 200; ++i) {
    const double s = std::exp(uniform(random, std::log(1e-5), std::log(0.3)));
    all.push_back(scene(static_cast<std::uint32_t>(i % 3), s, uniform(random, 1.5, 6)));
  }
  return all;
}

TEST(GuardRule, BarsAPointThatIsNearerByTheSmallestStep) {
  for (const VoxmapHeader& header : scenes()) {
    const double g = guard_m(header);
    const guard::PointRule rule(header, true);
    SCOPED_TRACE(testing::Message() << "guard's distance " << g << " m");
    // The floats on both sides of the exact distance.
    auto above = static_cast<float>(g);
    if (double{above} < g) above = std::nextafter(above, kInfinity);
    const float below = std::nextafter(above, 0.0f);
    ASSERT_LT(double{below}, g);
    EXPECT_TRUE(rule.is_too_near(below)) << "unsafe: nearer by one unit in the last place";
    EXPECT_FALSE(rule.is_too_near(above)) << "over-cautious: the distance is kept";
    if (header.voxel_size_m < 1e-4) continue;  // a micrometer is a small step in larger scenes
    EXPECT_TRUE(rule.is_too_near(static_cast<float>(g - kMicrometer)))
        << "unsafe: nearer by a micrometer";
    EXPECT_FALSE(rule.is_too_near(static_cast<float>(g + kMicrometer)))
        << "over-cautious: farther by a micrometer";
  }
}

TEST(GuardRule, BarsWhatProvesNothing) {
  const guard::PointRule rule(scene(2, 0.005, 2.87), true);
  EXPECT_TRUE(rule.is_too_near(0)) << "unsafe";
  EXPECT_TRUE(rule.is_too_near(-1)) << "unsafe";
  EXPECT_TRUE(rule.is_too_near(std::numeric_limits<float>::quiet_NaN())) << "unsafe";
}

// No clearance is reported above the proven one where every point is in a free voxel.
TEST(GuardRule, RoundsTheDistanceOfFreeVoxelsDown) {
  for (const VoxmapHeader& header : scenes()) {
    field::ContactSet none;
    guard::PointRule(header, true).mark_points(nullptr, none);
    EXPECT_LE(double{none.min_distance_m}, free_distance_m(header)) << "unsafe";
    EXPECT_GE(double{std::nextafter(none.min_distance_m, kInfinity)}, free_distance_m(header));
    EXPECT_EQ(none.nearest, field::ContactSet::kNone);
  }
}

// One point of each set is in the interior or too near, wherever it stands in the set.
TEST(GuardRule, SkipsNoPoint) {
  for (const std::uint32_t layers : {0u, 2u}) {
    const VoxmapHeader header = scene(layers, 0.005, 2.87);
    const guard::PointRule rule(header, true), by_values(header, false);
    const auto near = static_cast<float>(guard_m(header) - 1e-9), far = 1.0f;
    for (std::uint32_t count = 1; count <= 67; ++count) {
      field::ContactSet set;
      set.reserve(count);
      set.count = count;
      for (std::uint32_t bad = 0; bad < count; ++bad) {
        std::vector<float> proven_m(count, far);
        std::fill_n(set.value.begin(), count, std::uint8_t{2});
        proven_m[bad] = near;
        rule.mark_points(proven_m.data(), set);
        ASSERT_EQ(set.barred, 1u) << "unsafe: point " << bad << " of " << count << " is skipped";
        for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(set.is_barred[i] != 0, i == bad);
        ASSERT_EQ(set.nearest, bad);
        ASSERT_EQ(set.min_distance_m, near);
        // In the interior: in a map with a standoff the distance decides alone.
        proven_m[bad] = far;
        set.value[bad] = 1;
        rule.mark_points(proven_m.data(), set);
        ASSERT_EQ(set.barred, layers == 0 ? 0u : 1u) << "point " << bad << " of " << count;
        by_values.mark_points(nullptr, set);
        ASSERT_EQ(set.barred, 1u) << "unsafe: point " << bad << " of " << count << " is skipped";
        ASSERT_EQ(set.min_distance_m, 0);
      }
    }
  }
}

field::ContactSet set_of(const std::set<std::uint32_t>& points,
                         const std::set<std::uint32_t>& barred) {
  field::ContactSet set;
  set.reserve(points.size());
  for (const std::uint32_t point : points) {
    set.point[set.count] = point;
    const bool is_barred = barred.count(point) != 0;
    set.is_barred[set.count] = is_barred ? 1 : 0;
    set.barred += is_barred ? 1 : 0;
    ++set.count;
  }
  return set;
}

// The twin compares the sets of barred points.
TEST(GuardRule, AcceptsAPoseWhereNoPointIsNewlyBarred) {
  Random random(42);
  int accepted = 0, refused = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::set<std::uint32_t> points[2], barred[2];
    const auto shell = static_cast<std::uint32_t>(integer(random, 1, 12));
    const double likely = uniform(random, 0, 1);
    for (std::uint32_t point = 0; point < shell; ++point) {
      for (int pose = 0; pose < 2; ++pose) {
        if (uniform(random, 0, 1) < 0.3) continue;
        points[pose].insert(point);
        const bool was = pose == 1 && barred[0].count(point) != 0;
        if (was ? uniform(random, 0, 1) < 0.9 : uniform(random, 0, 1) < 0.3 * likely) {
          barred[pose].insert(point);
        }
      }
    }
    const bool keeps =
        std::includes(barred[0].begin(), barred[0].end(), barred[1].begin(), barred[1].end());
    const bool accepts =
        guard::accepts_pose(set_of(points[0], barred[0]), set_of(points[1], barred[1]));
    ASSERT_EQ(accepts, keeps) << (accepts ? "unsafe" : "over-cautious") << ", trial " << trial;
    (keeps ? accepted : refused) += 1;
  }
  EXPECT_GT(accepted, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(GuardRule, ALongerMotionThanHalfAVoxelIsNone) {
  Random random(43);
  for (int trial = 0; trial < 1000; ++trial) {
    const double s = std::exp(uniform(random, std::log(1e-5), std::log(0.3)));
    const double limit_m = 0.5 * s, radius_m = std::exp(uniform(random, -6, 3)) * s;
    const double longer_m = std::nextafter(limit_m, 1.0);
    EXPECT_TRUE(guard::is_within_travel(limit_m, 0, radius_m, s));
    EXPECT_FALSE(guard::is_within_travel(longer_m, 0, radius_m, s))
        << "unsafe: longer by one unit in the last place";
    // A turn alone, and both: by 1e-12 of the limit, more than the sum's rounding.
    const double fraction = uniform(random, 0, 1);
    for (const double part : {0.0, fraction}) {
      const double turn_rad = (1 - part) * limit_m / radius_m;
      EXPECT_TRUE(guard::is_within_travel(part * limit_m * (1 - 1e-12), turn_rad * (1 - 1e-12),
                                          radius_m, s));
      EXPECT_FALSE(guard::is_within_travel(part * limit_m * (1 + 1e-12), turn_rad * (1 + 1e-12),
                                           radius_m, s))
          << "unsafe: the arc of the farthest point is longer";
    }
    EXPECT_FALSE(guard::is_within_travel(std::numeric_limits<double>::quiet_NaN(), 0, radius_m, s));
  }
}

}  // namespace
}  // namespace forcelayer::test
