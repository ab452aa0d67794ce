// How deep two meshes go into each other, against slow twins: every triangle in long double, at
// places sampled densely, at moments sampled densely.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <tuple>
#include <utility>

#include "pointshell/certificate/ray_winding.h"
#include "pointshell/certificate/winding_number.h"
#include "tests/support/ring_surface.h"
#include "workbench/exact/motion_proof.h"
#include "workbench/exact/push_out.h"
#include "workbench/exact/seat_walk.h"

namespace forcelayer::exact {
namespace {

using Wide = glm::vec<3, long double>;
using Corners = std::array<Wide, 3>;

constexpr double kWithin = 0.01;

// A convex body: faces about the origin as triangle fans, outwards.
Surface box(const glm::dvec3& half_m) {
  Surface surface;
  for (int n = 0; n < 8; ++n) {
    surface.vertices_m.push_back(half_m *
                                 glm::dvec3(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1));
  }
  surface.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  surface.object.assign(surface.triangles.size(), 1);
  return surface;
}

// A prism of some sides along z.
Surface prism(int sides, double radius_m, double half_m) {
  Surface surface = test::ring_surface(sides, radius_m, half_m);
  for (std::uint32_t a = 2; a + 2 < surface.vertices_m.size(); a += 2) {
    surface.triangles.push_back({0, a + 2, a});
    surface.triangles.push_back({1, a + 1, a + 3});
  }
  surface.object.assign(surface.triangles.size(), 1);
  return surface;
}

// A prism of some sides with a hole of as many along z.
Surface tube(int sides, double hole_m, double radius_m, double half_m) {
  Surface surface;
  for (int n = 0; n < sides; ++n) {
    const double turn = 2 * std::numbers::pi * n / sides;
    for (const double r : {hole_m, radius_m}) {
      for (const double z : {-half_m, half_m}) {
        surface.vertices_m.push_back({r * std::cos(turn), r * std::sin(turn), z});
      }
    }
  }
  const auto count = static_cast<std::uint32_t>(4 * sides);
  for (std::uint32_t a = 0; a < count; a += 4) {
    const std::uint32_t b = (a + 4) % count;
    const auto quad = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r, std::uint32_t s) {
      surface.triangles.push_back({p, q, r});
      surface.triangles.push_back({p, r, s});
    };
    quad(a, a + 1, b + 1, b);          // the hole
    quad(a + 2, b + 2, b + 3, a + 3);  // outside
    quad(a, b, b + 2, a + 2);          // the ends
    quad(a + 1, a + 3, b + 3, b + 1);
  }
  surface.object.assign(surface.triangles.size(), 1);
  return surface;
}

Surface united(Surface a, const Surface& b, const glm::dvec3& at_m) {
  const auto first = static_cast<std::uint32_t>(a.vertices_m.size());
  for (const glm::dvec3& v : b.vertices_m) a.vertices_m.push_back(v + at_m);
  for (const mesh::Triangle& t : b.triangles) {
    a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    a.object.push_back(2);
  }
  return a;
}

std::vector<Corners> placed(const Surface& surface, const Pose& pose, std::uint32_t object) {
  std::vector<Corners> all;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (object != 0 && surface.object[t] != object) continue;
    Corners corners;
    for (std::size_t n = 0; n < 3; ++n) {
      corners[n] =
          Wide(pose.position_m + pose.orientation * surface.vertices_m[surface.triangles[t][n]]);
    }
    all.push_back(corners);
  }
  return all;
}

long double to_segment(const Wide& p, const Wide& a, const Wide& b) {
  const Wide d = b - a;
  const long double t = std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0L, 1.0L);
  return glm::length(p - a - t * d);
}

long double to_triangle(const Wide& p, const Corners& t) {
  const Wide normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  bool inside = true;
  long double smallest = 1e30L;
  for (int n = 0; n < 3; ++n) {
    const Wide &a = t[n], &b = t[(n + 1) % 3];
    inside = inside && glm::dot(glm::cross(normal, b - a), p - a) >= 0;
    smallest = std::min(smallest, to_segment(p, a, b));
  }
  return inside ? std::abs(glm::dot(normal, p - t[0])) / glm::length(normal) : smallest;
}

// The distance of a place from a closed body's triangles, negative outside, by their solid angles.
long double depth_in(const Wide& p, const std::vector<Corners>& body) {
  long double winding = 0, smallest = 1e30L;
  for (const Corners& t : body) {
    const Wide a = t[0] - p, b = t[1] - p, c = t[2] - p;
    const long double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    winding += 2 * std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc +
                                                                 glm::dot(b, c) * la +
                                                                 glm::dot(c, a) * lb);
    smallest = std::min(smallest, to_triangle(p, t));
  }
  return std::abs(winding) > 2 * std::numbers::pi_v<long double> ? smallest : -smallest;
}

// The deepest of the places of a triangle lattice on a surface.
long double sampled_depth(const std::vector<Corners>& surface, const std::vector<Corners>& body,
                          int steps) {
  long double deepest = -1e30L;
  for (const Corners& t : surface) {
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const long double u = static_cast<long double>(i) / steps,
                          v = static_cast<long double>(j) / steps;
        deepest = std::max(deepest, depth_in(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]), body));
      }
    }
  }
  return deepest;
}

