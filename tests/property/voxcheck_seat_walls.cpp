// Walls thinner than twice the depth that a seat allows. Which ways lead through a wall is known by
// construction: a fin of the part before a tab of the object, far larger than the fin.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <initializer_list>
#include <random>
#include <string>
#include <utility>

#include "tests/support/box_surface.h"
#include "tests/support/ring_surface.h"
#include "workbench/exact/push_out.h"
#include "workbench/exact/seat_walk.h"
#include "workbench/exact/surface/shells.h"

namespace forcelayer::exact {
namespace {

using test::add_box;

double evenly(std::mt19937& random, double low, double high) {  // by ratio
  return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
}

// A foot that lies `depth` deep in a floor, and on the same part a fin, `gap` before a tab that
// stands on the same object.
struct FinBeforeTab {
  FinBeforeTab(double depth, double gap, double fin, double tab, bool is_inward = false) {
    add_box(part, {-14, -2, -depth}, {-10, 2, 6});
    add_box(part, {2, -3, 1}, {2 + fin, 3, 6});
    add_box(object, {-40, -40, -8}, {40, 40, 0});
    const glm::dvec3 low(2 + fin + gap, -30, 0.25), high(2 + fin + gap + tab, 30, 12);
    add_box(object, low, high, 1, is_inward);
  }
  Surface part, object;
};

Surface moved(Surface surface, const Pose& pose) {
  for (glm::dvec3& v : surface.vertices_m) v = pose.position_m + pose.orientation * v;
  return surface;
}

// The stretches of a straight way, in a frame that is moved and turned.
std::vector<SeatWalk::Stretch> stretches_of(const Surface& part, const Surface& object,
                                            const glm::dvec3& way, double turn, double allowed,
                                            const Pose& frame, double crack = 1e-9) {
  const Surface scene = moved(object, frame);
  const Bodies of_part = bodies_of(part, 1e-9), of_object = bodies_of(scene, crack);
  EXPECT_TRUE(are_solid(of_part) && are_solid(of_object));
  const MeshPair distance(scene, part);
  const auto row = [&](double time_s, const Pose& own) {
    const Pose pose = frame * own;
    const auto& p = pose.position_m;
    const auto& q = pose.orientation;
    return PathRow{time_s, {p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
  };
  const clearance::CenterPath path(
      {{row(0, {}), row(1, {way, glm::angleAxis(turn, glm::dvec3(0, 0, 1))})}}, {0, 0, 0}, 32);
  SeatWalk walk(path, of_part, of_object, distance, allowed / 64);
  return walk.deeper_than({0, 0}, {1, 0}, allowed, 0.016);
}

Pose any_frame(std::mt19937& random) {
  std::normal_distribution<double> any;
  const glm::dquat turned(any(random), any(random), any(random), any(random));
  return {{any(random), any(random), any(random)}, glm::normalize(turned)};
}

// A box whose upper face has corners of its own, a crack above its walls.
void add_cracked_box(Surface& surface, const glm::dvec3& low, const glm::dvec3& high,
                     double crack) {
  const std::size_t vertices = surface.vertices_m.size(), triangles = surface.triangles.size();
  add_box(surface, low, high);
  for (std::size_t n = vertices + 4; n < vertices + 8; ++n) {
    surface.vertices_m.push_back(surface.vertices_m[n] + glm::dvec3(0, 0, crack));
  }
  for (std::size_t t = triangles + 2; t < triangles + 4; ++t) {
    for (std::uint32_t& corner : surface.triangles[t]) corner += 4;
  }
}

// A rib along y that stands on its edge, `sunk` below z = 0.
void add_rib(Surface& surface, double x, double half_wide, double high, double sunk,
             bool is_inward) {
  const auto first = static_cast<std::uint32_t>(surface.vertices_m.size());
  for (const double y : {-20.0, 20.0}) {
    surface.vertices_m.emplace_back(x, y, -sunk);
    surface.vertices_m.emplace_back(x + half_wide, y, high);
    surface.vertices_m.emplace_back(x - half_wide, y, high);
  }
  for (mesh::Triangle t : std::initializer_list<mesh::Triangle>{{0, 1, 2},
                                                                {3, 5, 4},
                                                                {0, 3, 4},
                                                                {0, 4, 1},
                                                                {1, 4, 5},
                                                                {1, 5, 2},
                                                                {2, 5, 3},
                                                                {2, 3, 0}}) {
    if (is_inward) std::swap(t[1], t[2]);
    surface.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    surface.object.push_back(1);
  }
}

// The places outside that are so near to a piece are connected outside, seen from place to place;
// beside a thin wall, those before and behind it are not.
TEST(SeatWalls, OfOneSideAllPlacesOutsideAreConnected) {
  std::mt19937 random(68);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto any = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  int sided = 0, walls = 0;
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    const double depth = evenly(random, 0.02, 0.3);
    Surface solid;
    add_box(solid, {-1, -1, 0}, {1, 1, evenly(random, 0.5 * depth, 8 * depth)});
    if (trial % 2 == 0) add_box(solid, {-1, -1, -1}, {1, -1 + 2 * depth, -0.1 * depth});
    const Bodies bodies = bodies_of(solid, 1e-9);
    const Body& body = *bodies[0];
    glm::dvec3 place = 1.1 * any();
    place.z = depth * unit(random);
    const auto near = body.tree().nearest(vec3_of(place));
    if (near.distance_squared > depth * depth) continue;
    const part::Vec3 p = vec3_of(place), q = vec3_of(place + 1e-3 * depth * any());
    const bool has_side = sides_of(body, Hull({p, q, 0.5 * (p + q)}), depth) == Sides::kOne;
    // Those within the depth come first, then others within the farthest reach, 1 + 1 / 0.25.
    std::vector<part::Vec3> outside;
    std::size_t within = 0;
    for (int n = 0; n < 400; ++n) {
      const glm::dvec3 off = any();
      if (glm::length(off) > 1) continue;
      const part::Vec3 at = vec3_of(place + (n < 150 ? 1 : 5) * depth * off);
      if (body.holds(at)) continue;
      outside.push_back(at);
      within += n < 150;
    }
    if (within == 0) continue;
    std::vector<bool> is_reached(outside.size());
    std::vector<std::size_t> open{0};
    is_reached[0] = true;
    while (!open.empty()) {
      const part::Vec3 from = outside[open.back()];
      open.pop_back();
      for (std::size_t n = 0; n < outside.size(); ++n) {
        if (is_reached[n] || body.may_meet({from, outside[n], outside[n]})) continue;
        is_reached[n] = true;
        open.push_back(n);
      }
    }
    const auto count = std::count(is_reached.begin(),
                                  is_reached.begin() + static_cast<std::ptrdiff_t>(within), true);
    const bool is_connected = static_cast<std::size_t>(count) == within;
    EXPECT_TRUE(is_connected || !has_side) << depth;
    sided += has_side;
    walls += !is_connected;
  }
  EXPECT_GT(sided, 40);
  EXPECT_GT(walls, 20);
}

// A boss that is sunk into a floor has faces inside of it, which bound nothing: a shim that goes
// down along one of them is as deep in the floor as anywhere.
TEST(SeatWalls, FacesOfOneShellInAnotherHideNoDepth) {
  std::mt19937 random(70);
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE(trial);
    const double thick = evenly(random, 0.01, 0.3), allowed = 0.6 * thick;
    Surface part, object;
    add_box(part, {-thick / 2, -4, 0.5}, {thick / 2, 4, 6});
    add_box(object, {-40, -40, -30}, {40, 40, 0});
    add_box(object, {0, -10, -20}, {20, 10, 15});
    const Pose frame = any_frame(random);
    const auto along = [&](const glm::dvec3& way) {
      return stretches_of(part, object, way, 0, allowed, frame);
    };
    const auto down = along({0, 0, -8});
    ASSERT_FALSE(down.empty());
    EXPECT_TRUE(down[0].is_deeper);
    EXPECT_GT(down[0].worst.found_m, 3);  // halfway to the end of the shim
    EXPECT_TRUE(along({0, 0, 12}).empty());
  }
}

// A bar along x whose end comes back and crosses its beginning: one shell. Within the crossing,
// faces of each end lie inside of the other, and bound nothing.
void add_loop(Surface& surface, double thick, double high) {
  const std::vector<std::pair<double, double>> left{
      {-10, thick}, {40, thick}, {40, 30}, {8 + thick, 30}, {8 + thick, -20}};
  const std::vector<std::pair<double, double>> right{
      {-10, 0}, {40 + thick, 0}, {40 + thick, 30 + thick}, {8, 30 + thick}, {8, -20}};
  const auto first = static_cast<std::uint32_t>(surface.vertices_m.size());
  for (std::size_t n = 0; n < left.size(); ++n) {
    for (const double z : {0.0, high}) {
      surface.vertices_m.emplace_back(right[n].first, right[n].second, z);
      surface.vertices_m.emplace_back(left[n].first, left[n].second, z);
    }
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    surface.triangles.push_back({first + a, first + b, first + c});
    surface.triangles.push_back({first + a, first + c, first + d});
    surface.object.insert(surface.object.end(), 2, 1);
  };
  const auto last = static_cast<std::uint32_t>(4 * (left.size() - 1));
  add(0, 2, 3, 1);
  add(last, last + 1, last + 3, last + 2);
  for (std::uint32_t n = 0; n < last; n += 4) {
    add(n, n + 4, n + 6, n + 2);      // the right side
    add(n + 1, n + 3, n + 7, n + 5);  // the left side
    add(n, n + 1, n + 5, n + 4);      // the lower side
    add(n + 2, n + 6, n + 7, n + 3);  // the upper side
  }
}

// A face of a shell that lies inside of the same shell hides how deep a shim is beside it. But no
// shim goes in or out along it.
TEST(SeatWalls, NoShimGoesAlongAFaceInsideOfItsOwnShell) {
  std::mt19937 random(76);
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE(trial);
    const double wide = evenly(random, 4, 7), high = 12, thick = evenly(random, 0.2, 0.6),
                 allowed = evenly(random, 0.55, 2) * thick;
    Surface part, object;
    add_box(part, {8 - thick / 2, 0.2 * wide, high + 0.5}, {8 + thick / 2, 0.8 * wide, high + 6});
    add_loop(object, wide, high);
    const Bodies body = bodies_of(object, 1e-9);
    ASSERT_EQ(body.size(), 1u);
    ASSERT_TRUE(body[0]->is_solid());
    EXPECT_EQ(body[0]->windings_by_ray({8.1, 0.5 * wide, 6}), 2);
    EXPECT_EQ(body[0]->windings_by_ray({7.9, 0.5 * wide, 6}), 1);
    const Pose frame = any_frame(random);
    const auto along = [&](const Surface& shim, const glm::dvec3& way) {
      return stretches_of(shim, object, way, 0, allowed, frame);
    };
    EXPECT_FALSE(along(part, {0, 0, -2.5}).empty());
    EXPECT_TRUE(along(part, {0, 0, 12}).empty());
    EXPECT_TRUE(along(part, {0, -30, 0}).empty());
    const Surface inside = moved(part, {{0, 0, -2.5}, {1, 0, 0, 0}});
    EXPECT_FALSE(along(inside, {0, 0, 12}).empty());
  }
}

// Closed shells are turned outwards, and cavities inwards. Shells of one body do not meet, and
// cavities are of the body around them.
TEST(SeatWalls, ShellsAreTurnedAndThoseOfOneBodyAreApart) {
  std::mt19937 random(71);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto any = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  int together = 0, cavities = 0;
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    Surface surface;
    struct Made {
      glm::dvec3 low, high;
      bool is_inward, is_cavity;
      std::size_t around;
    };
    std::vector<Made> made;
    for (std::size_t n = 0; n < 8; ++n) {
      const glm::dvec3 low = any(), size = 0.4 * any() + 0.01;
      const bool is_inward = unit(random) < 0.2;
      made.push_back({low, low + size, is_inward, false, n});
      add_box(surface, low, low + size, 1, is_inward);
    }
    // A box beside all of them, in it a cavity, and in that a box, which may be inside out; and
    // again, all of it inside out.
    for (int n = 0; n < 2; ++n) {
      const glm::dvec3 low(-10 + 2 * n), high(-9.5 + 2 * n), in(0.1);
      const bool is_turned = n == 1, is_inner_turned = trial % 2 == 0;
      add_box(surface, low, high, 1, is_turned);
      add_box(surface, low + in, high - in, 1, !is_turned);
      add_box(surface, low + 2.0 * in, high - 2.0 * in, 1, is_inner_turned);
      made.push_back({low, high, is_turned, false, made.size()});
      made.push_back({low + in, high - in, !is_turned, true, made.size() - 1});
      made.push_back({low + 2.0 * in, high - 2.0 * in, is_inner_turned, false, made.size()});
      ++cavities;
    }
    const auto given = surface.triangles;
    turn_outwards(surface);
    ASSERT_EQ(surface.triangles.size(), 12 * made.size());
    // A box among the first that is turned to another side than a larger one around it is a cavity.
    const auto holds = [](const Made& a, const Made& b) {
      return glm::all(glm::lessThan(a.low, b.low)) && glm::all(glm::lessThan(b.high, a.high));
    };
    for (std::size_t i = 0; i < made.size(); ++i) {
      const bool is_in = i < 8 && std::any_of(made.begin(), made.begin() + 8,
                                              [&](const Made& m) { return holds(m, made[i]); });
      for (std::size_t t = 12 * i; !is_in && t < 12 * (i + 1); ++t) {
        EXPECT_EQ(surface.triangles[t] != given[t], made[i].is_inward != made[i].is_cavity) << i;
      }
    }
    const auto body = shells_apart(surface, 0);
    ASSERT_EQ(body.size(), 12 * made.size());
    for (std::size_t i = 0; i < made.size(); ++i) {
      for (std::size_t t = 1; t < 12; ++t) EXPECT_EQ(body[12 * i], body[12 * i + t]);
      if (made[i].is_cavity) {
        EXPECT_EQ(body[12 * i], body[12 * made[i].around]);
      }
      for (std::size_t j = 0; j < i; ++j) {
        if (made[i].is_cavity || made[j].is_cavity || body[12 * i] != body[12 * j]) continue;
        if (i < 8 && j < 8 && (holds(made[i], made[j]) || holds(made[j], made[i]))) continue;
        const bool apart = glm::any(glm::lessThan(made[i].high, made[j].low)) ||
                           glm::any(glm::lessThan(made[j].high, made[i].low));
        EXPECT_TRUE(apart) << i << " " << j;
        ++together;
      }
    }
  }
  EXPECT_GT(together, 60);
  EXPECT_EQ(cavities, 120);
  // An object with an open piece stays one, unless that is open but for cracks.
  Surface open;
  add_box(open, {0, 0, 0}, {1, 1, 1});
  add_cracked_box(open, {0.5, 0.5, 0.5}, {2, 2, 2}, 0.01);
  const auto one = shells_apart(open, 0), two = shells_apart(open, 0.02);
  EXPECT_EQ(*std::max_element(one.begin(), one.end()), 0u);
  EXPECT_EQ(std::count(two.begin(), two.begin() + 12, two[0]), 12);
  EXPECT_EQ(std::count(two.begin() + 12, two.end(), 1 - two[0]), 12);
}

