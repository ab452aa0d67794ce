// The seat of a part that starts installed, on scenes that are formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "runtime/coupling/coupling.h"
#include "runtime/guard/pose_guard.h"
#include "runtime/query/shell_neighbors.h"
#include "runtime/run/baked_files.h"
#include "runtime/stream/recording.h"
#include "tests/support/distance_scene.h"
#include "tests/support/motion_bench.h"
#include "tests/support/sanitized.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;

// A floor: solid below z = 0.
VoxelScene floor_with_distances() {
  return distance_scene(
      kS, {-12, -12, -8}, {24, 24, 24}, [](const glm::dvec3& p) { return p.z; }, 2,
      DistanceDefinition(2));
}

// A sheet without thickness at z = 0, midway between voxel centers.
VoxelScene sheet_with_distances() {
  return distance_scene(
      kS, {-12, -12, -12}, {24, 24, 24}, [](const glm::dvec3& p) { return std::abs(p.z); }, 2,
      DistanceDefinition(2));
}

constexpr double kHalf = 0.01;  // of the block's height
PointPart block() { return box_part({0.015, 0.012, kHalf}, 0.8 * kS, kS); }
Pose resting(double gap_m = 0) { return {{0.0007, 0.0003, kHalf + gap_m}, {1, 0, 0, 0}}; }

struct SeatedBlock : MotionBench {
  explicit SeatedBlock(const VoxelScene& scene, const Pose& at = resting())
      : MotionBench(scene, block(), at) {
    PartStart start;
    start.world_from_part = at;
    begun = simulation->begin(start, at);
    if (begun) state = *begun;
  }
  // To a place in steps of a tenth of a millimeter.
  StepResult move_by(const glm::dvec3& way_m, int frames) {
    StepResult result;
    const Pose from = input.world_from_handle;
    for (int i = 1; i <= frames; ++i) {
      Pose to = from;
      to.position_m += way_m * (i / static_cast<double>(frames));
      result = step_to(to);
    }
    return result;
  }
  Result<State> begun = State{};
};

TEST(Seat, APartThatRestsIsAtRestWithoutForce) {
  SeatedBlock bench(floor_with_distances());
  ASSERT_TRUE(bench.begun) << to_line(bench.begun.error());
  ASSERT_EQ(bench.simulation->seat().size(), 1u);
  EXPECT_GT(bench.simulation->seat()[0].points, 10u);
  const Pose before = bench.part();
  StepResult result;
  for (int i = 0; i < 200; ++i) result = bench.hold();
  EXPECT_EQ(glm::length(result.wrench.force_n), 0);
  EXPECT_EQ(glm::length(bench.part().position_m - before.position_m), 0);
  EXPECT_GT(result.report.seated, 0u);
  EXPECT_EQ(result.report.interior, 0u);
  EXPECT_EQ(result.report.clearance_kind, ClearanceKind::kNone);
  EXPECT_EQ(bench.state.seat, kSeatEntered);
}

TEST(Seat, APartThatIsPushedIsHeldAndSlides) {
  for (const VoxelScene& scene : {floor_with_distances(), sheet_with_distances()}) {
    SeatedBlock bench(scene);
    ASSERT_TRUE(bench.begun) << to_line(bench.begun.error());
    const double start_m = bench.part().position_m.z;
    StepResult result = bench.move_by({0, 0, -0.03}, 300);
    for (int i = 0; i < 300; ++i) result = bench.hold();
    EXPECT_GT(result.wrench.force_n.z, 5);
    // A quarter of a voxel, and on a sheet as far as its middle.
    EXPECT_GT(bench.part().position_m.z, start_m - 0.55 * kS);
    EXPECT_EQ(result.report.interior, 0u);
    // Along the floor, pressed lightly.
    bench.move_by({0, 0, 0.029}, 300);
    const double x_m = bench.part().position_m.x;
    bench.move_by({0.01, 0, 0}, 300);
    EXPECT_NEAR(bench.part().position_m.x, x_m + 0.01, 0.2 * kS);
  }
}

