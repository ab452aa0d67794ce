// Every way of working of the contact query finds the same points: skipping, coherence, threads,
// instruction sets, in all combinations, along motions.
#include "runtime/query/vector_targets.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <atomic>
#include <glm/gtc/quaternion.hpp>
#include <set>

#include "runtime/coupling/coupling.h"
#include "runtime/query/contact_query.h"
#include "tests/support/random_scenes.h"

namespace forcelayer::test {
namespace {

// A query under test with its own output.
struct Variant {
  std::string name;
  query::QueryOptions options;
  std::unique_ptr<query::ContactQuery> query;
  query::CollectedPoints found;
  std::uint64_t looked_at = 0;
};

query::QueryOptions options_of(unsigned bits, unsigned threads) {
  query::QueryOptions options;
  options.skip.clearance = (bits & 1) != 0;
  options.skip.super_blocks = (bits & 2) != 0;
  options.skip.coherence = (bits & 4) != 0;
  options.skip.walls = (bits & 8) != 0;
  options.threads = threads;
  options.points_worth_sharing = 0;
  return options;
}

// The scalar query without any skipping, which the twins in runtime_contact_query.cpp vouch for.
class PlainQuery {
 public:
  PlainQuery(const Voxmap& voxmap, const Pshell& shell) : query_(voxmap, shell, options()) {
    found_.reserve(shell.view().point_count);
  }

  const query::CollectedPoints& found(const Pose& pose) {
    query_.run(pose, found_);
    return found_;
  }

 private:
  static query::QueryOptions options() {
    query::QueryOptions options = options_of(0, 1);
    options.vector = false;
    return options;
  }