// An overlap where the part is installed opens no wall elsewhere, however thin.
TEST(SeatWalls, AnOverlapElsewhereLetsNoWallPass) {
  std::mt19937 random(65);
  int as_deep_as_half = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const double depth = evenly(random, 0.02, 0.8), allowed = depth + 1e-3;
    // Walls of 0.05 to 4 times the depth.
    const double fin = evenly(random, 0.05 * depth, 4 * depth),
                 tab = evenly(random, 0.05 * depth, 4 * depth), gap = evenly(random, 1e-3, 1);
    const FinBeforeTab seat(depth, gap, fin, tab, trial % 3 == 0);
    const Pose frame = any_frame(random);
    SCOPED_TRACE("trial " + std::to_string(trial) + ", depth " + std::to_string(depth) + ", fin " +
                 std::to_string(fin) + ", tab " + std::to_string(tab));
    as_deep_as_half += 2 * allowed > std::min(fin, tab);
    const double turn = trial % 2 == 0 ? 0 : std::uniform_real_distribution(-0.1, 0.1)(random);
    const auto through = [&](const glm::dvec3& way, double by_rad) {
      return stretches_of(seat.part, seat.object, way, by_rad, allowed, frame);
    };
    EXPECT_FALSE(through({gap + fin + tab + 0.5, 0.3, 0}, turn).empty());
    // Away from it, along it and up, the foot slides out or lifts off.
    EXPECT_TRUE(through({-20, 0.3, 0}, 0).empty());
    EXPECT_TRUE(through({0, 9, 0}, 0).empty());
    EXPECT_TRUE(through({0, 0, 20}, 0).empty());
  }
  EXPECT_GT(as_deep_as_half, 15);
}

