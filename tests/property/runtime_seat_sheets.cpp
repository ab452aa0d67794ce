// A point of a seated part that wanders at random about a sheet or a thin wall, at random against
// the voxels, with an inward normal up to 80 degrees aside of the wall's, or without an inside. The
// truth is known by construction: the guard bars the point where it goes through, and only there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "runtime/guard/pose_guard.h"
#include "tests/support/distance_scene.h"
#include "tests/support/motion_bench.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005, kFar = 1e9;
// In voxels, from the middle of a wall: a point is through from there on; one that is barred before
// this, on its own side, is barred falsely. A point without an inside is held off the middle.
constexpr double kThrough = -0.12, kClear = 0.02, kClearWithoutInside = 0.14;
constexpr double kLeg = 0.2;  // its far face is so far from its near one

// Its middle is the plane z = 0 of its own axes, in voxels, where x is below `end`.
struct Wall {
  Pose at;
  double thickness = 0, end = kFar;
  double radius =
      0;  // not 0: a tube of it about the line y = 0, z = -radius, in place of the plane

  glm::dvec3 across(const glm::dvec3& world_m) const {
    const glm::dvec3 p = glm::conjugate(at.orientation) * (world_m - at.position_m) / kS;
    return at.orientation *
           (radius == 0 ? glm::dvec3(0, 0, 1) : glm::normalize(glm::dvec3(0, p.y, p.z + radius)));
  }
  glm::dvec3 local(const glm::dvec3& world_m) const {
    glm::dvec3 p = glm::conjugate(at.orientation) * (world_m - at.position_m) / kS;
    if (radius > 0) p.z = std::hypot(p.y, p.z + radius) - radius;
    return p;
  }
  double distance(const glm::dvec3& world_m) const {
    const glm::dvec3 p = local(world_m);
    const double off = std::abs(p.z) - 0.5 * thickness, beyond = p.x - end;
    return std::hypot(std::max(off, 0.0), std::max(beyond, 0.0)) +
           std::min(0.0, std::max(off, beyond));
  }
  // 1 or -1; 0 beyond the end.
  int side_of(const glm::dvec3& world_m) const {
    const glm::dvec3 p = local(world_m);
    return p.x >= end ? 0 : p.z > 0 ? 1 : -1;
  }
};

using Walls = std::vector<Wall>;

double distance(const Walls& walls, const glm::dvec3& world_m) {
  double least = kFar;
  for (const Wall& wall : walls) least = std::min(least, wall.distance(world_m));
  return least;
}

Wall random_wall(Random& random) {
  Wall wall;
  for (int axis = 0; axis < 3; ++axis) wall.at.position_m[axis] = uniform(random, -0.5, 0.5) * kS;
  if (integer(random, 0, 4) > 0) wall.at.orientation = random_orientation(random);
  return wall;
}
double random_thickness(Random& random) { return std::pow(20, uniform(random, -1, 0)); }

struct Counts {
  int crossings = 0, steps = 0, missed = 0, false_alarms = 0;
  // The farthest from the end of a wall.
  double missed_from_end = 0, alarm_from_end = 0;
};

// The point's side of each wall, while it goes from a place to another.
struct Passage {
  std::vector<int> sides;  // at the end
  double deepest = kFar;   // height over a wall on the point's own side
  double from_end = kFar;  // the end of a wall is so near
};

Passage pass(const Walls& walls, const std::vector<int>& sides, const glm::dvec3& from_m,
             const glm::dvec3& to_m) {
  Passage out;
  for (std::size_t n = 0; n < walls.size(); ++n) {
    const glm::dvec3 a = walls[n].local(from_m), b = walls[n].local(to_m);
    const double end = walls[n].end;
    out.from_end = std::min(out.from_end, std::abs(end - b.x));
    const bool over_a = a.x < end, over_b = b.x < end;
    const double at_end = over_a == over_b ? 0 : a.z + (b.z - a.z) * (end - a.x) / (b.x - a.x);
    const int side = over_a ? sides[n] : at_end > 0 ? 1 : -1;
    out.sides.push_back(over_b ? side : 0);
    if (over_a || over_b) out.deepest = std::min(out.deepest, side * (over_b ? b.z : at_end));
  }
  return out;
}

