// The clearance of a frame against the exact distance of the meshes, which FCL measures, at random
// poses beside scenes that try to break the proof. FORCELAYER_LONG_TESTS=1 multiplies the scenes by
// a hundred; clearance_bench judges real models, and writes a table.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/stress/clearance_campaign.h"
#include "tests/stress/provable_distance.h"
#include "tests/stress/shapes.h"
#include "tests/support/long_tests.h"

namespace forcelayer::stress {
namespace {

// Whose force begins here, in voxels; 0: two layers.
class Clearance : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Standoffs, Clearance, ::testing::Values(0, 1.9), [](const auto& standoff) {
  return standoff.param > 0 ? "Near" : "TwoLayers";
});

TEST_P(Clearance, IsNeverAboveTheExactDistanceAndNotFarBelow) {
  const std::uint64_t scenes = test::long_tests() ? 1600 : 16;
  std::vector<JudgedPose> poses;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    ClearanceScene scene = generated_clearance_scene(seed);
    scene.standoff_m = GetParam() * scene.voxel_size_m;
    const auto judged = judge_scene(scene, seed, 100);
    for (std::size_t n = 0; n < judged.size(); ++n) {
      ASSERT_FALSE(judged[n].too_much)
          << "seed " << seed << ", pose " << n << ": " << judged[n].claimed << " voxels claimed of "
          << judged[n].exact << ", provable " << judged[n].provable;
    }
    poses.insert(poses.end(), judged.begin(), judged.end());
  }
  const ClearanceSummary band = summary_of(poses, kNearVoxels, 0);
  const ObjectSummary objects = objects_of(poses);
  std::printf(
      "%zu poses; %llu from 1.2 voxels to the band's end: slack in voxels median %.3f, 99%% %.3f, "
      "most %.3f; nearest object right %llu of %llu\n",
      poses.size(), static_cast<unsigned long long>(band.poses), band.slack.median, band.slack.high,
      band.slack.largest, static_cast<unsigned long long>(objects.right),
      static_cast<unsigned long long>(objects.right + objects.wrong));
  ASSERT_GT(band.poses, 200u);
  EXPECT_LE(band.slack.median, 0.4);
  EXPECT_LE(band.slack.high, 0.9);
  EXPECT_GT(summary_of(poses, 4, kFarVoxels).poses, 100u);  // where "at least" is said
  ASSERT_GT(objects.right, 200u);
  EXPECT_LE(objects.wrong * 100, objects.right + objects.wrong);
}

// The slow twin itself: beside a plane the balls of the codes prove the distance but for their
// step, in it nothing; and more than the cell does, but never more than the truth.
TEST(ProvableDistance, IsBetweenThatOfTheCellAndTheExactOne) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const ClearanceScene scene = generated_clearance_scene(4 * seed + 1);  // not cropped
    const BakedClearance baked(scene);
    const Voxmap map = baked.open_scene();
    const Pshell shell = baked.open_part();
    const ProvableDistance provable(map, shell);
    const ClearanceJudge judge(scene.objects, scene.part, scene.voxel_size_m);
    const double s = scene.voxel_size_m;
    test::Random random(seed);
    double gain = 0;
    for (int n = 0; n < 100; ++n) {
      const mesh::Mesh& object = scene.objects[random() % scene.objects.size()];
      const mesh::Vec3d& v = object.vertices[random() % object.vertices.size()];
      const glm::dvec3 place = glm::dvec3(v[0], v[1], v[2]) +
                               s * test::uniform(random, 0, 2.5) * test::random_direction(random);
      const double by_cell = provable.by_cell_m(place), by_balls = provable.of_place_m(place);
      // Vertices are rounded to 2^-10 voxel; the search leaves off a hundredth of a voxel.
      EXPECT_LE(by_balls, judge.exact_m(place) + 0.001 * s);
      EXPECT_GE(by_balls, std::min(by_cell, 3 * s) - 0.01 * s);
      gain = std::max(gain, by_balls - by_cell);
    }
    EXPECT_GT(gain, 0.1 * s);
  }
}

// The judge itself: an object that is not the nearest one and a clearance that is too much are
// seen.
TEST(ClearanceJudge, SeesWhatIsNotTrue) {
  const std::vector<mesh::Mesh> objects = [] {
    std::vector<mesh::Mesh> two(2);
    append(two[0], box({1, 1, 1}), {{-5, 0, 0}, {1, 0, 0, 0}});
    append(two[1], box({1, 1, 1}), {{5, 0, 0}, {1, 0, 0, 0}});
    return two;
  }();
  const ClearanceJudge judge(objects, box({1, 1, 1}), 0.5);
  const Pose pose{{-1, 0, 0}, {1, 0, 0, 0}};  // 2 and 4 from the boxes
  ClearanceClaim claim{ClearanceKind::kProven, 1.9, {-2, 0, 0}, 1};
  EXPECT_DOUBLE_EQ(judge.judge(pose, claim).exact_m, 2);
  EXPECT_FALSE(judge.judge(pose, claim).too_much);
  EXPECT_EQ(judge.judge(pose, claim).object, ObjectVerdict::kRight);
  claim.clearance_m = 2.1, claim.object = 2;
  EXPECT_TRUE(judge.judge(pose, claim).too_much);
  EXPECT_EQ(judge.judge(pose, claim).object, ObjectVerdict::kWrong);
  claim.object = 3;
  EXPECT_EQ(judge.judge(pose, claim).object, ObjectVerdict::kWrong);
  claim.point_m = {0.1, 0, 0}, claim.object = 1;
  EXPECT_EQ(judge.judge(pose, claim).object, ObjectVerdict::kTie);
  claim.kind = ClearanceKind::kNone;
  EXPECT_FALSE(judge.judge(pose, claim).too_much);
  EXPECT_EQ(judge.judge(pose, claim).object, ObjectVerdict::kNotTold);
}

}  // namespace
}  // namespace forcelayer::stress
