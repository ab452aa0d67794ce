// A check that is stopped after any number of steps says so, and never answers yes to what it has
// not checked. Its twin is the same check without a limit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "tests/support/baked_scene.h"
#include "tests/support/make_pshell.h"
#include "tests/support/sanitized.h"
#include "workbench/exact/exact_check.h"
#include "workbench/exact/watch.h"

namespace forcelayer::exact {
namespace {

using voxcheck::ExactAnswer;
using voxcheck::ExactRequest;
using voxcheck::ExactStop;
using voxcheck::ExactViolation;

constexpr std::uint32_t kSides = 4, kBore = 1, kWall = 2;
constexpr double kBoreM = 10, kOverlapM = 0.2, kWallAwayM = 0.5;

// A tube around the z axis, outwards.
Surface tube(double hole_m, double radius_m, double half_m) {
  Surface surface;
  for (const auto& [r, z] : {std::pair(hole_m, -half_m), std::pair(radius_m, -half_m),
                             std::pair(radius_m, half_m), std::pair(hole_m, half_m)}) {
    for (std::uint32_t n = 0; n < kSides; ++n) {
      const double turn = 2 * std::numbers::pi * n / kSides;
      surface.vertices_m.push_back({r * std::cos(turn), r * std::sin(turn), z});
    }
  }
  for (std::uint32_t ring = 0; ring < 4; ++ring) {
    const std::uint32_t lower = ring * kSides, upper = (ring + 1) % 4 * kSides;
    for (std::uint32_t n = 0; n < kSides; ++n) {
      const std::uint32_t next = (n + 1) % kSides;
      surface.triangles.push_back({lower + n, lower + next, upper + next});
      surface.triangles.push_back({lower + n, upper + next, upper + n});
    }
  }
  surface.object.assign(surface.triangles.size(), kBore);
  surface.largest_m = std::max(radius_m, half_m);
  return surface;
}

// A sleeve that is pressed into a bore, and a wall beside its path.
class PressFit {
 public:
  PressFit()
      : baked_(reference::objects_of({mesh_of(tube(kBoreM, 20, 3))}),
               reference::options_with(2, 4)),
        shell_({{0, 0, 6}}, {{0, 0, -1}}, shell_options()) {}

  // The answer after so many questions of the watch at most.
  ExactAnswer pulled(const glm::dvec3& to_m, double required_m, std::uint64_t questions) {
    ExactRequest request;
    request.required_m = required_m;
    request.seat = {kBore};
    request.seat_pose = {0, 0, 0, 1, 0, 0, 0};
    request.seated = {{0, 1}};
    request.stretches = {{0, 1, 0, true, true}};
    request.quiet = true;
    std::vector<PathRow> rows(2);
    rows[1].time_s = 1;
    rows[1].position_m = {to_m.x, to_m.y, to_m.z};
    asked_ = 0;
    const Watch watch([&] { return asked_++ < questions; });
    auto answer = check_exactly(meshes(), rows, request);
    if (!answer) throw std::runtime_error(to_line(answer.error()));
    return std::move(*answer);
  }
  std::uint64_t asked() const { return asked_; }

 private:
  static testing::TestShellOptions shell_options() {
    testing::TestShellOptions options;
    options.voxel_size_m = 4;
    options.covering_radius_m = 100;
    return options;
  }
  static mesh::Mesh mesh_of(const Surface& surface) {
    mesh::Mesh mesh;
    for (const glm::dvec3& v : surface.vertices_m) mesh.vertices.push_back({v.x, v.y, v.z});
    mesh.triangles = surface.triangles;
    return mesh;
  }
  Meshes meshes() const {
    Surface scene = tube(kBoreM, 20, 3);
    const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
    const double x_m = kBoreM + kOverlapM + kWallAwayM;
    for (const glm::dvec3& v : {glm::dvec3(x_m, -9, 10), {x_m, 9, 10}, {x_m, 0, 14}}) {
      scene.vertices_m.push_back(v);
    }
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.object.push_back(kWall);
    scene.largest_m = 60;
    auto voxmap = Voxmap::from_bytes(baked_.map().bytes(), "scene", Verify::kStructure);
    auto shell = Pshell::from_bytes(shell_.pshell().bytes(), "part", Verify::kStructure);
    if (!voxmap || !shell) throw std::runtime_error("the files of the test are damaged");
    return {std::move(*voxmap),
            std::move(*shell),
            std::move(scene),
            tube(5, kBoreM + kOverlapM, 6),
            {}};
  }