long double sampled_both(const Surface& part, const Surface& object, const Pose& pose, int steps) {
  long double deepest = -1e30L;
  for (std::uint32_t body = 1;
       body <= *std::max_element(object.object.begin(), object.object.end()); ++body) {
    const auto a = placed(part, pose, 0), b = placed(object, {}, body);
    deepest = std::max({deepest, sampled_depth(a, b, steps), sampled_depth(b, a, steps)});
  }
  return deepest;
}

bool is_crossed(const Corners& t, const Wide& from, const Wide& to) {
  const Wide normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const long double a = glm::dot(normal, from - t[0]), b = glm::dot(normal, to - t[0]);
  if ((a > 0) == (b > 0)) return false;
  const Wide p = from + a / (a - b) * (to - from);
  for (int n = 0; n < 3; ++n) {
    if (glm::dot(glm::cross(normal, t[(n + 1) % 3] - t[n]), p - t[n]) < 0) return false;
  }
  return true;
}

bool meet(const Corners& a, const Corners& b) {
  for (int n = 0; n < 3; ++n) {
    if (is_crossed(a, b[n], b[(n + 1) % 3]) || is_crossed(b, a[n], a[(n + 1) % 3])) return true;
  }
  return false;
}

Surface random_body(std::mt19937& random) {
  std::uniform_real_distribution<double> size(0.2, 1);
  if (std::uniform_int_distribution<int>(0, 1)(random) == 0) {
    return box({size(random), size(random), size(random)});
  }
  return prism(std::uniform_int_distribution<int>(3, 12)(random), size(random), size(random));
}

Pose random_pose(std::mt19937& random, double away_m) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Pose pose;
  pose.position_m = away_m * glm::dvec3(unit(random), unit(random), unit(random));
  pose.orientation =
      glm::normalize(glm::dquat(unit(random), unit(random), unit(random), unit(random)));
  return pose;
}

PathRow row_of(double time_s, const Pose& pose) {
  const auto& p = pose.position_m;
  const auto& q = pose.orientation;
  return {time_s, {p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
}

TEST(SeatDepth, IsThatOfTheDeepestPlaceOfEitherSurface) {
  std::mt19937 random(26);
  int deep = 0;
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    const Surface part = random_body(random);
    Surface object = random_body(random);
    if (trial % 3 == 0) object = united(object, random_body(random), {0.7, 0.2, 0});
    const Bodies of_part = bodies_of(part, kWithin), of_object = bodies_of(object, kWithin);
    ASSERT_TRUE(are_solid(of_part) && are_solid(of_object));
    const MeshPair distance(object, part);
    const clearance::CenterPath path({{row_of(0, {})}}, {0, 0, 0}, 2);
    const SeatWalk walk(path, of_part, of_object, distance, kWithin);
    const Pose pose = random_pose(random, 1.5);
    // The allowed depth may lie beside the true one, on either side, or far from it.
    const auto truth = static_cast<double>(sampled_both(part, object, pose, 12));
    for (const double off : {-0.5, -0.02, 0.02, 0.5}) {
      const double allowed = truth + off;
      const Depth depth = walk.at_pose(pose, allowed);
      EXPECT_LE(truth, depth.at_most_m + 1e-9);
      // One place that is deeper than allowed ends the search.
      if (depth.found_m <= allowed) {
        EXPECT_LE(depth.at_most_m,
                  depth.found_m + std::max(kWithin, allowed - depth.at_most_m) + 1e-9);
      }
      if (off < -kWithin) {
        EXPECT_GT(depth.found_m, allowed);
      }
      if (off > 0.1) {  // the truth is sampled: it is more than that
        EXPECT_LE(depth.at_most_m, allowed);
      }
      // The place is there, and so deep.
      EXPECT_NEAR(glm::length(depth.place_m - depth.foot_m), std::abs(depth.found_m), 1e-7);
      long double off_part = 1e30L, off_object = 1e30L;
      for (const Corners& t : placed(part, pose, 0))
        off_part = std::min(off_part, to_triangle(Wide(depth.place_m), t));
      for (const Corners& t : placed(object, {}, 0))
        off_object = std::min(off_object, to_triangle(Wide(depth.foot_m), t));
      EXPECT_LE(off_part, 1e-7L);
      EXPECT_LE(off_object, 1e-7L);
    }
    // Where no depth is the one that matters, it is known closely.
    const Depth depth = walk.at_pose(pose, std::nullopt);
    EXPECT_LE(truth, depth.at_most_m + 1e-9);
    EXPECT_LE(depth.at_most_m, depth.found_m + kWithin + 1e-9);
    deep += truth > 0.05;
  }
  EXPECT_GT(deep, 20);
}

// A pin that fits its bore but for a little, and leans in it. Thin pieces before its walls, and on
// them, are settled as a whole: were they cut to the width of the gap it would take a hundred times
// as many.
TEST(SeatDepth, OfAPinThatLeansInItsBoreIsFoundInFewPieces) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> unit(-1, 1);
  constexpr double kGap = 0.02, kAllowed = 0.04, kFine = 0.004;
  std::uint64_t largest = 0;
  int pressed = 0, leaning = 0;
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE(trial);
    const Surface pin = prism(16, 1, 6), bore = tube(12 + trial % 2 * 4, 1 + kGap, 2, 4);
    const Bodies of_pin = bodies_of(pin, kFine), of_bore = bodies_of(bore, kFine);
    ASSERT_TRUE(are_solid(of_pin) && are_solid(of_bore));
    const MeshPair distance(bore, pin);
    const clearance::CenterPath path({{row_of(0, {})}}, {0, 0, 0}, 7);
    const SeatWalk walk(path, of_pin, of_bore, distance, kFine);
    const glm::dvec3 turn = glm::dvec3(unit(random), unit(random), 0) * 0.01;
    const Pose pose{glm::dvec3(unit(random), unit(random), 0) * 0.02,
                    glm::normalize(glm::dquat(1, turn / 2.0))};
    const auto truth = static_cast<double>(sampled_both(pin, bore, pose, 8));
    const Depth depth = walk.at_pose(pose, kAllowed);
    EXPECT_LE(truth, depth.at_most_m + 1e-9);
    if (depth.found_m <= kAllowed) {
      EXPECT_LE(depth.at_most_m,
                depth.found_m + std::max(kFine, kAllowed - depth.at_most_m) + 1e-12);
    }
    EXPECT_GT(depth.found_m > kAllowed ? truth + 1e-9 : depth.at_most_m, depth.found_m);
    largest = std::max(largest, depth.looked_at);
    pressed += truth > kAllowed;
    leaning += truth > 0 && truth <= kAllowed;
  }
  EXPECT_LE(largest, 8000u);
  EXPECT_GT(pressed, 2);
  EXPECT_GT(leaning, 2);
}