// Pressed down through its gap, it stops at 0.15 voxels before the floor, or where it was at the
// start but for half a step of the stored distances.
TEST(Seat, APartWithAGapIsHeldBeforeTheSurface) {
  for (const double gap_voxels : {0.05, 0.1, 0.2, 0.3}) {
    SCOPED_TRACE(gap_voxels);
    SeatedBlock bench(floor_with_distances(), resting(gap_voxels * kS));
    ASSERT_TRUE(bench.begun) << to_line(bench.begun.error());
    // The faces beside an edge may lie as near: edges push no earlier than faces.
    const guard::SeatObject& floor = bench.simulation->seat()[0];
    EXPECT_LE(floor.between_m, floor.contact_m);
    EXPECT_EQ(glm::length(bench.hold().wrench.force_n), 0);
    StepResult result = bench.move_by({0, 0, -0.03}, 300);
    for (int i = 0; i < 300; ++i) result = bench.hold();
    EXPECT_GT(result.wrench.force_n.z, 5);
    const double height_voxels = (bench.part().position_m.z - kHalf) / kS;
    EXPECT_LT(height_voxels, std::min(gap_voxels, 0.16));
    EXPECT_GT(height_voxels, std::min(gap_voxels, 0.15) - 0.04);
  }
}

TEST(Seat, ClosesWhenThePartHasLeftAndIsNeverOpenedAgain) {
  SeatedBlock bench(floor_with_distances());
  ASSERT_TRUE(bench.begun);
  bench.move_by({0, 0, 1.5 * kS}, 200);
  EXPECT_EQ(bench.state.seat, kSeatEntered);
  bench.move_by({0, 0, -1.5 * kS}, 200);
  EXPECT_NEAR(bench.part().position_m.z, kHalf, 0.1 * kS);  // back in its seat
  const StepResult away = bench.move_by({0, 0, 4 * kS}, 400);
  EXPECT_EQ(bench.state.seat, kSeatClosed);
  EXPECT_NE(away.report.clearance_kind, ClearanceKind::kNone);
  bench.move_by({0, 0, -4 * kS}, 400);
  EXPECT_EQ(bench.state.seat, kSeatClosed);
  EXPECT_GT(bench.part().position_m.z, kHalf + 1.6 * kS);  // the guard's distance
  // The clutch does not open it either.
  bench.input.valid = kInputClutched;
  bench.hold();
  EXPECT_EQ(bench.state.seat, kSeatClosed);
}

TEST(Seat, TheClutchKeepsIt) {
  SeatedBlock bench(floor_with_distances());
  ASSERT_TRUE(bench.begun);
  bench.hold();
  bench.input.valid = kInputClutched;
  bench.hold();
  bench.input.valid = kInputValid;
  const StepResult result = bench.hold();
  EXPECT_EQ(bench.state.seat, kSeatEntered);
  EXPECT_EQ(glm::length(result.wrench.force_n), 0);
}

// Installed elsewhere than where it starts: the seat is open until the part was there.
TEST(Seat, APartCanBePutWhereItIsInstalled) {
  const Pose above = resting(6 * kS);
  MotionBench bench(floor_with_distances(), block(), above);
  PartStart start;
  start.world_from_part = above;
  start.world_from_seat = resting();
  const auto begun = bench.simulation->begin(start, above);
  ASSERT_TRUE(begun) << to_line(begun.error());
  bench.state = *begun;
  for (int i = 1; i <= 600; ++i) {
    Pose to = above;
    to.position_m.z -= 6 * kS * (i / 600.0);
    bench.step_to(to);
  }
  EXPECT_NEAR(bench.part().position_m.z, kHalf, 0.1 * kS);
  EXPECT_EQ(bench.state.seat, kSeatEntered);
}

TEST(Seat, WhatCannotBeToldIsRefused) {
  VoxelScene lean = floor_with_distances();
  lean.codes.clear();
  lean.distances = {};
  const SeatedBlock in_lean(lean);
  ASSERT_FALSE(in_lean.begun);
  EXPECT_EQ(in_lean.begun.error().code, ErrorCode::kUsage);
  EXPECT_NE(in_lean.begun.error().mend.find("without --kind lean"), std::string::npos);

  const SeatedBlock deep(floor_with_distances(), resting(-0.9 * kS));
  ASSERT_FALSE(deep.begun);
  EXPECT_NE(deep.begun.error().what.find("inside the scene"), std::string::npos);
  EXPECT_NE(deep.begun.error().mend.find("--range"), std::string::npos);

  const SeatedBlock shallow(floor_with_distances(), resting(-0.3 * kS));
  ASSERT_TRUE(shallow.begun);
  EXPECT_NEAR(shallow.simulation->seat()[0].overlap_m, 0.3 * kS, 0.05 * kS);

  const SeatedBlock clear(floor_with_distances(), resting(5 * kS));
  ASSERT_TRUE(clear.begun);
  EXPECT_TRUE(clear.simulation->seat().empty());
  EXPECT_EQ(clear.state.seat, kSeatClosed);
}