  reference::BakedScene baked_;
  testing::BuiltPshell shell_;
  std::uint64_t asked_ = 0;
};

// From none to all, each of the first and of the last.
std::set<std::uint64_t> limits_up_to(std::uint64_t all) {
  std::set<std::uint64_t> limits;
  for (std::uint64_t n = 1; n <= std::min<std::uint64_t>(all, 10); ++n) limits.insert(all - n);
  for (std::uint64_t n = 0; n < all; n += n < 30 ? 1 : n) limits.insert(n);
  return limits;
}

TEST(TimeLimit, EndsEachStageWithWhatIsCertain) {
  constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();
  PressFit fit;
  const struct {
    const char* name;
    glm::dvec3 to_m;
    double required_m;
    std::size_t violations;
  } cases[] = {{"clear", {0, 0, 12}, 0.3, 0},
               {"near a wall", {0, 0, 12}, 0.6, 1},
               {"into the bore", {0.5, 0, 0}, 0.3, 1}};
  std::set<int> all_stages;
  for (const auto& [name, to_m, required_m, violations] : cases) {
    SCOPED_TRACE(name);
    const ExactAnswer whole = fit.pulled(to_m, required_m, kNoLimit);
    ASSERT_TRUE(whole.stop.empty());
    ASSERT_EQ(whole.violations.size(), violations);
    std::set<int> stages;
    double settled_s = 0;
    for (const std::uint64_t limit : limits_up_to(fit.asked())) {
      SCOPED_TRACE(limit);
      const ExactAnswer answer = fit.pulled(to_m, required_m, limit);
      ASSERT_EQ(answer.stop.size(), 1u);
      const ExactStop& stop = answer.stop[0];
      // It goes on from stage to stage, and along the path in each.
      if (!stages.contains(stop.stage)) settled_s = 0;
      EXPECT_TRUE(stages.empty() || stop.stage >= *stages.rbegin());
      EXPECT_GE(stop.settled_s, settled_s);
      stages.insert(stop.stage), settled_s = stop.settled_s;
      // A violation that was found by then is true, and what was settled before is known.
      EXPECT_LE(answer.violations.size(), violations);
      for (const ExactViolation& found : answer.violations) {
        EXPECT_FALSE(found.graze);
        EXPECT_TRUE(found.pushed_into_seat || found.worst.exact_m < required_m);
        EXPECT_EQ(found.worst.object, whole.violations[0].worst.object);
      }
      if (stop.stage > ExactStop::kClearance && !whole.violations.empty() &&
          !whole.violations[0].pushed_into_seat) {
        EXPECT_EQ(answer.violations.size(), 1u);
      }
      EXPECT_LE(answer.clearance_m, whole.clearance_m + 1e-9);
      if (stop.stage == ExactStop::kSmallest) {
        EXPECT_EQ(answer.violations.size(), violations);
        EXPECT_EQ(answer.clearance_m, violations == 0 ? required_m : 0);
      }
    }
    all_stages.merge(stages);
  }
  EXPECT_EQ(all_stages.size(), 4u);
}

// Pulled into the wall: from when on the two touch is said where it was found, and is true then.
TEST(TimeLimit, NamesABlockerBeforeAndAfterItsContactIsFound) {
  PressFit fit;
  const glm::dvec3 to_m{1.2 * kWallAwayM, 0, 5};
  const auto wall_of = [](const ExactAnswer& answer) {
    const auto found = std::ranges::find_if(answer.violations, [](const ExactViolation& v) {
      return v.worst.object == kWall && v.meets();
    });
    return found == answer.violations.end() ? std::nullopt : std::optional(*found);
  };
  // So long until it is found: the rest takes long, and says no more.
  std::uint64_t enough = 1;
  std::optional<ExactViolation> whole;
  while (enough < 1u << 20 && !(whole && whole->contact_known)) {
    enough *= 2;
    whole = wall_of(fit.pulled(to_m, 0.3, enough));
  }
  ASSERT_TRUE(whole && whole->contact_known);
  EXPECT_GT(whole->contact_s, whole->from_s);
  std::set<int> stages;
  int before = 0, after = 0;
  constexpr std::uint64_t kLimits = test::kSanitized ? 2 : 16;
  for (std::uint64_t n = 1; n <= kLimits; ++n) {
    const std::uint64_t limit = enough * n / kLimits;
    const ExactAnswer answer = fit.pulled(to_m, 0.3, limit);
    ASSERT_EQ(answer.stop.size(), 1u);
    stages.insert(answer.stop[0].stage);
    const auto found = wall_of(answer);
    if (!found) continue;
    ++(found->contact_known ? after : before);
    if (found->contact_known) {
      EXPECT_EQ(found->contact_s, whole->contact_s);
    } else {
      EXPECT_LE(answer.stop[0].stage, ExactStop::kBlockers);
    }
  }
  EXPECT_TRUE(test::kSanitized || stages.contains(ExactStop::kBlockers));
  EXPECT_TRUE(test::kSanitized || before > 0);
  EXPECT_GT(after, 0);
}

}  // namespace
}  // namespace forcelayer::exact