// Surfaces that touch may go into each other by the deviations of both. That opens no wall that is
// thinner than these, and the part still slides along such walls.
TEST(SeatWalls, DeviationsLetNoWallPass) {
  std::mt19937 random(66);
  for (int trial = 0; trial < 20; ++trial) {
    const double deviations = evenly(random, 0.01, 0.3);
    const double fin = evenly(random, 0.1 * deviations, 2 * deviations),
                 tab = evenly(random, 0.1 * deviations, 2 * deviations);
    const FinBeforeTab seat(0, 0, fin, tab);  // foot and fin both touch
    const Pose frame = any_frame(random);
    SCOPED_TRACE("trial " + std::to_string(trial) + ", deviations " + std::to_string(deviations) +
                 ", fin " + std::to_string(fin) + ", tab " + std::to_string(tab));
    const auto through = [&](const glm::dvec3& way) {
      return stretches_of(seat.part, seat.object, way, 0, deviations, frame);
    };
    const auto passed = through({fin + tab + 0.5, 0, 0});
    ASSERT_FALSE(passed.empty());
    EXPECT_TRUE(passed[0].passes_wall || passed[0].is_deeper);
    EXPECT_TRUE(through({0, 9, 0}).empty());
    EXPECT_TRUE(through({-20, 0, 0}).empty());
  }
}