// A part that is refused starts at least as deep as the depth that the error says is allowed, and
// no part that begins starts deeper than that.
TEST(Seat, TheDepthThatIsAllowedIsReported) {
  double deepest_mm = 0;
  int begun = 0, refused = 0;
  for (int n = 0; n < 100; ++n) {
    const double depth_m = (0.4 + 0.005 * n) * kS;
    SCOPED_TRACE(depth_m);
    const SeatedBlock bench(floor_with_distances(), resting(-depth_m));
    if (bench.begun) {
      ++begun;
      deepest_mm = std::max(deepest_mm, 1000 * bench.simulation->seat()[0].overlap_m);
      continue;
    }
    ++refused;
    const std::string& what = bench.begun.error().what;
    const std::size_t starts = what.find_first_of("0123456789"), allowed = what.rfind("up to ") + 6;
    ASSERT_LT(allowed, what.size()) << what;
    const double starts_mm = std::stod(what.substr(starts)),
                 allowed_mm = std::stod(what.substr(allowed));
    EXPECT_GE(starts_mm, allowed_mm) << what;
    EXPECT_LE(deepest_mm, allowed_mm + 0.005) << what;  // rounded to three digits
  }
  EXPECT_GT(begun, 10);
  EXPECT_GT(refused, 10);
}

// Begins with the part at `world_from_part`, among what has this distance in the part's frame.
Result<State> begin_in(const std::function<double(glm::dvec3)>& distance_m, const PointPart& part,
                       const Pose& world_from_part) {
  const Pose part_from_world = inverse(world_from_part);
  const VoxelScene scene = distance_scene(
      kS, {-12, -12, -12}, {24, 24, 24},
      [&](const glm::dvec3& p) {
        return distance_m(part_from_world.position_m + part_from_world.orientation * p);
      },
      2, DistanceDefinition(2));
  MotionBench bench(scene, part, world_from_part);
  PartStart start;
  start.world_from_part = world_from_part;
  return bench.simulation->begin(start, world_from_part);
}

// A sheet or plate through the part is refused. One that ends at its surface, or in a groove of it,
// is a seat.
TEST(Seat, APlateThroughThePartIsRefused) {
  constexpr double kCube = 0.03;
  const PointPart cube = box_part(glm::dvec3(kCube), 0.8 * kS, kS);
  PointPart grooved;
  grooved.voxel_size_m = cube.voxel_size_m;
  grooved.covering_radius_m = cube.covering_radius_m;
  for (const double side : {-1.0, 1.0}) {  // half of the cube each, 0.2 voxels apart
    const PointPart half = box_part({kCube, kCube, 0.5 * kCube - 0.05 * kS}, 0.8 * kS, kS);
    for (std::size_t i = 0; i < half.points.size(); ++i) {
      const auto& [x, y, z] = half.points[i];
      const auto& [nx, ny, nz] = half.normals[i];
      grooved.add({x, y, z + side * (0.5 * kCube + 0.05 * kS)}, {nx, ny, nz});
    }
  }
  const auto begins = [](const PointPart& part, const std::function<double(glm::dvec3)>& distance_m,
                         const glm::dquat& turn) {
    const auto begun = begin_in(distance_m, part, {{0.0011, -0.0007, 0.0004}, turn});
    if (begun) return true;
    EXPECT_NE(begun.error().what.find("pierces the part"), std::string::npos)
        << to_line(begun.error());
    return false;
  };
  for (const glm::dquat& turn : {glm::dquat(1, 0, 0, 0), coupling::rotation_by({0.3, -0.5, 0.2}),
                                 coupling::rotation_by({-0.9, 0.4, 1.1})}) {
    for (const double half_voxels : {0.0, 0.1, 0.3, 0.45}) {
      SCOPED_TRACE(half_voxels);
      const double half_m = half_voxels * kS;
      const auto plate = [&](const glm::dvec3& p) { return std::abs(p.z) - half_m; };
      const auto tilted = [&](const glm::dvec3& p) {
        return std::abs(0.8 * p.z + 0.6 * p.x) - half_m;
      };
      const auto ends_at_face = [&](const glm::dvec3& p) {
        const double x = p.x + kCube, z = std::abs(p.z) - half_m;
        return x < 0 ? std::max(x, z) : std::hypot(x, std::max(0.0, z));
      };
      EXPECT_FALSE(begins(cube, plate, turn));
      EXPECT_FALSE(begins(cube, tilted, turn));
      EXPECT_TRUE(begins(cube, ends_at_face, turn));
      if (half_voxels <= 0.1) {
        EXPECT_TRUE(begins(grooved, plate, turn));
      }
    }
  }
}