// Whose point it is: a face before the wall, with a normal within 80 degrees of the direction to
// the point's side of each wall; one that lies flush; the far face of a thin leg; an open sheet.
enum class Of { kFace, kFlushFace, kFarFace, kSheet };

glm::dvec3 random_normal(Random& random, const Walls& walls, const std::vector<int>& sides,
                         const glm::dvec3& at_m, Of of) {
  const double alike = of == Of::kFlushFace ? 0.97 : 0.174;
  while (true) {
    const glm::dvec3 normal = random_direction(random);
    bool is_in = true;
    for (std::size_t n = 0; n < walls.size(); ++n) {
      is_in &= sides[n] == 0 || sides[n] * glm::dot(normal, walls[n].across(at_m)) > alike;
    }
    if (is_in) return of == Of::kFarFace ? -normal : normal;
  }
}

struct Wanderer {
  Wanderer(const Voxmap& voxmap, const field::ForceField& force, const PointPart& part)
      : shell(make_pshell(part)), query(voxmap, shell) {
    points.reserve(1), samples.reserve(1), here.reserve(1), there.reserve(1);
    guard.emplace(query, force, points, samples);
  }

  Pshell shell;
  query::ContactQuery query;
  query::CollectedPoints points;
  field::FieldSamples samples;
  field::ContactSet here, there;
  std::optional<guard::PoseGuard> guard;
};

void wander(Random& random, const Walls& walls, Of of, Counts& counts) {
  const Voxmap voxmap = make_voxmap(distance_scene(
      kS, {-12, -12, -12}, {24, 24, 24},
      [&](const glm::dvec3& world_m) { return kS * distance(walls, world_m); }, 2,
      DistanceDefinition(2)));
  const auto force = field::make_force_field(Model::kDefault, ForceKind::kDistance, voxmap);
  ASSERT_TRUE(force);
  const bool ends = walls[0].end < kFar;
  for (int number = 0; number < 12; ++number) {
    glm::dvec3 at_m(0);
    do {
      const glm::dvec3 local(ends ? uniform(random, -4, 1.5) : uniform(random, -2, 2),
                             uniform(random, -2, 2), uniform(random, -1.5, 1.5));
      at_m = walls[0].at.position_m + walls[0].at.orientation * (local * kS);
    } while (distance(walls, at_m) < 0.3);
    std::vector<int> sides;
    for (const Wall& wall : walls) sides.push_back(wall.side_of(at_m));
    const glm::dvec3 normal = random_normal(random, walls, sides, at_m, of);
    PointPart part;
    part.two_sided = of == Of::kSheet;
    part.add({0, 0, 0}, {normal.x, normal.y, normal.z});
    Wanderer point(voxmap, **force, part);
    const auto pose = [](const glm::dvec3& world_m) { return Pose{world_m, {1, 0, 0, 0}}; };
    if (!point.guard->find_seat(pose(at_m)) || point.guard->seat().empty()) continue;
    point.guard->open_seat(true);
    point.guard->query_pose(pose(at_m), point.here);
    const double speed = 0.45 * std::pow(0.03, uniform(random, 0, 1));
    for (int step = 0; step < 80; ++step) {
      glm::dvec3 way = random_direction(random);
      if (step % 4 != 0) {  // rather to the nearest wall than elsewhere
        const auto n = static_cast<std::size_t>(
            std::ranges::min_element(walls, {}, [&](const Wall& w) { return w.distance(at_m); }) -
            walls.begin());
        way = glm::normalize(0.9 * way - double(sides[n]) * walls[n].across(at_m));
      }
      const glm::dvec3 to_m = at_m + speed * uniform(random, 0.2, 1) * kS * way;
      point.guard->query_pose(pose(to_m), point.there);
      point.guard->mark_crossings(point.here, glm::vec3(to_m - at_m), point.there);
      if (point.there.count == 0) break;
      const std::uint8_t barred = point.there.is_barred[0];
      const Passage passage = pass(walls, sides, at_m, to_m);
      // Where a far face comes, the face before it has gone through.
      if (of == Of::kFarFace && passage.deepest < kLeg) continue;
      ++counts.steps;
      const bool through = passage.deepest < kThrough;
      counts.crossings += through;
      if (through && barred == 0) {
        ++counts.missed;
        counts.missed_from_end = std::max(counts.missed_from_end, passage.from_end);
        continue;
      }
      if (barred == field::ContactSet::kCrossed &&
          passage.deepest > (of == Of::kSheet ? kClearWithoutInside : kClear)) {
        ++counts.false_alarms;
        counts.alarm_from_end = std::max(counts.alarm_from_end, passage.from_end);
      }
      if (barred != 0) continue;
      at_m = to_m, sides = passage.sides;
      std::swap(point.here, point.there);
      if (distance(walls, at_m) > 2) break;
    }
  }
}

