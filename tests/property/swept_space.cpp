// The surface of a swept space: of random parts along random paths with turns, all points at all
// times are inside. It is closed and manifold, faces outward, and is at most a voxel from the true
// swept space but for one point in a hundred. The motion, the inside test (crossings of a ray) and
// the distances are those of this file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <set>

#include "formats/voxinfo/surface.h"
#include "tests/support/baked_scene.h"
#include "tests/support/random_numbers.h"
#include "tests/support/sanitized.h"
#include "tests/support/soups.h"
#include "voxelize/sweep/inner_triangles.h"
#include "voxelize/sweep/motion_center.h"
#include "voxelize/sweep/swept_mesh.h"

namespace forcelayer {
namespace {

using glm::dvec3;
using test::Random;
using test::uniform;

dvec3 vec(const mesh::Vec3d& v) { return {v[0], v[1], v[2]}; }

// A part in voxels of 1 m with its center, which is known from its form.
struct Body {
  const char* name;
  mesh::Mesh mesh;
  dvec3 center{0};
  double size = 0;
};

Body body(int kind, Random& random) {
  Body made;
  const dvec3 at(uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -9, 9));
  const mesh::Vec3d center{at.x, at.y, at.z};
  const auto box = [&](const dvec3& half, unsigned missing) {
    reference::add_box(made.mesh, {at.x - half.x, at.y - half.y, at.z - half.z},
                       {at.x + half.x, at.y + half.y, at.z + half.z}, missing);
    made.size = glm::length(half);
  };
  made.center = at;
  const double a = uniform(random, 2, 9), b = uniform(random, 2, 9), c = uniform(random, 2, 9);
  switch (kind) {
    case 0:
      made.name = "box";
      box({a, b, c}, 0);
      break;
    case 1:
      made.name = "ball";
      reference::add_sphere(made.mesh, center, a, 4);
      made.size = a;
      break;
    case 2:
      made.name = "plate thinner than a voxel";
      box({a, b, 0.1}, 0);
      break;
    case 3:
      made.name = "needle";
      box({0.05, 0.05, 2 * c}, 0);
      break;
    default:
      // Opposite faces: the center of their area is that of the box.
      made.name = "open sheets";
      box({a, b, c}, 0b111100);
  }
  return made;
}

// The part's pose at a time from 0 to rows - 1: the center goes straight, and the part turns evenly
// the short way round.
struct Motion {
  std::vector<PathRow> rows;
  dvec3 center;

  dvec3 at(const dvec3& p, double time) const {
    const auto row = std::min(static_cast<std::size_t>(time), rows.size() - 2);
    const double f = time - static_cast<double>(row);
    const auto turn = [&](const PathRow& r) {
      const auto& q = r.orientation_wxyz;
      return glm::dquat(q[0], q[1], q[2], q[3]);
    };
    const glm::dquat from = turn(rows[row]), to = turn(rows[row + 1]);
    const dvec3 a = vec(rows[row].position_m) + from * center,
                b = vec(rows[row + 1].position_m) + to * center;
    return glm::mix(a, b, f) + glm::slerp(from, to, f) * (p - center);
  }
  double end() const { return static_cast<double>(rows.size() - 1); }
};

Motion random_motion(const Body& part, Random& random) {
  Motion motion{{}, part.center};
  const auto rows = test::integer(random, 2, 5);
  const bool turns = random() % 4 != 0;
  glm::dquat orientation = test::random_orientation(random);
  dvec3 center = test::random_direction(random) * uniform(random, 0, 40);
  for (std::int64_t i = 0; i < rows; ++i) {
    const dvec3 position = center - orientation * part.center;
    motion.rows.push_back({static_cast<double>(i),
                           {position.x, position.y, position.z},
                           {orientation.w, orientation.x, orientation.y, orientation.z}});
    center += test::random_direction(random) * uniform(random, 0, 12);
    if (turns) {
      orientation =
          glm::angleAxis(uniform(random, 0, 2), test::random_direction(random)) * orientation;
    }
  }
  return motion;
}

dvec3 random_point(const mesh::Mesh& mesh, Random& random) {
  const auto& t = mesh.triangles[random() % mesh.triangles.size()];
  double u = uniform(random, 0, 1), v = uniform(random, 0, 1);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const dvec3 a = vec(mesh.vertices[t[0]]);
  return a + u * (vec(mesh.vertices[t[1]]) - a) + v * (vec(mesh.vertices[t[2]]) - a);
}

// The surface with its triangles by the columns of voxels that they touch.
class Inside {
 public:
  explicit Inside(const voxinfo::SolidSurface& surface) : surface_(surface) {
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      dvec3 low(INFINITY), high(-INFINITY);
      for (const std::uint32_t n : surface.triangles[t]) {
        low = glm::min(low, vec(surface.vertices_m[n]));
        high = glm::max(high, vec(surface.vertices_m[n]));
      }
      for (auto x = std::floor(low.x); x <= high.x; ++x) {
        for (auto y = std::floor(low.y); y <= high.y; ++y) columns_[{x, y}].push_back(t);
      }
    }
  }