// A stud behind a thin wall of the part does not pierce it, and a sheet through the wall does.
TEST(Seat, AStudBehindAThinWallIsNotThroughIt) {
  constexpr double kHalfWall = 0.06 * kS, kGap = 0.06 * kS;
  const PointPart wall = box_part({0.03, 0.03, kHalfWall}, 0.8 * kS, kS);
  // Points of both faces cover it together, so those of one face are farther apart.
  constexpr double kApart = 1.6 * kS;
  PointPart sparse;
  sparse.voxel_size_m = kS;
  sparse.covering_radius_m = 0.85 * kS;
  for (int i = -9; i <= 9; ++i) {
    for (int j = -9; j <= 9; ++j) {
      sparse.add({kApart * i, kApart * j, kHalfWall}, {0, 0, -1});
      sparse.add({kApart * (i + 0.5), kApart * (j + 0.5), -kHalfWall}, {0, 0, 1});
    }
  }
  const auto sheet = [](const glm::dvec3& p) { return std::abs(p.x) - 0.1 * kS; };
  std::mt19937 random(5);
  std::uniform_real_distribution<double> of(-1, 1);
  for (int trial = 0; trial < 300; trial += static_cast<int>(test::seed_step(13))) {
    SCOPED_TRACE(trial);
    const glm::dvec3 off = kS * glm::dvec3(of(random), of(random), of(random));
    const glm::dquat turn = coupling::rotation_by({of(random), of(random), of(random)});
    const glm::dvec3 middle = 2 * kS * glm::dvec3(of(random), of(random), 0);
    const double half_m = kS * (1.7 + 0.1 * of(random));
    const auto stud = [&](const glm::dvec3& p) {
      const glm::dvec3 beside = glm::abs(p - middle) - half_m,
                       away(beside.x, beside.y, p.z + kHalfWall + kGap);
      const double inside_m = std::max({away.x, away.y, away.z});
      return inside_m < 0 ? inside_m : glm::length(glm::max(away, 0.0));
    };
    EXPECT_TRUE(begin_in(stud, sparse, {off, turn}));
    if (trial < 20) {
      EXPECT_FALSE(begin_in(sheet, wall, {off, turn}));
    }
  }
}

// A part that is installed elsewhere may start anywhere but in the scene.
TEST(Seat, AStartApartFromTheSeatIsClear) {
  MotionBench bench(floor_with_distances(), block(), resting(6 * kS));
  const auto begin = [&](const Pose& at) {
    PartStart start;
    start.world_from_part = at;
    start.world_from_seat = resting();
    return bench.simulation->begin(start, at);
  };
  EXPECT_TRUE(begin(resting()));
  EXPECT_TRUE(begin(resting(6 * kS)));
  const auto inside = begin(resting(-0.5 * kS));
  ASSERT_FALSE(inside);
  EXPECT_EQ(inside.error().code, ErrorCode::kUsage);
  EXPECT_NE(inside.error().what.find("outside its seat"), std::string::npos);
}

TEST(Seat, AForceWithoutDistancesIsRefusedForWhatItIs) {
  RunRequest request;
  request.device = paper_device();
  request.without_guarantee = true;
  request.force = ForceKind::kLevel;
  auto run = open_run(make_voxmap(floor_with_distances()), make_pshell(block()), request);
  ASSERT_TRUE(run) << to_line(run.error());
  PartStart start;
  start.world_from_part = resting();
  const auto begun = run->simulation().begin(start, resting());
  ASSERT_FALSE(begun);
  EXPECT_NE(begun.error().mend.find("leave out --force"), std::string::npos);
}