// A long pin in a thick wall: it is as deep as half of the wall all around the middle of that,
// which is found where pieces are cut between the wall's two sides. That it is deeper than a little
// is known from one place.
TEST(SeatDepth, OfAPinAcrossAWallTakesFewPieces) {
  const Surface pin = prism(96, 5, 100), wall = box({40, 30, 5});
  const Bodies of_pin = bodies_of(pin, 1e-3), of_wall = bodies_of(wall, 1e-3);
  const MeshPair distance(wall, pin);
  const clearance::CenterPath path({{row_of(0, {})}}, {0, 0, 0}, 101);
  const SeatWalk walk(path, of_pin, of_wall, distance, 1e-3);
  const Pose pose{{1, 2, 0.3}, glm::angleAxis(0.2, glm::normalize(glm::dvec3(1, 2, 0)))};
  const Depth depth = walk.at_pose(pose, std::nullopt);
  EXPECT_LE(depth.at_most_m, 5 + 1e-3);
  EXPECT_GE(depth.found_m, 5 - 1e-3);
  EXPECT_LE(depth.looked_at, 20000u);  // 490,000 by one face alone
  const Depth deeper = walk.at_pose(pose, 0.02);
  EXPECT_GT(deeper.found_m, 0.02);
  EXPECT_GE(deeper.at_most_m, 5 - 1e-3);
  EXPECT_LE(deeper.looked_at, 1000u);
}

// A part that comes by an object, between two poses too.
TEST(SeatWalk, TellsEveryMomentAtWhichThePartIsTooDeep) {
  std::mt19937 random(27);
  int pushed = 0, free = 0, more = 0;
  for (int trial = 0; trial < 16; ++trial) {
    SCOPED_TRACE(trial);
    const Surface part = random_body(random), object = random_body(random);
    const Bodies of_part = bodies_of(part, kWithin), of_object = bodies_of(object, kWithin);
    const MeshPair distance(object, part);
    std::vector<PathRow> rows;
    for (int n = 0; n < 4; ++n) rows.push_back(row_of(n, random_pose(random, 2.6)));
    const clearance::CenterPath path(rows, {0, 0, 0}, 2);
    SeatWalk walk(path, of_part, of_object, distance, kWithin);
    const double allowed = std::uniform_real_distribution<double>(0.02, 0.3)(random);
    const auto found = walk.deeper_than({0, 0}, {3, 0}, allowed, 0.05, true);
    const auto at = [&](double time_s) {
      return static_cast<double>(
          sampled_both(part, object, path.world_from_center(path.at(time_s)), 4));
    };
    for (double time_s = 0; time_s <= 3; time_s += 0.07) {
      const bool told = std::any_of(found.begin(), found.end(), [&](const auto& stretch) {
        return path.time_s(stretch.from) <= time_s && time_s <= path.time_s(stretch.to);
      });
      if (at(time_s) > allowed) {
        EXPECT_TRUE(told) << time_s;
      }
    }
    for (const auto& stretch : found) {
      EXPECT_GT(stretch.worst.at_most_m, allowed - 0.05);  // the resolution of stretches
      EXPECT_LE(at(path.time_s(stretch.worst_at)), stretch.worst.at_most_m + 1e-9);
    }
    // The first collision that is certain ends the search, unless all are asked for.
    const auto first = walk.deeper_than({0, 0}, {3, 0}, allowed, 0.05);
    std::size_t count = 0;
    while (count < found.size() && !found[count].is_deeper) ++count;
    count = std::min(count + 1, found.size());
    ASSERT_EQ(first.size(), count);
    for (std::size_t n = 0; n < count; ++n) {
      EXPECT_EQ(path.time_s(first[n].from), path.time_s(found[n].from));
      EXPECT_EQ(path.time_s(first[n].to), path.time_s(found[n].to));
      EXPECT_EQ(first[n].worst.found_m, found[n].worst.found_m);
    }
    more += found.size() > count;
    (found.empty() ? free : pushed) += 1;
  }
  EXPECT_GT(pushed, 4);
  EXPECT_GT(free, 1);
  EXPECT_GT(more, 1);
}