// A thin rod goes along the floor, through the edge on which a rib stands. Be the rib inside out,
// or the floor: the answer is not "clear". Shells that have a corner in common are turned as one.
TEST(SeatWalls, NoShellThatIsInsideOutIsPassed) {
  std::mt19937 random(72);
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE(trial);
    const double depth = evenly(random, 0.02, 0.3);
    Surface part, object;
    add_box(part, {-14, -2, -depth}, {-10, 2, 6});
    add_box(part, {-1, -25, 0.3 * depth}, {-1 + depth, 25, 0.9 * depth});
    add_box(object, {-40, -40, -8}, {40, 40, 0}, 1, trial % 3 == 1);
    add_rib(object, 5, 5 * depth, 12 * depth, 0.2 * depth, trial % 3 != 1);
    if (trial % 2 == 0) {  // a triangle without area makes both one piece
      object.triangles.push_back({5, 5, 9}), object.object.push_back(1);
    }
    const Pose frame = any_frame(random);
    const auto along = [&](const glm::dvec3& way) {
      return stretches_of(part, object, way, 0, depth + 1e-3, frame);
    };
    EXPECT_FALSE(along({8, 0, 0}).empty());
    EXPECT_TRUE(along({-8, 0, 0}).empty());
    EXPECT_TRUE(along({0, 0, 20}).empty());
  }
}