// Solid below two planes that meet at a right angle along the y axis.
double below_ridge_m(const glm::dvec3& p) {
  const double side_m = std::abs(p.x);
  return side_m > p.z ? std::sqrt(0.5) * (side_m + p.z) : std::hypot(p.x, p.z);
}
VoxelScene ridge_with_distances() {
  return distance_scene(kS, {-12, -12, -12}, {24, 24, 24}, below_ridge_m, 2, DistanceDefinition(2));
}
// A rib of 6 mm, upright along the y axis, and nothing else.
VoxelScene rib_with_distances() {
  return distance_scene(
      kS, {-12, -12, -12}, {24, 24, 24},
      [](const glm::dvec3& p) {
        const double x_m = std::abs(p.x) - 0.003;
        return p.z <= 0 ? std::max(x_m, p.z) : std::hypot(std::max(x_m, 0.0), p.z);
      },
      2, DistanceDefinition(2));
}

// Points 7.5 mm apart: an edge at x = 0 lies midway between two rows of them.
PointPart sparse_block() {
  PointPart part = box_part({0.015, 0.015, kHalf}, 1.5 * kS, kS);
  part.covering_radius_m *= 1.01;  // diagonals of its lattice are not twice that by rounding
  return part;
}
Pose on_edge(double z_m = 0) { return {{0.00375, 0.0003, kHalf + z_m}, {1, 0, 0, 0}}; }

struct SparseBlock : MotionBench {
  SparseBlock(const VoxelScene& scene, const Pose& at) : MotionBench(scene, sparse_block(), at) {
    PartStart start;
    start.world_from_part = at;
    const auto begun = simulation->begin(start, at);
    if (!begun) throw std::runtime_error(to_line(begun.error()));
    state = *begun;
  }
};

TEST(Seat, AnEdgeBetweenTwoPointsIsFelt) {
  SparseBlock bench(ridge_with_distances(), on_edge());
  EXPECT_EQ(glm::length(bench.hold().wrench.force_n), 0);
  EXPECT_EQ(bench.part().position_m.z, kHalf);
  Pose down = on_edge();
  for (int i = 0; i < 600; ++i) {
    down.position_m.z -= i < 300 ? 2e-5 : 0;
    bench.step_to(down);
  }
  // The points on both sides would touch at three quarters of a voxel.
  EXPECT_GT(bench.part().position_m.z, kHalf - 0.45 * kS);
  EXPECT_LT(bench.part().position_m.z, kHalf);
}

// A rib in a gap of the part that is narrower than the points are apart.
TEST(Seat, ARibThatStandsBetweenPointsIsNotInTheWay) {
  SparseBlock bench(rib_with_distances(), on_edge(-0.004));
  ASSERT_EQ(bench.simulation->seat().size(), 1u);
  EXPECT_FALSE(bench.simulation->seat()[0].feels_between);
  Pose along = on_edge(-0.004);
  StepResult result;
  for (int i = 0; i < 300; ++i) {
    along.position_m.y += 2e-5;
    result = bench.step_to(along);
  }
  EXPECT_NEAR(bench.part().position_m.y, along.position_m.y, 0.05 * kS);
  EXPECT_LT(glm::length(result.wrench.force_n), 0.05);
}