  query::ContactQuery query_;
  query::CollectedPoints found_;
};

Variant make_variant(std::string name, const query::QueryOptions& options, const Voxmap& voxmap,
                     const Pshell& shell) {
  Variant v;
  v.name = std::move(name);
  v.options = options;
  v.query = std::make_unique<query::ContactQuery>(voxmap, shell, options);
  v.found.reserve(shell.view().point_count);
  return v;
}

std::vector<Variant> make_variants(const Voxmap& voxmap, const Pshell& shell) {
  std::vector<Variant> variants;
  const auto add = [&](std::string name, const query::QueryOptions& options) {
    variants.push_back(make_variant(std::move(name), options, voxmap, shell));
  };
  for (const unsigned bits : {0u, 1u, 3u, 5u, 7u, 9u, 11u, 13u, 15u}) {
    for (const unsigned threads : {1u, 2u}) {
      add("skip " + std::to_string(bits) + ", threads " + std::to_string(threads),
          options_of(bits, threads));
    }
  }
  add("skip 0, threads 3", options_of(0, 3));
  add("skip 15, threads 3", options_of(15, 3));
  return variants;
}

template <typename T>
bool equal(const std::vector<T>& a, const std::vector<T>& b, std::size_t count) {
  return std::equal(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(count), b.begin());
}

// As the loop does it: helpers awake for the run alone, and now and then not at all.
void run_variant(Random& random, const Pose& pose, Variant& v) {
  if (random() % 8 != 0) v.query->wake();
  v.query->run(pose, v.found);
  v.query->rest();
  v.looked_at = v.query->points_looked_at();
}

bool same(const query::CollectedPoints& a, const query::CollectedPoints& b) {
  const std::size_t n = a.count;
  return a.count == b.count && a.interior_count == b.interior_count &&
         a.surface_count == b.surface_count && a.proximity_count == b.proximity_count &&
         a.outside_map == b.outside_map && equal(a.index, b.index, n) &&
         equal(a.value, b.value, n) && equal(a.vx, b.vx, n) && equal(a.vy, b.vy, n) &&
         equal(a.vz, b.vz, n) && equal(a.fx, b.fx, n) && equal(a.fy, b.fy, n) &&
         equal(a.fz, b.fz, n) && equal(a.rx, b.rx, n) && equal(a.ry, b.ry, n) &&
         equal(a.rz, b.rz, n) && equal(a.nx, b.nx, n) && equal(a.ny, b.ny, n) &&
         equal(a.nz, b.nz, n);
}

// Motions of every kind: rest, creeping, sliding, spinning, jumps, full turns, far away and back,
// and invalid poses.
Pose moved_pose(Random& random, const VoxelScene& scene, const Pose& now) {
  const double s = scene.voxel_size_m;
  Pose next = now;
  switch (random() % 16) {
    case 0:
      return random_pose(random, scene);
    case 1:
      next.orientation = random_orientation(random);
      break;
    case 2:
      next.position_m += random_direction(random) * s * uniform(random, 0, 2000);
      break;
    case 3:
      next.position_m = random_direction(random) * 1e5;
      break;
    case 4:
      next.orientation = glm::angleAxis(2 * M_PI, random_direction(random)) * now.orientation;
      break;
    case 5:
      return now;
    case 6:
      next.position_m.x = random() % 2 ? std::numeric_limits<double>::quiet_NaN() : 1e300;
      break;
    case 7:
      next.orientation = now.orientation * (1 + 1e-5);  // no longer unit
      break;
    default: {
      const double scale = std::exp(uniform(random, -12, 0.5));
      next.position_m += random_direction(random) * s * scale;
      next.orientation =
          glm::normalize(glm::angleAxis(uniform(random, 0, 0.1) * scale, random_direction(random)) *
                         now.orientation);
    }
  }
  return next;
}

bool is_sound(const Pose& pose) {
  return std::isfinite(pose.position_m.x) && std::abs(pose.position_m.x) < 1e6 &&
         std::abs(glm::length(pose.orientation) - 1) < 1e-9;
}

// One of them; after an invalid pose, never another such.
Pose next_pose(Random& random, const VoxelScene& scene, const Pose& now) {
  const Pose moved = moved_pose(random, scene, now);
  return is_sound(now) || is_sound(moved) ? moved : random_pose(random, scene);
}

// A part of many small blocks, up to several times as large as the scene.
PointPart blocky_part(Random& random, const VoxelScene& scene) {
  const double radius = scene.voxel_size_m * std::exp(uniform(random, 0, 5));
  PointPart part =
      sphere_part(radius, static_cast<std::size_t>(integer(random, 1, 9000)), scene.voxel_size_m);
  part.block_points = random() % 2 ? 16 : 64;
  part.super_block_blocks = static_cast<std::uint32_t>(integer(random, 1, 20));
  return part;
}

// A wall that is turned anyhow, or the inside of a ball.
VoxelScene oblique_scene(Random& random) {
  const glm::dvec3 normal = random_direction(random);
  const bool round = random() % 2 == 0;
  const Voxel min = {integer(random, -40, 0), integer(random, -40, 0), integer(random, -40, 0)};
  const Voxel dims = {integer(random, 20, 48), integer(random, 20, 48), integer(random, 20, 48)};
  const glm::dvec3 middle = glm::dvec3(min[0], min[1], min[2]) +
                            glm::dvec3(dims[0], dims[1], dims[2]) * uniform(random, 0.3, 0.7);
  const double radius = uniform(random, 8, 30);
  return VoxelScene::filled(0.002, min, dims, [&](Voxel v) {
    const glm::dvec3 from = glm::dvec3(v[0], v[1], v[2]) - middle;
    const double distance = round ? radius - glm::length(from) : glm::dot(normal, from);
    return distance < 0   ? VoxelValue::kInterior
           : distance < 1 ? VoxelValue::kSurface
           : distance < 2 ? VoxelValue::kProximity
                          : VoxelValue::kFree;
  });
}

void compare_along_a_motion(std::uint64_t seed, int poses, std::uint64_t& looked_at,
                            std::uint64_t& points) {
  Random random(seed);
  const VoxelScene scene =
      seed % 5 < 2 ? oblique_scene(random) : random_scene(random, seed % 3 == 0 ? 20'000'000 : 0);
  const auto cropped = static_cast<std::uint32_t>(seed % 4 == 0 ? random() % 64 : 0);
  const Voxmap voxmap = make_voxmap(scene, cropped);
  const Pshell shell = make_pshell(blocky_part(random, scene));
  PlainQuery plain(voxmap, shell);
  std::vector<Variant> variants = make_variants(voxmap, shell);
  Pose pose = random_pose(random, scene);
  for (int i = 0; i < poses; ++i) {
    const query::CollectedPoints& wanted = plain.found(pose);
    for (Variant& v : variants) {
      run_variant(random, pose, v);
      ASSERT_TRUE(same(v.found, wanted)) << "seed " << seed << ", pose " << i << ", " << v.name;
    }
    looked_at += variants[16].query->points_looked_at();  // all skipping, one thread
    points += shell.view().point_count;
    pose = next_pose(random, scene, pose);
  }
}

TEST(QueryVariants, FindTheSamePointsAlongEveryMotion) {
  std::uint64_t looked_at = 0, points = 0;
  for (std::uint64_t seed = 1; seed <= 48; ++seed) {
    compare_along_a_motion(seed, 50, looked_at, points);
    if (HasFatalFailure()) return;
  }
  EXPECT_LT(looked_at, points / 2);  // skipping must have happened
}

// A bar that turns about its middle and nothing else: its ends must be found as they come into the
// layer, so the slack must be spent by the whole arc.
TEST(QueryVariants, FindTheEndsOfATurningBar) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const VoxelScene scene = random_scene(random);
    PointPart part;
    part.voxel_size_m = scene.voxel_size_m;
    part.block_points = 16;
    part.super_block_blocks = 4;
    const double half_m = scene.voxel_size_m * uniform(random, 10, 60);
    for (int i = -200; i <= 200; ++i) part.add({half_m * i / 200.0, 0, 0}, {0, 0, 1});
    const Voxmap voxmap = make_voxmap(scene);
    const Pshell shell = make_pshell(part);
    PlainQuery plain(voxmap, shell);
    std::vector<Variant> variants = make_variants(voxmap, shell);
    Pose pose = random_pose(random, scene);
    const glm::dquat step =
        coupling::rotation_by(random_direction(random) * uniform(random, 0.002, 0.03));
    for (int i = 0; i < 200; ++i) {
      const query::CollectedPoints& wanted = plain.found(pose);
      for (Variant& v : variants) {
        run_variant(random, pose, v);
        ASSERT_TRUE(same(v.found, wanted)) << "seed " << seed << ", pose " << i << ", " << v.name;
      }
      pose.orientation = glm::normalize(step * pose.orientation);
    }
  }
}