// A long pin is pushed through the wall of its bore: it is about as deep as its radius all the way,
// and every moment takes long. A few are enough to say how deep it is.
TEST(SeatWalk, LooksAtFewMomentsWhereEachTakesLong) {
  const Surface pin = prism(160, 1, 20), bore = tube(160, 1.01, 20, 1);
  const Bodies of_pin = bodies_of(pin, 1e-4), of_bore = bodies_of(bore, 1e-4);
  const MeshPair distance(bore, pin);
  const glm::dquat lean = glm::angleAxis(0.01, glm::normalize(glm::dvec3(1, 2, 0)));
  const clearance::CenterPath path({{row_of(0, {{0, 0, 0}, lean}), row_of(1, {{9, 0.2, 0}, lean})}},
                                   {0, 0, 0}, 21);
  SeatWalk walk(path, of_pin, of_bore, distance, 1e-4);
  const auto found = walk.deeper_than({0, 0}, {1, 0}, 0.02, 0.01);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].is_deeper);
  EXPECT_NEAR(found[0].worst.found_m, 1, 1.0 / 64);  // half of the wall, the radius of the pin
  EXPECT_LT(walk.measured(), 45u);                   // 50 if each moment were looked at
}

// The proof by a shift holds at places sampled densely, at every moment of a motion.
TEST(PushOut, OfAHullThatComesFreeNoPlaceIsDeeper) {
  std::mt19937 random(43);
  std::uniform_real_distribution<double> unit(-1, 1);
  int free = 0, turning = 0, deep = 0;
  for (int trial = 0; trial < 500; ++trial) {
    SCOPED_TRACE(trial);
    const Surface surface = trial % 2 == 0 ? tube(12, 0.5, 1, 0.4) : random_body(random);
    const Bodies bodies = bodies_of(surface, kWithin);
    const auto triangles = placed(surface, {}, 0);
    const double size = std::pow(0.5, trial % 5), largest = 0.3 * size;
    // About a place of the surface, where most pieces come free by a little or do not.
    const Corners& near = triangles[static_cast<std::size_t>(trial) % triangles.size()];
    const glm::dvec3 center = glm::dvec3((near[0] + near[1] + near[2]) / 3.0L) +
                              0.3 * size * glm::dvec3(unit(random), unit(random), unit(random));
    // A piece that goes straight, and in half of the trials turns, often in the plane of a face.
    const auto any = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
    std::array<glm::dvec3, 3> corners_m;
    for (glm::dvec3& corner : corners_m) corner = 0.4 * size * any();
    const glm::dvec3 shift = 0.4 * size * any();
    const glm::dvec3 of_face(glm::cross(near[1] - near[0], near[2] - near[0]));
    const glm::dvec3 axis = glm::normalize(trial % 3 == 0 ? of_face : any());
    const double turn = trial % 4 < 2 ? 0 : 0.7 * std::abs(unit(random));
    const auto at = [&](double fraction) {
      part::Piece piece;
      for (std::size_t n = 0; n < 3; ++n) {
        const glm::dvec3 turned = glm::angleAxis(fraction * turn, axis) * corners_m[n];
        piece[n] = vec3_of(center + fraction * shift + turned);
      }
      return piece;
    };
    double radius = 0;
    for (const glm::dvec3& corner : corners_m) radius = std::max(radius, glm::length(corner));
    const Bend bend{turn * turn * radius / 8, vec3_of(axis)};
    long double deepest = -1e30L;
    for (int moment = 0; moment <= 8; ++moment) {
      Corners corners;
      const part::Piece piece = at(moment / 8.0);
      for (std::size_t n = 0; n < 3; ++n) corners[n] = Wide(dvec3_of(piece[n]));
      deepest = std::max(deepest, sampled_depth({corners}, triangles, 6));
    }
    deep += deepest > largest;
    if (!comes_free(*bodies[0], Hull(at(0), at(1)), largest, bend)) continue;
    ++free;
    turning += turn > 0;
    EXPECT_LE(deepest, largest);
  }
  EXPECT_GT(free, 100);
  EXPECT_GT(turning, 30);
  EXPECT_GT(deep, 60);
}

// On both sides of what is allowed, by the least that doubles tell of these lengths: a block on a
// floor of many triangles, in a corner, and in a slot as wide as it is.
TEST(PushOut, SettlesWhatTouchesAndNotWhatIsDeeper) {
  constexpr double kDepth = 1e-9, kTold = 1e-12;
  const Surface solid = tube(16, 1, 2, 0.5);  // its upper end is a ring of slivers
  const Bodies bodies = bodies_of(solid, kWithin);
  for (const double off : {-kTold, kTold}) {
    const double z = 0.5 - kDepth - off;
    const part::Piece on_ring{vec3_of({1.2, 0, z}), vec3_of({-1.3, 0.2, z}), vec3_of({0, 1.4, z})};
    part::Piece moved = on_ring;
    for (part::Vec3& p : moved) p += {0.1, -0.2, 0};
    EXPECT_EQ(comes_free(*bodies[0], Hull(on_ring, moved), kDepth), off < 0);
  }
}