// The depth of what lies between points, from all pairs of collected points.
std::vector<float> depths_between(const query::CollectedPoints& points,
                                  const field::FieldSamples& samples, float zero_force_m,
                                  float near_m, const guard::SeatObject& object,
                                  std::vector<float> depth_m) {
  for (std::uint32_t a = 0; a < points.count; ++a) {
    for (std::uint32_t b = a + 1; b < points.count; ++b) {
      const glm::dvec3 way(double{points.rx[b]} - points.rx[a], double{points.ry[b]} - points.ry[a],
                           double{points.rz[b]} - points.rz[a]);
      if (glm::length(way) > near_m) continue;
      glm::dvec3 na(points.nx[a], points.ny[a], points.nz[a]);
      glm::dvec3 nb(points.nx[b], points.ny[b], points.nz[b]);
      // The block's faces are flat: two points are of one face, or on an edge of one.
      const auto is_along = [&](const glm::dvec3& n) {
        return std::abs(glm::dot(way, n)) < 0.12 * glm::length(way);
      };
      if (glm::dot(na, nb) < 0.5 && is_along(nb)) na = nb;
      if (glm::dot(na, nb) < 0.5 && is_along(na)) nb = na;
      if (glm::dot(na, nb) < 0.5) continue;
      const auto slope = [&](std::uint32_t i, const glm::dvec3& n) {
        const glm::dvec3 g(samples.gx[i], samples.gy[i], samples.gz[i]);
        return g - glm::dot(g, n) * n;
      };
      const double from_a_m = zero_force_m + samples.from_zero_force_m[a];
      const double from_b_m = zero_force_m + samples.from_zero_force_m[b];
      const auto tilt = [&](std::uint32_t i) {
        return glm::length(slope(i, {points.nx[i], points.ny[i], points.nz[i]}));
      };
      const auto is_read = [&](std::uint32_t i, double from_m) {
        return tilt(i) > 0.2 || (tilt(i) > 0.1 && from_m < object.between_m + 0.2 * near_m);
      };
      if (!is_read(a, from_a_m) || !is_read(b, from_b_m)) continue;
      if (!(tilt(a) > 0.2 || tilt(b) > 0.2)) continue;
      double fall_a_m = -glm::dot(slope(a, na), way);
      double fall_b_m = glm::dot(slope(b, nb), way);
      const auto counted = [&](double fall_m, double from) {
        return std::clamp((fall_m / glm::length(way) - from) / from, 0.0, 1.0);
      };
      const double both = counted(std::max(fall_a_m, fall_b_m), 0.2);
      fall_a_m *= both * counted(fall_a_m, 0.1);
      fall_b_m *= both * counted(fall_b_m, 0.1);
      if (!(fall_a_m > 0 && fall_b_m > 0)) continue;
      if (!(from_a_m < near_m && from_b_m < near_m)) continue;
      const double t = (from_a_m - from_b_m + fall_b_m) / (fall_a_m + fall_b_m);
      if (!(t > 0 && t < 1)) continue;
      const auto deep_m = static_cast<float>(object.between_m - (from_a_m - t * fall_a_m));
      for (const std::uint32_t i : {a, b}) depth_m[i] = std::max(depth_m[i], deep_m);
    }
  }
  return depth_m;
}

TEST(Seat, DepthsBetweenPointsAreThoseOfAllPairs) {
  const Voxmap voxmap = make_voxmap(ridge_with_distances());
  const Pshell shell = make_pshell(sparse_block());
  const auto force = field::make_force_field(Model::kDefault, ForceKind::kDistance, voxmap);
  ASSERT_TRUE(force);
  query::ContactQuery query(voxmap, shell);
  query::CollectedPoints points;
  field::FieldSamples samples;
  field::ContactSet contacts;
  points.reserve(shell.view().point_count), samples.reserve(shell.view().point_count);
  contacts.reserve(shell.view().point_count);
  guard::PoseGuard probe(query, **force, points, samples);
  ASSERT_TRUE(probe.find_seat(on_edge()));
  const guard::SeatObject seat = probe.seat().objects()[0];
  Random random(24);
  int felt = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Pose at = on_edge(-uniform(random, 0, 0.4) * kS);
    at.position_m.x += uniform(random, -1, 1) * kS;
    at.orientation = coupling::rotation_by(uniform(random, 0, 0.4) * random_direction(random));
    probe.open_seat(true);
    probe.query_pose(at, contacts);
    std::vector<float> own(points.count);
    for (std::uint32_t i = 0; i < points.count; ++i) {
      own[i] = seat.contact_m - static_cast<float>(voxmap.header().zero_force_m) -
               samples.from_zero_force_m[i];
    }
    const std::vector<float> expected =
        depths_between(points, samples, static_cast<float>(voxmap.header().zero_force_m),
                       static_cast<float>(2 * shell.header().covering_radius_m), seat, own);
    for (std::uint32_t i = 0; i < points.count; ++i) {
      ASSERT_NEAR(std::max(0.0f, contacts.depth_m[i]), std::max(0.0f, expected[i]), 1e-5 * kS)
          << "trial " << trial << ", point " << points.index[i];
      felt += expected[i] > 0 && expected[i] > own[i] ? 1 : 0;
    }
  }
  EXPECT_GT(felt, 200);
}