// Rings of 16 points, so that each row fills its disc to the rim, off the centroid.
PointPart ring_part(Random& random, double voxel_size_m, glm::dvec3& middle_m) {
  PointPart part;
  part.voxel_size_m = voxel_size_m;
  part.block_points = random() % 2 ? 16 : 64;
  part.super_block_blocks = static_cast<std::uint32_t>(integer(random, 1, 20));
  middle_m = random_direction(random) * voxel_size_m * uniform(random, 0, 30);
  const double radius_m = voxel_size_m * uniform(random, 0.5, 6);
  const std::int64_t rings = integer(random, 1, 16);
  for (std::int64_t ring = 0; ring < rings; ++ring) {
    const double first = uniform(random, 0, 1);
    for (int i = 0; i < 16; ++i) {
      const double at = M_PI / 8 * (first + i);
      part.add(
          {middle_m.x + radius_m * std::cos(at), middle_m.y + radius_m * std::sin(at), middle_m.z},
          {0, 0, 1});
    }
  }
  return part;
}

// Two walls at right angles, in whole bricks and full up to their faces: their bounds are exact.
VoxelScene cleft_scene(Random& random) {
  const std::int64_t floor = integer(random, -12, -5), side = integer(random, -12, -5);
  return VoxelScene::filled(0.002, {-32, -32, -32}, {64, 64, 64}, [=](Voxel v) {
    return v[2] < floor || v[0] < side ? VoxelValue::kSurface : VoxelValue::kFree;
  });
}