  // How often the surface winds around a point: +1 for each face above it that looks up.
  int windings(const dvec3& p) const {
    const auto column = columns_.find({std::floor(p.x), std::floor(p.y)});
    if (column == columns_.end()) return 0;
    int count = 0;
    for (const std::size_t t : column->second) {
      const auto& [na, nb, nc] = surface_.triangles[t];
      const dvec3 a = vec(surface_.vertices_m[na]) - p, b = vec(surface_.vertices_m[nb]) - p,
                  c = vec(surface_.vertices_m[nc]) - p;
      const double ab = a.x * b.y - a.y * b.x, bc = b.x * c.y - b.y * c.x,
                   ca = c.x * a.y - c.y * a.x;
      const bool up = ab > 0 && bc > 0 && ca > 0, down = ab < 0 && bc < 0 && ca < 0;
      if (!up && !down) continue;
      if ((bc * a.z + ca * b.z + ab * c.z) / (ab + bc + ca) > 0) count += up ? 1 : -1;
    }
    return count;
  }

 private:
  const voxinfo::SolidSurface& surface_;
  std::map<std::pair<double, double>, std::vector<std::size_t>> columns_;
};

// Ericson, "Real-Time Collision Detection", 5.1.5.
double distance(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
  const auto to_segment = [&](const dvec3& from, const dvec3& to) {
    const dvec3 along = to - from;
    const double t = std::clamp(glm::dot(p - from, along) / glm::dot(along, along), 0.0, 1.0);
    return glm::length(p - (from + t * along));
  };
  const dvec3 normal = glm::cross(b - a, c - a);
  const auto beside = [&](const dvec3& from, const dvec3& to) {
    return glm::dot(glm::cross(normal, to - from), p - from) >= 0;
  };
  if (beside(a, b) && beside(b, c) && beside(c, a)) {
    return std::abs(glm::dot(p - a, normal)) / glm::length(normal);
  }
  return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

// The distance of a point from the moving part, at most half the travel between two times too much.
// Times are left out at which the part cannot be nearer than it was before.
double distance_from_sweep(const dvec3& p, const Body& part, const Motion& motion) {
  constexpr int kTimes = 2000;
  // A row moves the center by up to 12 m and turns the part by up to 2 rad.
  const double travel = (12 + 2 * part.size) * motion.end() / kTimes;
  double least = INFINITY;
  std::vector<dvec3> placed(part.mesh.vertices.size());
  for (int n = 0; n <= kTimes;) {
    const double time = motion.end() * n / kTimes;
    double now = glm::length(p - motion.at(part.center, time)) - part.size;
    if (now < least) {
      for (std::size_t v = 0; v < placed.size(); ++v) {
        placed[v] = motion.at(vec(part.mesh.vertices[v]), time);
      }
      now = INFINITY;
      for (const auto& [a, b, c] : part.mesh.triangles) {
        now = std::min(now, distance(p, placed[a], placed[b], placed[c]));
      }
      least = std::min(least, now);
    }
    n += 1 + static_cast<int>((now - least) / travel);
  }
  return least;
}

void expect_closed_manifold(const voxinfo::SolidSurface& surface) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  double volume = 0;
  for (const auto& t : surface.triangles) {
    for (std::size_t n = 0; n < 3; ++n) {
      EXPECT_TRUE(edges.insert({t[n], t[(n + 1) % 3]}).second);
    }
    volume += glm::dot(vec(surface.vertices_m[t[0]]),
                       glm::cross(vec(surface.vertices_m[t[1]]), vec(surface.vertices_m[t[2]])));
  }
  for (const auto& [from, to] : edges) EXPECT_TRUE(edges.contains({to, from}));
  EXPECT_GT(volume, 0);
  // Around each vertex the triangles form one ring: as many as can be reached from one of them.
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(surface.vertices_m.size());
  for (const auto& [a, b, c] : surface.triangles) {
    next[a][b] = c, next[b][c] = a, next[c][a] = b;
  }
  for (const auto& around : next) {
    std::size_t reached = 0;
    std::uint32_t at = around.begin()->first;
    do {
      at = around.at(at);
      ++reached;
    } while (at != around.begin()->first && reached <= around.size());
    EXPECT_EQ(reached, around.size());
  }
  // As floats, too, no two vertices are at one position.
  std::set<std::array<float, 3>> positions;
  for (const auto& [x, y, z] : surface.vertices_m) {
    positions.insert({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
  }
  EXPECT_EQ(positions.size(), surface.vertices_m.size());
}

TEST(SweptSpace, ContainsThePartAtAllTimesAndLittleElse) {
  std::vector<double> excess;
  for (std::uint64_t seed = 1; seed <= 15; seed += test::seed_step(4)) {
    Random random(seed);
    const Body part = body(static_cast<int>(seed % 5), random);
    const Motion motion = random_motion(part, random);
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", " << part.name);
    const sweep::MotionCenter center = sweep::motion_center(std::span(&part.mesh, 1));
    EXPECT_EQ(center.uncertainty_m, 0);
    EXPECT_LT(glm::length(vec(center.at_m) - part.center), 1e-9);
    auto swept = sweep::sweep_mesh(part.mesh, motion.rows, center.at_m, 1, part.name);
    ASSERT_TRUE(swept) << swept.error().what;
    ASSERT_TRUE(sweep::drop_inner_triangles(swept->mesh, 1, part.name));
    EXPECT_LE(swept->deviation_m, 0.07);
    voxelize::BakeOptions options = reference::options_with(2, 1, Metric::kEuclidean);
    const voxelize::SceneObject object{part.name, &swept->mesh, {}, {}, swept->deviation_m,
                                       {},        {},           0,  0};
    const reference::BakedScene file({object}, options);
    const double offset = seed % 3 == 0 ? 1.5 : 0;
    const auto surface = voxinfo::solid_surface(file.map(), offset, true, "swept.vox");
    ASSERT_TRUE(surface) << surface.error().what;
    expect_closed_manifold(*surface);

    const Inside inside(*surface);
    int outside = 0;
    for (int n = 0; n < 20'000; ++n) {
      dvec3 p = motion.at(random_point(part.mesh, random), uniform(random, 0, motion.end()));
      p += test::random_direction(random) * offset;
      outside += inside.windings(p) == 1 ? 0 : 1;
    }
    EXPECT_EQ(outside, 0);
    for (int n = 0; n < 100; ++n) {
      const auto& t = surface->triangles[random() % surface->triangles.size()];
      const dvec3 p = (vec(surface->vertices_m[t[0]]) + vec(surface->vertices_m[t[1]]) +
                       vec(surface->vertices_m[t[2]])) /
                      3.0;
      const double beyond = distance_from_sweep(p, part, motion) - offset;
      EXPECT_GT(beyond, 0);
      excess.push_back(beyond);
    }
  }
  std::sort(excess.begin(), excess.end());
  RecordProperty("p50", std::to_string(excess[excess.size() / 2]));
  RecordProperty("p99", std::to_string(excess[excess.size() * 99 / 100]));
  if (test::kSanitized) return;  // a few of the paths do not tell the percentile of all
  EXPECT_LE(excess[excess.size() * 99 / 100], 1);
}

// At all times the corners of the part are in the box of the swept space, but for its deviation.
void expect_in_swept_box(const mesh::Mesh& part, const Motion& motion,
                         const sweep::SweptMesh& swept) {
  dvec3 low(INFINITY), high(-INFINITY);
  for (const mesh::Vec3d& vertex : swept.mesh.vertices) {
    low = glm::min(low, vec(vertex));
    high = glm::max(high, vec(vertex));
  }
  double outside = 0;
  for (std::size_t row = 0; row + 1 < motion.rows.size(); ++row) {
    constexpr int kTimes = 16;
    for (int n = 0; n <= kTimes; ++n) {
      const double time = static_cast<double>(row) + (n - 1e-9 * n) / kTimes;
      for (const mesh::Vec3d& vertex : part.vertices) {
        const dvec3 p = motion.at(vec(vertex), time);
        for (int d = 0; d < 3; ++d) outside = std::max({outside, low[d] - p[d], p[d] - high[d]});
      }
    }
  }
  EXPECT_LE(outside, swept.deviation_m);
}

void add_row(Motion& motion, const dvec3& center, const glm::dquat& turn) {
  const dvec3 position = center - turn * motion.center;
  motion.rows.push_back({static_cast<double>(motion.rows.size()),
                         {position.x, position.y, position.z},
                         {turn.w, turn.x, turn.y, turn.z}});
}

// The rows before and after the turn are less apart from its thinned path than the voxels can show,
// but without them the short way round is the other one.
TEST(SweptSpace, TakesAHalfTurnTheSameWayRound) {
  for (std::uint64_t seed = 1; seed <= 20; seed += test::seed_step(3)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const dvec3 center(uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -9, 9));
    const glm::dquat begin = test::random_orientation(random);
    const dvec3 axis = test::random_direction(random);
    const dvec3 arm =
        glm::normalize(glm::cross(axis, test::random_direction(random))) * 8.0 + center;
    mesh::Mesh part;
    reference::add_box(part, {arm.x - 1, arm.y - 1, arm.z - 1}, {arm.x + 1, arm.y + 1, arm.z + 1});
    Motion motion{{}, center};
    const double sign = random() % 2 == 0 ? 1 : -1;
    const auto jitter = [&](double turn_rad) {
      add_row(motion, {}, begin * glm::angleAxis(sign * turn_rad, axis));
    };
    const double most = std::pow(10, uniform(random, -14, -4));
    const auto before = test::integer(random, 1, 4), after = test::integer(random, 0, 3);
    jitter(0);
    for (std::int64_t n = 1; n <= before; ++n) {
      jitter(most * static_cast<double>(n) / static_cast<double>(before));
    }
    // Less than half a turn from the last row, more from the first one.
    jitter(glm::pi<double>() + most / 2);
    for (std::int64_t n = 0; n < after; ++n) {
      jitter(glm::pi<double>() + uniform(random, 0, 1) * most);
    }
    // Far away, such small turns are less than the rounding of the travel.
    if (seed % 2 == 0) {
      Motion far{{}, center};
      add_row(far, {1e6, 0, 0}, begin);
      motion.rows.insert(motion.rows.begin(), far.rows.front());
    }
    const auto swept = sweep::sweep_mesh(part, motion.rows, {center.x, center.y, center.z}, 1, "");
    ASSERT_TRUE(swept) << swept.error().what;
    expect_in_swept_box(part, motion, *swept);
  }
}