// A block that slides on a floor, and in a slot as wide as it is, however far: one proof is enough.
TEST(MotionProof, OfABlockThatSlidesInItsSlotTakesFewCells) {
  constexpr double kAllowed = 1e-9;
  Surface slot =
      united(united(box({5, 2, 0.5}), box({5, 0.5, 1}), {0, 1, 1}), box({5, 0.5, 1}), {0, -1, 1});
  const Surface block = box({0.5, 0.5, 0.5});
  const Bodies of_slot = bodies_of(slot, kWithin), of_block = bodies_of(block, kWithin);
  const MeshPair distance(slot, block);
  const auto walk_to = [&](const glm::dvec3& to, double turn, double allowed) {
    const clearance::CenterPath path({{row_of(0, {{-3, 0, 1}, {1, 0, 0, 0}}),
                                       row_of(1, {to, glm::angleAxis(turn, glm::dvec3(0, 0, 1))})}},
                                     {0, 0, 0}, 1);
    return SeatWalk(path, of_block, of_slot, distance, allowed / 8)
        .deeper_than({0, 0}, {1, 0}, allowed, 0.05);
  };
  EXPECT_TRUE(walk_to({3, 0, 1}, 0, kAllowed).empty());   // along
  EXPECT_TRUE(walk_to({-3, 0, 4}, 0, kAllowed).empty());  // up
  for (const double off : {-1e-12, 1e-12}) {
    const auto found = walk_to({3, 0, 1 - kAllowed - off}, 0, kAllowed);
    ASSERT_EQ(found.size(), off < 0 ? 0u : 1u);
    if (off > 0) {
      EXPECT_NEAR(found[0].worst.found_m, kAllowed, 1e-11);
    }
  }
  const auto turned = walk_to({3, 0, 1}, 0.1, kAllowed);
  ASSERT_EQ(turned.size(), 1u);
  EXPECT_TRUE(turned[0].is_deeper);
  EXPECT_NEAR(turned[0].worst.found_m, 0.5 * (std::cos(0.1) + std::sin(0.1)) - 0.5, 1e-3);
}

// A face that turns in the plane of another one stays in it, however far it turns.
TEST(MotionProof, OfABlockThatTurnsOnItsFloorLooksAtFewMoments) {
  constexpr double kAllowed = 1e-9;
  const Surface floor = box({5, 5, 0.5}), block = box({0.5, 0.5, 0.5});
  const Bodies of_floor = bodies_of(floor, kWithin), of_block = bodies_of(block, kWithin);
  const MeshPair distance(floor, block);
  for (const double off : {-1e-12, 1e-12}) {
    const clearance::CenterPath path(
        {{row_of(0, {{-1, 0, 1}, {1, 0, 0, 0}}),
          row_of(1, {{1, 0.3, 1 - kAllowed - off}, glm::angleAxis(1.2, glm::dvec3(0, 0, 1))})}},
        {0, 0, 0}, 1);
    SeatWalk walk(path, of_block, of_floor, distance, kAllowed / 8);
    EXPECT_EQ(walk.deeper_than({0, 0}, {1, 0}, kAllowed, 0.05).size(), off < 0 ? 0u : 1u);
    EXPECT_LE(walk.measured(), off < 0 ? 4u : 100u);
  }
}

// A block that stands on one of its edges meets the floor in no place that a cut finds.
TEST(SeatWalk, OfABlockOnItsEdgeLooksAtFewPieces) {
  constexpr double kAllowed = 1e-9, kTilt = 0.1;
  const Surface floor = box({5, 5, 0.5}), block = box({0.5, 0.5, 0.5});
  const Bodies of_floor = bodies_of(floor, kWithin), of_block = bodies_of(block, kWithin);
  const MeshPair distance(floor, block);
  const clearance::CenterPath path({{row_of(0, {})}}, {0, 0, 0}, 1);
  const SeatWalk walk(path, of_block, of_floor, distance, kAllowed / 8);
  const double height = 0.5 + 0.5 * (std::cos(kTilt) + std::sin(kTilt));
  for (const double deep : {0.0, kAllowed - 1e-12, kAllowed + 1e-12, 0.1}) {
    const Pose pose{{0.3, 0.2, height - deep}, glm::angleAxis(kTilt, glm::dvec3(1, 0, 0))};
    const Depth depth = walk.at_pose(pose, kAllowed);
    EXPECT_EQ(depth.found_m > kAllowed, deep > kAllowed) << deep;
    EXPECT_LE(depth.looked_at, 1000u) << deep;
  }
}