// A hand that lets a disc slide, press, lift and turn about its own middle or its centroid, all
// slowly, beside walls that it touches again and again. Leeway is then known to a hundredth of a
// voxel and used up, along the disc's normal, across it and by its tilt; a frame's step is less.
TEST(QueryVariants, FindWhatComesSlowlyNearAWall) {
  int touches = 0;
  std::uint64_t looked_at = 0, points = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    const VoxelScene scene = cleft_scene(random);
    const double s = scene.voxel_size_m;
    glm::dvec3 middle_m;
    const Pshell shell = make_pshell(ring_part(random, s, middle_m));
    const Voxmap voxmap = make_voxmap(scene);
    PlainQuery plain(voxmap, shell);
    std::vector<Variant> variants = make_variants(voxmap, shell);
    std::erase_if(variants, [](const Variant& v) { return v.options.threads > 1; });
    const bool parallel = random() % 2 == 0;  // to a wall, and never turned
    glm::dquat orientation = parallel ? glm::dquat(1, 0, 0, 0) : random_orientation(random);
    glm::dvec3 at_m = glm::dvec3(-2, 0, -2) * s;  // of the disc's middle
    bool touched = false;
    for (int stretch = 0; stretch < 40; ++stretch) {
      const bool about_centroid = random() % 4 == 0;
      const bool at_floor = random() % 2 == 0;
      glm::dvec3 step_m = random_direction(random) * s * uniform(random, 0, 0.08);
      if (parallel) step_m = glm::dvec3(at_floor ? 0 : -0.04, 0, at_floor ? -0.04 : 0) * s;
      if (touched) step_m = glm::dvec3(0.05, 0, 0.05) * s * uniform(random, 0.5, 2);  // away
      const double turn = !parallel && random() % 3 == 0 ? uniform(random, 0, 0.02) : 0;
      const glm::dquat turning = coupling::rotation_by(random_direction(random) * turn);
      for (int i = 0; i < 40; ++i) {
        const Pose pose{at_m - orientation * middle_m, orientation};
        const query::CollectedPoints& wanted = plain.found(pose);
        touches += !touched && wanted.count > 0;
        touched = wanted.count > 0;
        for (Variant& v : variants) {
          run_variant(random, pose, v);
          ASSERT_TRUE(same(v.found, wanted)) << "seed " << seed << ", " << v.name;
        }
        looked_at += variants.back().query->points_looked_at();  // all skipping
        points += shell.view().point_count;
        orientation = glm::normalize(turning * orientation);
        at_m += step_m;
        if (about_centroid) at_m += turning * (orientation * middle_m) - orientation * middle_m;
        at_m = glm::clamp(at_m, glm::dvec3(-14 * s), glm::dvec3(6 * s));
      }
    }
  }
  EXPECT_GT(touches, 200);
  EXPECT_LT(looked_at, points / 2);
}

// The variant with all skipping on one thread, and on many.
std::vector<Variant> make_thread_variants(const Voxmap& voxmap, const Pshell& shell) {
  std::vector<Variant> variants;
  for (const unsigned threads : {1u, 2u, 3u, 5u, 8u, 16u}) {
    variants.push_back(
        make_variant("threads " + std::to_string(threads), options_of(15, threads), voxmap, shell));
  }
  return variants;
}

// All of them look at the same points, whichever thread tried which of them.
void run_thread_variants(Random& random, const Pose& pose, const query::CollectedPoints& wanted,
                         std::vector<Variant>& variants) {
  const std::uint64_t& looked_at = variants[0].looked_at;
  for (Variant& v : variants) {
    run_variant(random, pose, v);
    ASSERT_TRUE(same(v.found, wanted)) << v.name;
    ASSERT_EQ(v.looked_at, looked_at) << v.name;
  }
}

TEST(QueryVariants, LookAtTheSamePointsOnManyThreads) {
  for (std::uint64_t seed = 201; seed <= 220; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const VoxelScene scene = oblique_scene(random);
    const Voxmap voxmap = make_voxmap(scene, seed % 4 == 0 ? 63 : 0);
    const Pshell shell = make_pshell(blocky_part(random, scene));
    PlainQuery plain(voxmap, shell);
    std::vector<Variant> variants = make_thread_variants(voxmap, shell);
    Pose pose = random_pose(random, scene);
    for (int i = 0; i < 20; ++i) {
      const query::CollectedPoints& wanted = plain.found(pose);
      run_thread_variants(random, pose, wanted, variants);
      if (HasFatalFailure()) return;
      pose = next_pose(random, scene, pose);
    }
  }
}