// Most rows of a dense path with noise are left out, and the deviation covers them.
TEST(SweptSpace, CoversTheRowsOfANoisyPathThatAreLeftOut) {
  for (std::uint64_t seed = 1; seed <= 20; seed += test::seed_step(3)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const dvec3 center(uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -9, 9));
    mesh::Mesh part;
    reference::add_box(part, {center.x - 6, center.y - 5, center.z - 4},
                       {center.x + 6, center.y + 5, center.z + 4});
    Motion motion{{}, center};
    const double noise = uniform(random, 0.01, 0.05);
    const double turn = seed % 2 == 0 ? 0.2 * noise / 6 : 0;
    const dvec3 direction = test::random_direction(random);
    constexpr int kRows = 1000;
    for (int n = 0; n < kRows; ++n) {
      add_row(motion,
              direction * (4.0 * n / kRows) +
                  test::random_direction(random) * uniform(random, 0, noise),
              glm::angleAxis(uniform(random, 0, turn), test::random_direction(random)));
    }
    const auto swept = sweep::sweep_mesh(part, motion.rows, {center.x, center.y, center.z}, 1, "");
    ASSERT_TRUE(swept) << swept.error().what;
    EXPECT_LT(swept->poses, kRows / 4);
    EXPECT_LE(swept->deviation_m, 0.15);
    expect_in_swept_box(part, motion, *swept);
  }
}