// Slides a shaft along its bore, about z, by two moments. What is allowed decides: a margin more
// than its depth, or a margin less.
void expect_press_fit(const Surface& shaft, const Surface& bore, double from_m, double to_m,
                      double depth_m, double margin_m, std::uint64_t max_moments) {
  const Bodies of_shaft = bodies_of(shaft, margin_m), of_bore = bodies_of(bore, margin_m);
  const MeshPair distance(bore, shaft);
  const clearance::CenterPath path(
      {{row_of(0, {{0, 0, from_m}, {1, 0, 0, 0}}), row_of(1, {{0, 0, to_m}, {1, 0, 0, 0}})}},
      {0, 0, 0}, 12);
  for (const double off : {margin_m, -margin_m}) {
    SeatWalk walk(path, of_shaft, of_bore, distance, margin_m / 8);
    const auto found = walk.deeper_than({0, 0}, {1, 0}, depth_m + off, 0.016);
    ASSERT_EQ(found.empty(), off > 0) << off;
    EXPECT_LT(walk.measured(), max_moments) << off;
    if (off < 0) {
      EXPECT_TRUE(found[0].is_deeper);
    }
  }
}

// A press fit is as deep everywhere along its edges as it is installed, and pieces of its surface
// lie inside as a whole.
TEST(SeatWalk, APressFitSlidesAllAlongItsBore) {
  expect_press_fit(prism(16, 10.02, 30), tube(16, 10, 20, 15), 14, 16, 0.02, 3e-6, 400);
}

// The ends of shaft and bore lie in one plane. The corners of the shaft come out between two faces
// of the bore, and once they have gone as far as they are deep, one of these is as near as that
// plane.
TEST(SeatWalk, APressFitWithEndsInOnePlaneSlides) {
  expect_press_fit(prism(64, 10.01, 20), tube(64, 10, 20, 15), 5, 5.02, 0.01, 4e-6, 40);
}

// Walls that are both thinner than twice what is allowed elsewhere: in their middle they are as
// deep as half of one, which is found however short the moment is.
TEST(SeatWalk, FindsThinWallsThatPassThroughEachOther) {
  const Surface wall = box({0.01, 0.2, 0.2}), other = box({0.01, 0.1, 0.1});
  const Bodies of_wall = bodies_of(wall, 1e-6), of_other = bodies_of(other, 1e-6);
  const MeshPair distance(wall, other);
  const glm::dquat leaning = glm::angleAxis(0.3, glm::dvec3(0, 1, 0));
  const clearance::CenterPath path(
      {{row_of(0, {{-1, 0, 0}, leaning}), row_of(1, {{1, 0, 0.02}, leaning})}}, {0, 0, 0}, 1);
  for (const double allowed : {1e-6, 0.009}) {
    SeatWalk walk(path, of_other, of_wall, distance, allowed / 8);
    const auto found = walk.deeper_than({0, 0}, {1, 0}, allowed, 0.05);
    ASSERT_FALSE(found.empty()) << allowed;
    EXPECT_TRUE(found[0].is_deeper);
    EXPECT_GT(found[0].worst.found_m, 0.0098);
  }
}

// A part that has no inside is settled by that of the object: a sheet that passes through it.
TEST(SeatWalk, ASheetThatPassesThroughASolidIsDeepInIt) {
  Surface sheet;
  sheet.vertices_m = {{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0, 0.5, 0}};
  sheet.triangles = {{0, 1, 2}};
  sheet.object = {1};
  const Surface solid = box({1, 1, 0.1});
  const Bodies of_sheet = bodies_of(sheet, 1e-6), of_solid = bodies_of(solid, 1e-6);
  const auto walk_past = [&](const Surface& a, const Bodies& of_a, const Surface& b,
                             const Bodies& of_b, double z) {
    const MeshPair distance(b, a);
    const clearance::CenterPath path(
        {{row_of(0, {{0, 0, 2}, {1, 0, 0, 0}}), row_of(1, {{0, 0, z}, {1, 0, 0, 0}}),
          row_of(2, {{0, 0, 2}, {1, 0, 0, 0}})}},
        {0, 0, 0}, 1);
    SeatWalk walk(path, of_a, of_b, distance, 1e-10);
    EXPECT_TRUE(walk.is_settled());
    return walk.deeper_than({0, 0}, {2, 0}, 1e-9, 0.05);
  };
  for (const auto& [part, object, of_part, of_object] :
       {std::tuple(&std::as_const(sheet), &solid, &of_sheet, &of_solid),
        std::tuple(&solid, &std::as_const(sheet), &of_solid, &of_sheet)}) {
    EXPECT_TRUE(walk_past(*part, *of_part, *object, *of_object, 0.1).empty());
    const auto found = walk_past(*part, *of_part, *object, *of_object, -1);
    ASSERT_FALSE(found.empty());
    EXPECT_NEAR(found[0].worst.found_m, 0.1, 1e-3);
  }
}

TEST(Body, HoldsThePlacesThatItsTrianglesWindAround) {
  std::mt19937 random(28);
  std::uniform_real_distribution<double> unit(-1.3, 1.3);
  const Surface many = prism(150, 1, 0.4);
  const auto triangles = placed(many, {}, 0);
  const Bodies bodies = bodies_of(many, kWithin);
  int inside = 0;
  for (int n = 0; n < 400; ++n) {
    const glm::dvec3 place(unit(random), unit(random), unit(random));
    const bool holds = bodies[0]->holds(vec3_of(place));
    EXPECT_EQ(holds, depth_in(Wide(place), triangles) > 0) << n;
    inside += holds;
  }
  EXPECT_GT(inside, 40);
}