// The twin is the look-up of a frame.
TEST(Seat, TheQuickLookUpBarsWhatLiesBetweenPoints) {
  const Voxmap voxmap = make_voxmap(ridge_with_distances());
  const Pshell shell = make_pshell(sparse_block());
  const auto force = field::make_force_field(Model::kDefault, ForceKind::kDistance, voxmap);
  ASSERT_TRUE(force);
  query::ContactQuery query(voxmap, shell);
  query::CollectedPoints points;
  field::FieldSamples samples;
  field::ContactSet contacts;
  points.reserve(shell.view().point_count), samples.reserve(shell.view().point_count);
  contacts.reserve(shell.view().point_count);
  guard::PoseGuard probe(query, **force, points, samples);
  ASSERT_TRUE(probe.find_seat(on_edge()));
  probe.open_seat(true);
  const guard::SeatObject seat = probe.seat().objects()[0];
  const auto zero_force_m = static_cast<float>(voxmap.header().zero_force_m);
  Random random(26);
  int free = 0, between_alone = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Pose at = on_edge(-uniform(random, 0, 0.6) * kS);
    at.position_m.x += uniform(random, -1, 1) * kS;
    at.orientation = coupling::rotation_by(uniform(random, 0, 0.4) * random_direction(random));
    probe.query_pose(at, contacts);
    bool is_barred = false, by_points = false;
    for (std::uint32_t i = 0; i < contacts.count; ++i) {
      is_barred = is_barred || contacts.is_barred[i] != 0;
      by_points = by_points || zero_force_m + samples.from_zero_force_m[i] <
                                   std::max(seat.floor_m, seat.corner_floor_m);
    }
    free += is_barred ? 0 : 1;
    between_alone += is_barred && !by_points ? 1 : 0;
    ASSERT_EQ(probe.is_pushed_into_seat(at, {}), is_barred) << trial;
  }
  EXPECT_GT(free, 100);
  EXPECT_GT(between_alone, 100);
}

TEST(Seat, NeighborsAreAllPairsWithinTheDistance) {
  Random random(25);
  PointPart part = sparse_block();
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 p = 0.005 * random_direction(random);
    part.add({p.x, p.y, p.z}, {0, 0, 1});
  }
  const Pshell shell = make_pshell(part);
  const PshellView& view = shell.view();
  const auto point = [&](std::uint64_t i) { return glm::vec3(view.x[i], view.y[i], view.z[i]); };
  for (const float distance_m : {0.0003f, 0.001f}) {
    const query::ShellNeighbors neighbors(view, double{distance_m});
    for (std::uint32_t i = 0; i < view.point_count; ++i) {
      std::set<std::uint32_t> expected;
      for (std::uint32_t j = i + 1; j < view.point_count; ++j) {
        if (glm::length(point(j) - point(i)) <= distance_m) expected.insert(j);
      }
      const auto found = neighbors.after(i);
      ASSERT_LE(expected.size(), query::ShellNeighbors::kMax);
      EXPECT_EQ(std::set<std::uint32_t>(found.begin(), found.end()), expected) << i;
    }
  }
}

TEST(Seat, ARecordingHasIt) {
  SeatedBlock bench(floor_with_distances());
  ASSERT_TRUE(bench.begun);
  const ScratchFolder folder;
  auto writer = stream::RecordingWriter::create(folder / "run.flr");
  ASSERT_TRUE(writer);
  writer->begin(stream::describe_run(*bench.simulation, bench.state, {}));
  ASSERT_TRUE(writer->finish(0));
  const auto recording = stream::Recording::open(folder / "run.flr");
  ASSERT_TRUE(recording) << to_line(recording.error());
  EXPECT_EQ(recording->run().start.seat, kSeatOpen);
  ASSERT_TRUE(recording->run().world_from_seat);
  EXPECT_EQ(recording->run().world_from_seat->position_m,
            bench.begun->world_from_center.position_m);
}

}  // namespace
}  // namespace forcelayer::test