// A part that leaves a full box and comes back: where the run before collected every point, threads
// put points in their place before they know that all will be collected again.
TEST(QueryVariants, FindWhatLeavesContactAllOver) {
  const VoxelScene scene = VoxelScene::filled(0.01, {0, 0, 0}, {64, 64, 64},
                                              [](Voxel) { return VoxelValue::kInterior; });
  const Voxmap voxmap = make_voxmap(scene);
  PointPart part = sphere_part(0.06, 5000, 0.01);
  part.block_points = 16;
  part.super_block_blocks = 4;
  const Pshell shell = make_pshell(part);
  PlainQuery plain(voxmap, shell);
  std::vector<Variant> variants = make_thread_variants(voxmap, shell);
  Random random(1);
  int all = 0, some = 0;
  for (int i = 0; i < 60; ++i) {
    const double x_m = 0.08 - 0.05 * std::sin(0.3 * i);
    const Pose pose{{x_m, 0.3, 0.3}, random_orientation(random)};
    const query::CollectedPoints& wanted = plain.found(pose);
    (wanted.count == shell.view().point_count ? all : some) += 1;
    run_thread_variants(random, pose, wanted, variants);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(all, 20);
  EXPECT_GT(some, 10);
}

TEST(QueryWorkers, DoEachChunkOnce) {
  struct Work {
    std::vector<std::atomic<int>> done = std::vector<std::atomic<int>>(200);
  };
  const auto count = [](void* context, std::uint32_t chunk) noexcept {
    ++static_cast<Work*>(context)->done[chunk];
  };
  Random random(1);
  for (const unsigned helpers : {1u, 2u, 4u, 7u, 15u}) {
    query::QueryWorkers workers(helpers);
    for (int run = 0; run < 100; ++run) {
      const auto chunks = static_cast<std::uint32_t>(integer(random, 0, 200));
      Work work;
      if (random() % 4 != 0) workers.wake();
      workers.run(count, &work, chunks);
      workers.rest();
      for (std::uint32_t chunk = 0; chunk < 200; ++chunk) {
        ASSERT_EQ(work.done[chunk], chunk < chunks) << helpers << " helpers, chunk " << chunk;
      }
    }
  }
}

// Instruction set by instruction set; 0: all.
void use_target(std::int64_t targets) {
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(QueryVariants, FindTheSamePointsWithEveryInstructionSet) {
  const auto targets = hwy::SupportedAndGeneratedTargets();
  std::set<std::string> used;
  for (const std::int64_t target : targets) {
    use_target(target);
    SCOPED_TRACE(query::kernel_target());
    used.insert(query::kernel_target());
    std::uint64_t looked_at = 0, points = 0;
    for (std::uint64_t seed = 101; seed <= 108; ++seed) {
      compare_along_a_motion(seed, 30, looked_at, points);
      if (HasFatalFailure()) break;
    }
  }
  use_target(0);
  EXPECT_EQ(used.size(), targets.size()) << "the switch did not switch";
}

// Uniform boxes of every value, a map that is free everywhere, and one of a single voxel.
TEST(QueryVariants, FindTheSamePointsInUniformAndEmptyMaps) {
  const VoxelScene scenes[] = {
      VoxelScene::filled(0.01, {0, 0, 0}, {64, 64, 64},
                         [](Voxel) { return VoxelValue::kInterior; }),
      VoxelScene::filled(0.01, {0, 0, 0}, {8, 8, 8}, [](Voxel) { return VoxelValue::kSurface; }),
      VoxelScene::filled(0.01, {0, 0, 0}, {8, 8, 8}, [](Voxel) { return VoxelValue::kFree; }),
      VoxelScene::filled(0.01, {-3, -3, -3}, {1, 1, 1},
                         [](Voxel) { return VoxelValue::kSurface; })};
  Random random(1);
  const Pshell shell = make_pshell(sphere_part(0.06, 2000, 0.01));
  for (const VoxelScene& scene : scenes) {
    const Voxmap voxmap = make_voxmap(scene);
    PlainQuery plain(voxmap, shell);
    std::vector<Variant> variants = make_variants(voxmap, shell);
    for (int i = 0; i < 50; ++i) {
      const Pose pose = random_pose(random, scene);
      const query::CollectedPoints& wanted = plain.found(pose);
      for (Variant& v : variants) {
        run_variant(random, pose, v);
        ASSERT_TRUE(same(v.found, wanted)) << v.name;
      }
    }
  }
}

}  // namespace
}  // namespace forcelayer::test