// A strip without a back, narrower than cracks may be, has no inside. No wall of the part passes
// it.
TEST(SeatWalls, NoStripThatIsNarrowerThanCracksIsPassed) {
  std::mt19937 random(73);
  for (int trial = 0; trial < 12; ++trial) {
    const double depth = evenly(random, 0.02, 0.3), crack = depth,
                 strip = evenly(random, 0.05, 0.9) * crack;
    SCOPED_TRACE("trial " + std::to_string(trial) + ", depth " + std::to_string(depth) +
                 ", strip " + std::to_string(strip));
    FinBeforeTab seat(depth, 1, evenly(random, 0.1 * depth, 1.5 * depth), 1);
    seat.object.triangles.resize(12), seat.object.object.resize(12);
    const auto first = static_cast<std::uint32_t>(seat.object.vertices_m.size());
    for (const double z : {2.0, 2 + strip}) {
      for (const double y : {-30.0, 30.0}) seat.object.vertices_m.emplace_back(8, y, z);
    }
    const bool turned = trial % 2 == 0;
    seat.object.triangles.push_back(
        {first, first + (turned ? 1u : 2u), first + (turned ? 2u : 1u)});
    seat.object.triangles.push_back(
        {first + 3, first + (turned ? 2u : 1u), first + (turned ? 1u : 2u)});
    seat.object.object.assign(14, 1);
    const Pose frame = any_frame(random);
    const auto along = [&](const glm::dvec3& way) {
      return stretches_of(seat.part, seat.object, way, 0, 3 * depth, frame, crack);
    };
    EXPECT_FALSE(along({12, 0, 0}).empty());
    EXPECT_TRUE(along({-12, 0, 0}).empty());
    EXPECT_TRUE(along({0, 0, 20}).empty());
  }
}