// The same places counted by a ray and by solid angles, in a body whose faces run to either side.
TEST(Body, CountsWindingsByARayAsBySolidAngles) {
  Surface surface = united(tube(24, 0.3, 1, 0.7), box({0.2, 0.9, 0.4}), {0.5, 0, 0.1});
  surface.object.assign(surface.triangles.size(), 1);
  const Bodies bodies = bodies_of(surface, 0.01);
  ASSERT_TRUE(are_solid(bodies));
  const part::Part& part = bodies[0]->tree().part();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(-1.5, 1.5);
  int told = 0, largest = 0;
  for (int n = 0; n < 3000; ++n) {
    part::Vec3 place{at(random), at(random), at(random)};
    if (n % 3 == 0) place = part.vertices[n % part.vertices.size()] + 1e-5 * place;
    if (n % 7 == 0) place.z = 0.7;  // in a face's plane
    double sum = 0;
    for (const mesh::Triangle& t : part.triangles) {
      sum += certificate::triangle_winding(place, part.vertices[t[0]], part.vertices[t[1]],
                                           part.vertices[t[2]]);
    }
    if (std::abs(sum - std::round(sum)) > 1e-3) continue;  // on a face
    const auto windings = bodies[0]->windings_by_ray(place);
    if (!windings) continue;
    ++told;
    largest = std::max(largest, *windings);
    ASSERT_EQ(*windings, std::lround(sum)) << n;
  }
  EXPECT_GT(told, 2500);
  EXPECT_EQ(largest, 2);
  // Through an edge, and from a face: not told.
  const glm::dvec3 edge = surface.vertices_m[surface.triangles[0][0]];
  EXPECT_FALSE(bodies[0]->windings_by_ray(vec3_of(edge)));
  EXPECT_FALSE(
      bodies[0]->windings_by_ray(vec3_of(edge - glm::dvec3(0.5437211, 0.2913847, 0.7870619))));
}

TEST(Body, MeetsThePiecesThatCrossItsTrianglesAndNoOthers) {
  std::mt19937 random(29);
  std::uniform_real_distribution<double> unit(-1.3, 1.3);
  const Surface many = tube(12, 0.5, 1, 0.4);
  const auto triangles = placed(many, {}, 0);
  const Bodies bodies = bodies_of(many, kWithin);
  int met = 0, apart = 0;
  for (int n = 0; n < 3000; ++n) {
    const double size = std::pow(0.5, n % 8);
    const glm::dvec3 center(unit(random), unit(random), unit(random) / 2);
    part::Piece piece;
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 p = center + size * glm::dvec3(unit(random), unit(random), unit(random));
      piece[i] = vec3_of(p), corners[i] = Wide(p);
    }
    const bool meets = std::any_of(triangles.begin(), triangles.end(),
                                   [&](const Corners& t) { return meet(t, corners); });
    EXPECT_EQ(bodies[0]->may_meet(piece), meets) << n;
    ++(meets ? met : apart);
    if (meets) continue;
    // All of it lies on one side.
    EXPECT_EQ(bodies[0]->holds(piece[0]), bodies[0]->holds(piece[1])) << n;
    EXPECT_EQ(bodies[0]->holds(piece[0]), bodies[0]->holds(piece[2])) << n;
  }
  EXPECT_GT(met, 500);
  EXPECT_GT(apart, 500);
  // A triangle that touches may meet.
  const auto corner = many.vertices_m[0];
  EXPECT_TRUE(bodies[0]->may_meet({vec3_of(corner), vec3_of(corner * 0.5), vec3_of({0, 0, -0.3})}));
}

TEST(Body, IsSolidWhereItIsClosedButForCracks) {
  const double crack_m = 0.01;
  const auto solid = [&](const Surface& surface) {
    const Bodies bodies = bodies_of(surface, crack_m);
    return bodies.size() == 1 && bodies[0]->is_solid();
  };
  const Surface whole = box({1, 1, 1});
  EXPECT_TRUE(solid(whole));
  Surface turned = whole;  // some faces are
  for (const int t : {1, 4, 7}) std::swap(turned.triangles[t][1], turned.triangles[t][2]);
  EXPECT_TRUE(solid(turned));
  Surface open = whole;
  open.triangles.resize(10), open.object.resize(10);
  EXPECT_FALSE(solid(open));
  // The upper face has vertices of its own, above the walls.
  for (const double gap_m : {0.001, 0.2}) {
    Surface cracked = whole;
    for (std::uint32_t n = 0; n < 4; ++n) {
      cracked.vertices_m.push_back(cracked.vertices_m[4 + n] + glm::dvec3(0, 0, gap_m));
    }
    for (const int t : {2, 3}) {
      for (std::uint32_t& corner : cracked.triangles[t]) corner += 4;
    }
    EXPECT_EQ(solid(cracked), gap_m < crack_m) << gap_m;
    if (gap_m < crack_m) {
      EXPECT_EQ(bodies_of(cracked, crack_m)[0]->crack_m(), crack_m / 8);  // just above the gap
    }
  }
  // Nothing has an inside without area.
  Surface flat = whole;
  for (glm::dvec3& v : flat.vertices_m) v.y = v.z = 0;
  EXPECT_TRUE(bodies_of(flat, crack_m).empty());
}