void report(const Counts& counts) {
  std::printf("%d of %d steps lead through, %d are missed; %d alarms are false\n", counts.crossings,
              counts.steps, counts.missed, counts.false_alarms);
}

TEST(SeatSheets, NoPointGoesThroughASheetOrAThinWall) {
  for (const Of of : {Of::kFace, Of::kSheet}) {
    for (const bool is_sheet : {true, false}) {
      SCOPED_TRACE(testing::Message() << (is_sheet ? "a sheet" : "a wall")
                                      << (of == Of::kSheet ? ", without an inside" : ""));
      Random random(is_sheet ? 20261129 : 20261130);
      Counts counts;
      for (int number = 0; number < 60; ++number) {
        Wall wall = random_wall(random);
        if (!is_sheet) wall.thickness = random_thickness(random);
        wander(random, {wall}, of, counts);
      }
      report(counts);
      EXPECT_EQ(counts.missed, 0);
      EXPECT_EQ(counts.false_alarms, 0);
      EXPECT_GT(counts.crossings, 300);
    }
  }
}

// A thin leg slides along a wall, and away from it.
TEST(SeatSheets, TheFarFaceOfALegIsFree) {
  Random random(20261134);
  Counts counts;
  for (int number = 0; number < 30; ++number) {
    Wall wall = random_wall(random);
    if (number % 2 == 1) wall.thickness = random_thickness(random);
    wander(random, {wall}, Of::kFarFace, counts);
  }
  report(counts);
  EXPECT_EQ(counts.false_alarms, 0);
  EXPECT_GT(counts.steps, 10000);
}

// A tube's wall is not flat, and the normal of a flush point tells its side.
TEST(SeatSheets, NoFlushPointGoesThroughACurvedSheet) {
  Random random(20261135);
  Counts counts;
  for (int number = 0; number < 60; ++number) {
    Wall wall = random_wall(random);
    wall.radius = uniform(random, 8, 20);
    wander(random, {wall}, Of::kFlushFace, counts);
  }
  report(counts);
  EXPECT_EQ(counts.missed, 0);
  EXPECT_EQ(counts.false_alarms, 0);
}

// Near its end a wall cannot always be told. The cells that are looked at reach 2.6 voxels from the
// middle of the point's cell.
constexpr double kNearEnd = 3;

TEST(SeatSheets, APointGoesRoundTheEnd) {
  for (const bool is_sheet : {true, false}) {
    SCOPED_TRACE(is_sheet ? "a sheet" : "a wall");
    Random random(is_sheet ? 20261131 : 20261132);
    Counts counts;
    for (int number = 0; number < 60; ++number) {
      Wall wall = random_wall(random);
      wall.end = 0;
      if (!is_sheet) wall.thickness = random_thickness(random);
      wander(random, {wall}, Of::kFace, counts);
    }
    report(counts);
    EXPECT_LT(counts.missed_from_end, kNearEnd);
    EXPECT_LT(counts.alarm_from_end, kNearEnd);
    EXPECT_LT(counts.false_alarms, 0.002 * counts.steps);
  }
}

TEST(SeatSheets, APointStaysInACornerOfSheets) {
  Random random(20261133);
  Counts counts;
  for (int number = 0; number < 60; ++number) {
    Walls walls(2, random_wall(random));
    for (Wall& wall : walls) wall.end = 0;
    const double angle_rad = uniform(random, 50, 150) * M_PI / 180;
    walls[1].at.orientation = walls[0].at.orientation * coupling::rotation_by({0, angle_rad, 0});
    wander(random, walls, Of::kFace, counts);
  }
  report(counts);
  EXPECT_LT(counts.missed_from_end, kNearEnd);
  EXPECT_LT(counts.alarm_from_end, kNearEnd);
  EXPECT_LT(counts.false_alarms, 0.002 * counts.steps);
}

}  // namespace
}  // namespace forcelayer::test