// The same as for closed shells where the floor or a box far away has a crack.
TEST(SeatWalls, FacesOfOneShellInAnotherHideNoDepthBesideCracks) {
  std::mt19937 random(74);
  for (int trial = 0; trial < 8; ++trial) {
    SCOPED_TRACE(trial);
    const double thick = evenly(random, 0.03, 0.3), allowed = 0.6 * thick, crack = 1e-3;
    Surface part, object;
    add_box(part, {-thick / 2, -4, 0.5}, {thick / 2, 4, 6});
    if (trial % 2 == 0) {
      add_cracked_box(object, {-40, -40, -30}, {40, 40, 0}, crack);
    } else {
      add_box(object, {-40, -40, -30}, {40, 40, 0});
      add_cracked_box(object, {-90, 0, 0}, {-80, 10, 10}, crack);
    }
    add_box(object, {0, -10, -20}, {20, 10, 15}, 1, trial % 4 < 2);
    const Pose frame = any_frame(random);
    const auto along = [&](const glm::dvec3& way) {
      return stretches_of(part, object, way, 0, allowed, frame, 4 * crack);
    };
    const auto down = along({0, 0, -8});
    ASSERT_FALSE(down.empty());
    EXPECT_TRUE(down[0].is_deeper);
    EXPECT_GT(down[0].worst.found_m, 3);
    EXPECT_TRUE(along({0, 0, 12}).empty());
  }
}

// Two sheets overlap by about a quarter of their thickness, and are allowed to by almost all of it:
// the one slides off the other.
TEST(SeatWalls, ASheetSlidesOffOneThatIsHardlyThickerThanAllowed) {
  std::mt19937 random(75);
  for (int trial = 0; trial < 8; ++trial) {
    const double thick = evenly(random, 0.05, 0.5),
                 overlap = std::uniform_real_distribution(0.232, 0.245)(random) * thick;
    SCOPED_TRACE("trial " + std::to_string(trial) + ", thick " + std::to_string(thick) +
                 ", overlap " + std::to_string(overlap));
    Surface part, object;
    add_box(object, {0, -12, -10}, {thick, 12, 0});
    add_box(part, {thick - overlap, -10, -5}, {2 * thick - overlap, 10, 1});
    const Pose frame = any_frame(random);
    const auto along = [&](const glm::dvec3& way) {
      return stretches_of(part, object, way, 0, 0.9 * thick, frame);
    };
    EXPECT_TRUE(along({0, 0, 12}).empty());
    EXPECT_FALSE(along({-4 * thick, 0, 0}).empty());
  }
}