// A prism whose ends have corners of their own, that are so far from those of its sides.
Surface cracked_prism(int sides, double radius_m, double half_m, double crack_m) {
  Surface surface = prism(sides, radius_m, half_m);
  const auto count = static_cast<std::uint32_t>(surface.vertices_m.size());
  for (std::uint32_t n = 0; n < count; ++n) {
    const glm::dvec3 v = surface.vertices_m[n];
    surface.vertices_m.push_back(
        {(1 - crack_m / radius_m) * v.x, (1 - crack_m / radius_m) * v.y, v.z});
  }
  for (mesh::Triangle& t : surface.triangles) {
    const bool is_end = t[0] % 2 == t[1] % 2 && t[1] % 2 == t[2] % 2;
    for (std::uint32_t& corner : t) corner += is_end ? count : 0;
  }
  return surface;
}

// The inside of a solid with cracks, counted along a ray, against its winding number; and how far
// its open edges are from a ray, against places all along that.
TEST(Body, HoldsBesideItsCracksWhatItsTrianglesWindAround) {
  constexpr double kCrack = 2e-3;
  const Surface surface = cracked_prism(24, 1, 0.4, kCrack);
  const Bodies bodies = bodies_of(surface, 4 * kCrack);
  ASSERT_TRUE(bodies[0]->is_solid());
  ASSERT_GT(bodies[0]->crack_m(), 0);
  const certificate::WindingNumber winding(bodies[0]->tree());
  part::Part edges;
  edges.vertices = {vec3_of({1, 0, 0.4}), vec3_of({0.2, 0.9, 0.3}), vec3_of({-0.5, 0.1, 0.7})};
  edges.triangles = {{0, 1, 1}, {1, 2, 2}};
  const part::TriangleTree edge_tree(edges);
  const glm::dvec3 ray(0.5437211, 0.2913847, 0.7870619);  // that of windings_by_ray()
  std::mt19937 random(29);
  std::uniform_real_distribution<double> unit(-1.1, 1.1);
  int inside = 0, near_edge = 0, near_ray = 0;
  for (int n = 0; n < 20000; ++n) {
    glm::dvec3 place{unit(random), unit(random), unit(random)};
    if (n % 2 == 0) {  // beside an end
      const double away_m = 8 * kCrack * unit(random);
      place = (1 + away_m) * glm::dvec3(glm::normalize(glm::dvec2(place)), 0.4);
    }
    const part::Vec3 at = vec3_of(place);
    if (bodies[0]->crack_near_m(at, 0) > 0) {
      ++near_edge;
      continue;
    }
    if (bodies[0]->tree().is_within(at, 1e-9)) continue;
    EXPECT_EQ(bodies[0]->holds(at), std::abs(winding.at(at)) > 0.5) << n;
    inside += bodies[0]->holds(at);
    double smallest = 1e30;
    for (int k = 0; k < 300; ++k) {
      const auto there = edge_tree.nearest(vec3_of(place + 0.01 * k * ray));
      smallest = std::min(smallest, std::sqrt(there.distance_squared));
    }
    // Between two of these places the ray comes nearer by half of their distance at most.
    const bool is_near = certificate::is_ray_within(edge_tree, at, 0.1);
    EXPECT_TRUE(!is_near || smallest < 0.1 + 0.005) << n;
    EXPECT_TRUE(is_near || smallest > 0.1) << n;
    near_ray += is_near;
  }
  EXPECT_GT(inside, 4000);
  EXPECT_GT(near_edge, 200);
  EXPECT_GT(near_ray, 100);
}

// Faces that are nearer to each other than cracks are wide, far from any crack, while a foot of the
// part is in the floor: few places of the faces need to be looked at closely.
TEST(SeatDepth, OfFacesWithCracksElsewhereTakesFewPieces) {
  constexpr double kCrack = 4e-3;
  const Surface floor = cracked_prism(24, 3, 0.4, kCrack);
  const Bodies of_floor = bodies_of(floor, kCrack);
  const double crack_m = of_floor[0]->crack_m(), deep_m = 0.1 * crack_m;
  ASSERT_GT(crack_m, 0);
  for (const double gap_m : {0.5 * crack_m, 0.45 * crack_m}) {
    const Surface block = united(cracked_prism(24, 1, 0.4, kCrack), box({0.1, 0.1, 0.2}),
                                 {0, 0, -0.2 - gap_m - deep_m});
    const Bodies of_block = bodies_of(block, kCrack);
    const MeshPair distance(floor, block);
    const clearance::CenterPath path({{row_of(0, {})}}, {0, 0, 0}, 2);
    const SeatWalk walk(path, of_block, of_floor, distance, crack_m / 4);
    const Pose pose{{0.1, 0.2, 0.8 + gap_m}, glm::angleAxis(0.05, glm::dvec3(0, 0, 1))};
    const Depth depth = walk.at_pose(pose, std::nullopt);
    EXPECT_LE(depth.looked_at, 100000u) << gap_m;  // 2,400,000 with cracks everywhere
    EXPECT_NEAR(depth.found_m, deep_m, crack_m / 4) << gap_m;
    EXPECT_LE(depth.at_most_m, 2 * crack_m) << gap_m;
  }
}

}  // namespace
}  // namespace forcelayer::exact
