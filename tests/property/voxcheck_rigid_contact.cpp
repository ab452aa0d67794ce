// The truth that felt forces are judged by, on contacts with a closed formula.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "tests/stress/shapes.h"
#include "tests/support/mesh_gaps.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rigid_contact.h"
#include "workbench/exact/triangle_distance.h"

namespace forcelayer::test {
namespace {

constexpr double kStandoffM = 0.01, kReachM = 0.01;
const glm::dvec3 kHalfM{0.03, 0.02, 0.01};
const glm::dquat kLevel{1, 0, 0, 0};

HeldPart held_at(const glm::dvec3& hand_m, const glm::dquat& turn = kLevel) {
  return {{1000, 15}, {3, 0.1}, hand_m, turn, glm::dvec3(0), glm::length(kHalfM)};
}

// The least energy of the meshes' contact, whose own conditions hold.
RigidContact solved(const HeldPart& held, const mesh::Mesh& scene, const mesh::Mesh& part,
                    const Pose& start) {
  MeshGaps gaps_at(scene, part, kStandoffM, kReachM);
  const RigidContact found = rigid_contact(held, std::ref(gaps_at), start);
  EXPECT_LT(found.too_near_m, 1e-8);
  EXPECT_LT(found.unbalanced_n, 1e-4);
  return found;
}

void expect_near(const glm::dvec3& value, const glm::dvec3& wanted, double within) {
  EXPECT_LT(glm::length(value - wanted), within)
      << value.x << " " << value.y << " " << value.z << " is not " << wanted.x << " " << wanted.y
      << " " << wanted.z;
}

mesh::Mesh floor_mesh() { return stress::sheet(0.3, 0.3); }

mesh::Mesh turned(const mesh::Mesh& mesh, const glm::dquat& turn) {
  mesh::Mesh result;
  stress::append(result, mesh, {glm::dvec3(0), turn});
  return result;
}

TEST(RigidContact, ASphereOnAPlaneIsPushedByTheStretchOfTheSpring) {
  // A corner of the faceted sphere is its lowest point.
  const double radius_m = 0.02;
  const HeldPart held = held_at({0.001, 0.002, kStandoffM + radius_m - 0.007});
  const RigidContact found = solved(held, floor_mesh(), stress::sphere(radius_m, 48),
                                    {{0, 0, kStandoffM + radius_m - 0.001}, kLevel});
  expect_near(found.on_hand.force_n, {0, 0, 7}, 1e-5);
  expect_near(found.on_hand.torque_nm, {0, 0, 0}, 1e-7);
  expect_near(found.world_from_center.position_m, {0.001, 0.002, kStandoffM + radius_m}, 1e-8);
}

TEST(RigidContact, APressBeyondTheLimitIsFeltWithTheLimit) {
  const HeldPart held = held_at({0, 0, kStandoffM + kHalfM.z - 0.05});
  const RigidContact found =
      solved(held, floor_mesh(), stress::box(kHalfM), {{0, 0, kStandoffM + kHalfM.z}, kLevel});
  expect_near(found.on_hand.force_n, {0, 0, 15}, 1e-5);
}

TEST(RigidContact, AFaceOnAPlaneTakesATorqueUpToItsEdgeThenTilts) {
  // Force F at the middle of the face, torque T: the push lies T / F off, inside the face.
  const double press_m = 0.008, turn_rad = 0.02;
  const HeldPart flat =
      held_at({0, 0, kStandoffM + kHalfM.z - press_m}, coupling::rotation_by({0, turn_rad, 0}));
  const RigidContact lies = solved(flat, floor_mesh(), stress::box(kHalfM),
                                   {{0, 0, kStandoffM + kHalfM.z - 0.001}, kLevel});
  expect_near(lies.on_hand.force_n, {0, 0, 8}, 1e-5);
  expect_near(lies.on_hand.torque_nm, {0, -3 * turn_rad, 0}, 1e-5);
  // Little force: it stands on its edge, at the angle a at which the spring's torque is that of the
  // force about the edge: k_R (turn - a) = F (x cos a - z sin a).
  const double weak_m = 0.001;
  const HeldPart tilting =
      held_at({0, 0, kStandoffM + kHalfM.z - weak_m}, coupling::rotation_by({0, turn_rad, 0}));
  const RigidContact tilted =
      solved(tilting, floor_mesh(), stress::box(kHalfM), {{0, 0, kStandoffM + kHalfM.z}, kLevel});
  double low = 0, high = turn_rad;
  const auto height_m = [](double a) { return kHalfM.x * std::sin(a) + kHalfM.z * std::cos(a); };
  const auto force_n = [&](double a) { return 1000 * (height_m(a) - kHalfM.z + weak_m); };
  for (int i = 0; i < 60; ++i) {
    const double a = (low + high) / 2;
    const double arm_m = kHalfM.x * std::cos(a) - kHalfM.z * std::sin(a);
    (3 * (turn_rad - a) > force_n(a) * arm_m ? low : high) = a;
  }
  EXPECT_GT(low, 0.001);
  expect_near(tilted.on_hand.force_n, {0, 0, force_n(low)}, 1e-4);
  expect_near(tilted.on_hand.torque_nm, {0, -3 * (turn_rad - low), 0}, 1e-5);
}

// Two slopes at right angles, any way up: a push of each takes its part of the stretch.
TEST(RigidContact, ABoxInACornerAndASphereInAWedgeAreHeldByEveryWall) {
  Random random(20261128);
  for (int i = 0; i < 3; ++i) {
    const glm::dquat way = coupling::rotation_by(2.0 * random_direction(random));
    mesh::Mesh corner;
    stress::append(corner, floor_mesh());
    stress::append(corner, floor_mesh(), {{0, 0, 0}, coupling::rotation_by({0, M_PI / 2, 0})});
    stress::append(corner, floor_mesh(), {{0, 0, 0}, coupling::rotation_by({M_PI / 2, 0, 0})});
    const glm::dvec3 at = kStandoffM + kHalfM, stretch{-0.004, -0.003, -0.007};
    const HeldPart in_corner = held_at(way * (at + stretch), way);
    const RigidContact box = solved(in_corner, turned(corner, way), stress::box(kHalfM),
                                    {way * (at + glm::dvec3(-0.001, 0.001, 0)), way});
    expect_near(box.on_hand.force_n, way * (-1000.0 * stretch), 1e-4);

    // A wedge of 60 degrees, along y; the ball's stretch along it stays its own.
    mesh::Mesh wedge;
    for (const double side : {1.0, -1.0}) {
      stress::append(wedge, floor_mesh(),
                     {{0, 0, 0}, coupling::rotation_by({0, side * M_PI / 3, 0})});
    }
    const double radius_m = 0.02;
    const double height_m = (kStandoffM + radius_m) / std::sin(M_PI / 6);
    const HeldPart in_wedge = held_at(way * glm::dvec3(0.001, 0.004, height_m - 0.006), way);
    const RigidContact ball = solved(in_wedge, turned(wedge, way), stress::sphere(radius_m, 120),
                                     {way * glm::dvec3(0, 0, height_m + 0.0005), way});
    // Its facets lie at most r (1 - cos(pi/120)) inside the ball, and a wedge doubles that.
    const double off_n = 1000 * 2 * radius_m * (1 - std::cos(M_PI / 120));
    expect_near(ball.on_hand.force_n, way * glm::dvec3(-1, 0, 6), 1.5 * off_n + 1e-4);
  }
}

// Edge across edge: one push, along the common normal, whose torque is about the grip.
TEST(RigidContact, AnEdgeAcrossAnEdgePushesWhereTheyCross) {
  mesh::Mesh ridge;
  const glm::dvec3 bar{0.1, 0.01, 0.01};
  stress::append(ridge, stress::box(bar),
                 {{0, 0, -bar.z * std::sqrt(2.0)}, coupling::rotation_by({M_PI / 4, 0, 0})});
  mesh::Mesh part;
  stress::append(part, stress::box({0.01, 0.1, 0.01}),
                 {{0, 0, 0.01 * std::sqrt(2.0)}, coupling::rotation_by({0, M_PI / 4, 0})});
  // The hand holds it beside where it rests, and keeps it level.
  HeldPart held = held_at({0, 0.01, kStandoffM - 0.002});
  held.grip_m = {0, 0.01, 0};
  held.angular = {100, 10};
  held.radius_m = 0.1;
  const RigidContact found = solved(held, ridge, part, {{0, 0, kStandoffM}, kLevel});
  // It turns by -a about x, in which grip and edge lie level: F = k (2 mm - 10 mm a), k_R a = F 10
  // mm.
  const double turn = 1000 * 0.002 * 0.01 / (100 + 1000 * 0.01 * 0.01);
  expect_near(found.on_hand.force_n, {0, 0, 1000 * (0.002 - 0.01 * turn)}, 2e-3);
  expect_near(found.on_hand.torque_nm, {-100 * turn, 0, 0}, 1e-5);
}

// The twin of the gaps: the least of all pairs of triangles, one by one, less the standoff.
double least_gap_m(const mesh::Mesh& scene, const mesh::Mesh& part, const Pose& pose,
                   double standoff_m) {
  double least_m = 1e300;
  for (const mesh::Triangle& a : scene.triangles) {
    for (const mesh::Triangle& b : part.triangles) {
      exact::Corners first, second;
      for (std::size_t n = 0; n < 3; ++n) {
        const mesh::Vec3d &v = scene.vertices[a[n]], &w = part.vertices[b[n]];
        first[n] = {v[0], v[1], v[2]};
        second[n] = pose.orientation * glm::dvec3(w[0], w[1], w[2]) + pose.position_m;
      }
      least_m = std::min(least_m, exact::triangle_distance(first, second).distance_m);
    }
  }
  return least_m - standoff_m;
}

void expect_least(MeshGaps& gaps_at, const Pose& pose, double reach_m, double wanted_m) {
  double found_m = reach_m;
  for (const Gap& gap : gaps_at(pose)) found_m = std::min(found_m, gap.gap_m);
  ASSERT_NEAR(found_m, std::min(reach_m, wanted_m), 1e-12);
}

TEST(MeshGaps, TheLeastIsTheDistanceOfAllTriangles) {
  constexpr double kStandoff = 0.005, kReach = 0.02;
  Random random(20261129);
  const mesh::Mesh scene = stress::sphere(0.05, 16), part = stress::box(kHalfM);
  MeshGaps gaps_at(scene, part, kStandoff, kReach);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const double out_m = uniform(random, 0.088, 0.1), turn = uniform(random, 0, 3);
    const glm::dvec3 direction = random_direction(random), axis = random_direction(random);
    const Pose pose{out_m * direction, coupling::rotation_by(turn * axis)};
    ASSERT_NO_FATAL_FAILURE(
        expect_least(gaps_at, pose, kReach, least_gap_m(scene, part, pose, kStandoff)));
  }
}

// Far features are not searched again until the part has gone as far: at the end of a way in small
// steps they are near.
TEST(MeshGaps, TheLeastStaysThatOfAllTrianglesOverSmallSteps) {
  constexpr double kStandoff = 0.005, kReach = 0.0003;
  Random random(20261130);
  const mesh::Mesh scene = stress::sphere(0.05, 12), part = stress::box(kHalfM);
  for (int way = 0; way < 8; ++way) {
    MeshGaps gaps_at(scene, part, kStandoff, kReach);
    const glm::dvec3 from = random_direction(random), axis = random_direction(random);
    const double spin_radpm = uniform(random, 0, 30);
    int near = 0;
    for (double out_m = 0.11; near < 5; out_m -= 0.0007) {
      SCOPED_TRACE(out_m);
      const Pose pose{out_m * from, coupling::rotation_by(spin_radpm * out_m * axis)};
      const double wanted_m = least_gap_m(scene, part, pose, kStandoff);
      ASSERT_NO_FATAL_FAILURE(expect_least(gaps_at, pose, kReach, wanted_m));
      near += wanted_m < kReach ? 1 : 0;
    }
  }
}

// Where a part is points alone, each has its own gap, and nothing lies between them: over the
// middle of a face of the box, its corners are farther from a ball than the face is.
TEST(MeshGaps, OfPointsAreThoseOfEachPoint) {
  constexpr double kStandoff = 0.005, kReach = 0.02;
  Random random(20261201);
  const mesh::Mesh scene = stress::sphere(0.05, 16), box = stress::box(kHalfM);
  std::vector<glm::dvec3> corners_m;
  mesh::Mesh corners;  // a triangle without extent at each
  for (const mesh::Vec3d& v : box.vertices) {
    const auto at = static_cast<std::uint32_t>(corners_m.size());
    corners_m.emplace_back(v[0], v[1], v[2]);
    corners.vertices.push_back(v);
    corners.triangles.push_back({at, at, at});
  }
  MeshGaps gaps_at(scene, corners_m, kStandoff, kReach);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const double out_m = uniform(random, 0.07, 0.1), turn = uniform(random, 0, 3);
    const glm::dvec3 direction = random_direction(random), axis = random_direction(random);
    const Pose pose{out_m * direction, coupling::rotation_by(turn * axis)};
    ASSERT_NO_FATAL_FAILURE(
        expect_least(gaps_at, pose, kReach, least_gap_m(scene, corners, pose, kStandoff)));
  }
  const Pose over{{0, 0, 0.05 + kHalfM.z + kStandoff}, kLevel};
  EXPECT_GT(least_gap_m(scene, corners, over, kStandoff), 0.005);
  for (const Gap& gap : gaps_at(over)) EXPECT_GT(gap.gap_m, 0.005);
}

}  // namespace
}  // namespace forcelayer::test