// The place that is told of a wall is where the part begins to pass it, not where it is deepest.
TEST(SeatWalls, TellsWhereAWallIsPassed) {
  std::mt19937 random(76);
  int passed = 0;
  for (int trial = 0; trial < 16; ++trial) {
    const double depth = evenly(random, 0.02, 0.3), allowed = depth + 1e-3;
    const double fin = evenly(random, 0.2 * depth, 1.9 * depth),
                 tab = evenly(random, 0.2 * depth, 1.9 * depth), gap = evenly(random, 0.1, 1);
    const FinBeforeTab seat(depth, gap, fin, tab);
    const Pose frame = any_frame(random);
    SCOPED_TRACE("trial " + std::to_string(trial) + ", depth " + std::to_string(depth) + ", fin " +
                 std::to_string(fin) + ", tab " + std::to_string(tab));
    const double way = gap + fin + tab + 4;
    const auto found = stretches_of(seat.part, seat.object, {way, 0, 0}, 0, allowed, frame);
    ASSERT_FALSE(found.empty());
    if (!found[0].passes_wall) continue;
    ++passed;
    const Pose own = inverse(frame);
    const glm::dvec3 place = own.position_m + own.orientation * found[0].worst.place_m,
                     foot = own.position_m + own.orientation * found[0].worst.foot_m;
    const double moved =
        (static_cast<double>(found[0].worst_at.pose) + found[0].worst_at.fraction) * way;
    EXPECT_GT(moved, gap - 5 * allowed);
    EXPECT_LT(moved, gap + fin + tab);
    const double low = 2 + fin + gap - 5 * allowed, high = 2 + fin + gap + tab + 5 * allowed;
    EXPECT_TRUE(low <= place.x && place.x <= high) << place.x << " " << low << " " << high;
    EXPECT_TRUE(low <= foot.x && foot.x <= high) << foot.x << " " << low << " " << high;
    EXPECT_LE(glm::length(place - foot), 5 * allowed);
  }
  EXPECT_GT(passed, 8);
}

// A sheet is pressed onto a shaft that is thicker than it: all along the edge of its hole the shaft
// is deeper than half of the sheet. It still comes off.
TEST(SeatWalls, AThinSheetComesOffTheShaftThatItIsPressedOn) {
  Surface shaft = test::ring_surface(24, 10.3, 30);
  for (std::uint32_t a = 2; a + 2 < shaft.vertices_m.size(); a += 2) {
    shaft.triangles.push_back({0, a + 2, a});
    shaft.triangles.push_back({1, a + 1, a + 3});
  }
  shaft.object.assign(shaft.triangles.size(), 1);
  Surface sheet;
  for (const double r : {10.0, 20.0}) {
    const Surface ring = test::ring_surface(24, r, 0.2);
    sheet.vertices_m.insert(sheet.vertices_m.end(), ring.vertices_m.begin(), ring.vertices_m.end());
    for (const mesh::Triangle& t : ring.triangles) {
      sheet.triangles.push_back(r < 15 ? mesh::Triangle{t[0], t[2], t[1]}
                                       : mesh::Triangle{t[0] + 48, t[1] + 48, t[2] + 48});
    }
  }
  for (std::uint32_t a = 0; a < 48; a += 2) {
    const std::uint32_t b = (a + 2) % 48;
    sheet.triangles.push_back({a, b + 48, a + 48}), sheet.triangles.push_back({a, b, b + 48});
    sheet.triangles.push_back({a + 1, a + 49, b + 49}),
        sheet.triangles.push_back({a + 1, b + 49, b + 1});
  }
  sheet.object.assign(sheet.triangles.size(), 1);
  std::mt19937 random(67);
  const Pose frame = any_frame(random);
  EXPECT_TRUE(stretches_of(sheet, shaft, {0, 0, 40}, 0, 0.301, frame).empty());
  EXPECT_TRUE(stretches_of(shaft, sheet, {0, 0, 40}, 0, 0.301, frame).empty());
}

}  // namespace
}  // namespace forcelayer::exact