TEST(SweptSpace, IsRefusedWhereThePartHasTooManyTriangles) {
  mesh::Mesh part;
  reference::add_box(part, {0, 0, 0}, {1e9, 1e9, 1});
  Motion motion{{}, {5e8, 5e8, 0.5}};
  add_row(motion, {}, glm::dquat(1, 0, 0, 0));
  add_row(motion, {}, glm::angleAxis(1e-6, dvec3(0, 0, 1)));
  const auto swept = sweep::sweep_mesh(part, motion.rows, {5e8, 5e8, 0.5}, 1, "plate");
  ASSERT_FALSE(swept);
  EXPECT_EQ(swept.error().code, ErrorCode::kBakeTooLarge);
}

// The triangles on the outside stay, however far apart they are.
TEST(SweptSpace, KeepsTheOuterTrianglesOfBodiesFarApart) {
  mesh::Mesh bodies;
  const double apart = 1 << 24;
  reference::add_box(bodies, {0.2, 0.2, 0.2}, {2.8, 2.8, 2.8});
  reference::add_box(bodies, {apart + 3.2, 3.2, 3.2}, {apart + 6.8, 6.8, 6.8});
  const std::size_t triangles = bodies.triangles.size();
  ASSERT_TRUE(sweep::drop_inner_triangles(bodies, 1, "bodies"));
  EXPECT_EQ(bodies.triangles.size(), triangles);
}

}  // namespace
}  // namespace forcelayer
