// The clearance at the vertices of a map against a slow twin: the distance from each vertex to
// every triangle of the other body, at densely sampled moments of random paths. The motion, the
// distances and the winding numbers are those of this file.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numbers>

#include "tests/support/random_numbers.h"
#include "tests/support/sanitized.h"
#include "tests/support/soups.h"
#include "workbench/exact/map/clearance_map.h"
#include "workbench/exact/map/color_scale.h"
#include "workbench/exact/map/split.h"
#include "workbench/exact/mesh_distance.h"

namespace forcelayer::exact {
namespace {

using glm::dvec3;
using test::Random;
using test::uniform;
using Place = std::array<float, 3>;

dvec3 vec(const Place& p) { return {p[0], p[1], p[2]}; }

double to_segment_m(const dvec3& p, const dvec3& a, const dvec3& b) {
  const dvec3 d = b - a;
  return glm::length(p - a - std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0) * d);
}

double to_triangle_m(const dvec3& p, const std::array<dvec3, 3>& t) {
  const dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  bool above = true;
  double least_m = 1e30;
  for (std::size_t n = 0; n < 3; ++n) {
    const dvec3 &a = t[n], &b = t[(n + 1) % 3];
    above = above && glm::dot(glm::cross(normal, b - a), p - a) >= 0;
    least_m = std::min(least_m, to_segment_m(p, a, b));
  }
  return above ? std::abs(glm::dot(normal, p - t[0])) / glm::length(normal) : least_m;
}

// How often a triangle winds around a place (van Oosterom and Strackee 1983).
double winding(const dvec3& p, const std::array<dvec3, 3>& t) {
  const dvec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  return std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc +
                                                       glm::dot(b, c) * la + glm::dot(c, a) * lb) /
         (2 * std::numbers::pi);
}

// Adds a closed mesh as the next object. Equal vertices become one.
void add_object(Surface& surface, const mesh::Mesh& mesh) {
  const std::uint32_t object = surface.object.empty() ? 1 : surface.object.back() + 1;
  std::map<std::array<double, 3>, std::uint32_t> numbers;
  for (const mesh::Triangle& t : mesh.triangles) {
    mesh::Triangle own{};
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& v = mesh.vertices[t[n]];
      const auto [entry, is_new] = numbers.try_emplace(
          {v[0], v[1], v[2]}, static_cast<std::uint32_t>(surface.vertices_m.size()));
      if (is_new) surface.vertices_m.push_back({v[0], v[1], v[2]});
      for (const double x : v) surface.largest_m = std::max(surface.largest_m, std::abs(x));
      own[n] = entry->second;
    }
    if (own[0] == own[1] || own[1] == own[2] || own[2] == own[0]) continue;
    surface.triangles.push_back(own);
    surface.object.push_back(object);
  }
}

mesh::Mesh random_body(Random& random, const dvec3& at_m, double size_m) {
  mesh::Mesh mesh;
  if (random() % 2 == 0) {
    const dvec3 half(uniform(random, 0.1, 1) * size_m, uniform(random, 0.1, 1) * size_m,
                     uniform(random, 0.1, 1) * size_m);
    const dvec3 low = at_m - half, high = at_m + half;
    reference::add_box(mesh, {low.x, low.y, low.z}, {high.x, high.y, high.z});
  } else {
    reference::add_sphere(mesh, {at_m.x, at_m.y, at_m.z}, uniform(random, 0.3, 1) * size_m, 4);
  }
  return mesh;
}

mesh::GlbNode node_of(const Surface& surface, std::uint32_t object) {
  mesh::GlbNode node;
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (std::size_t n = 0; n < surface.triangles.size(); ++n) {
    if (surface.object[n] != object) continue;
    mesh::Triangle own{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = surface.triangles[n][corner];
      const auto [entry, is_new] =
          numbers.try_emplace(vertex, static_cast<std::uint32_t>(node.vertices_m.size()));
      const dvec3& v = surface.vertices_m[vertex];
      if (is_new) {
        node.vertices_m.push_back(
            {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
      }
      own[corner] = entry->second;
    }
    node.triangles.push_back(own);
  }
  return node;
}

std::vector<PathRow> random_path(Random& random, double length_m) {
  std::vector<PathRow> rows;
  dvec3 at_m = length_m * 0.5 * test::random_direction(random);
  glm::dquat turned = test::random_orientation(random);
  const auto count = test::integer(random, 1, 6);
  for (std::int64_t n = 0; n < count; ++n) {
    rows.push_back({static_cast<double>(n),
                    {at_m.x, at_m.y, at_m.z},
                    {turned.w, turned.x, turned.y, turned.z}});
    at_m += uniform(random, 0, 0.6) * length_m * test::random_direction(random);
    const double turn_rad = random() % 3 == 0 ? 0 : uniform(random, 0, 1.5);
    turned = glm::angleAxis(turn_rad, test::random_direction(random)) * turned;
  }
  return rows;
}

// The part's pose between two rows, as the documents define it.
Pose pose_between(const PathRow& a, const PathRow& b, double fraction) {
  const auto& p = a.position_m;
  const auto& q = b.position_m;
  const auto& o = a.orientation_wxyz;
  const auto& w = b.orientation_wxyz;
  return {
      glm::mix(dvec3(p[0], p[1], p[2]), dvec3(q[0], q[1], q[2]), fraction),
      glm::slerp(glm::dquat(o[0], o[1], o[2], o[3]), glm::dquat(w[0], w[1], w[2], w[3]), fraction)};
}

std::vector<Pose> sampled(const std::vector<PathRow>& rows, int per_step) {
  std::vector<Pose> poses{pose_between(rows[0], rows[0], 0)};
  for (std::size_t n = 1; n < rows.size(); ++n) {
    for (int k = 1; k <= per_step; ++k) {
      poses.push_back(pose_between(rows[n - 1], rows[n], static_cast<double>(k) / per_step));
    }
  }
  return poses;
}

std::vector<std::array<dvec3, 3>> triangles_of(const Surface& surface) {
  std::vector<std::array<dvec3, 3>> all;
  for (const mesh::Triangle& t : surface.triangles) {
    all.push_back({surface.vertices_m[t[0]], surface.vertices_m[t[1]], surface.vertices_m[t[2]]});
  }
  return all;
}

TEST(ClearanceMap, IsNeverAboveTheLeastDistanceOfAllMomentsAndHardlyBelow) {
  constexpr int kPerStep = 100;
  std::uint64_t samples = 0;
  std::size_t vertices = 0, zero = 0, reached = 0;
  std::vector<double> below_voxels;
  const std::uint64_t kTrials = 40;
  for (std::uint64_t seed = 1; seed <= kTrials; seed += test::seed_step(13)) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Surface scene, part;
    const double size_m = std::pow(10.0, uniform(random, -3, 1));
    const auto objects = test::integer(random, 1, 3);
    for (std::int64_t n = 0; n < objects; ++n) {
      const dvec3 at_m = uniform(random, 0, 1.5) * size_m * test::random_direction(random);
      add_object(scene, random_body(random, at_m, size_m));
    }
    add_object(part, random_body(random, {}, uniform(random, 0.2, 1) * size_m));
    const std::vector<PathRow> rows = random_path(random, 2 * size_m);
    const clearance::CenterPath path(rows, {0, 0, 0}, (1 + 1e-6) * radius_m(part));
    const double voxel_m = uniform(random, 0.02, 0.1) * size_m;
    const double required_m = seed % 4 == 0 ? 0 : uniform(random, 0.02, 0.3) * size_m;
    MapScale scale = scale_of(required_m, voxel_m, kRounding * largest_m(scene, part, rows));
    const double wanted_m = scale.edge_m;

    MovingScene moving;
    moving.nodes.push_back(node_of(part, 1));
    moving.objects.push_back(0);
    for (std::uint32_t n = 1; n <= scene.object.back(); ++n) {
      moving.nodes.push_back(node_of(scene, n));
      moving.objects.push_back(n);
    }
    moving.away_m.resize(moving.nodes.size(), 0);
    color_by_clearance(moving, scene, part, path, scale, 600, [](double) {});
    EXPECT_GE(scale.edge_m, wanted_m);
    EXPECT_LE(scale.within_m, voxel_m);

    const std::vector<Pose> poses = sampled(rows, kPerStep);
    const auto of_scene = triangles_of(scene), of_part = triangles_of(part);
    for (std::size_t n = 0; n < moving.nodes.size(); ++n) {
      const mesh::GlbNode& node = moving.nodes[n];
      ASSERT_EQ(node.clearance_m.size(), node.vertices_m.size());
      ASSERT_EQ(node.colors.size(), node.vertices_m.size());
      const auto& other = n == 0 ? of_scene : of_part;
      const auto step = 1 + static_cast<std::size_t>(random() % 3);  // of the vertices, some
      for (std::size_t v = random() % step; v < node.vertices_m.size(); v += step) {
        const double clearance_m = node.clearance_m[v];
        double least_m = 1e30;
        std::map<std::uint32_t, double> windings;  // of the objects: spheres have their inside out
        for (std::size_t p = 0; p < poses.size(); ++p) {
          const Pose pose = n == 0 ? poses[p] : inverse(poses[p]);
          const dvec3 place_m = pose.position_m + pose.orientation * vec(node.vertices_m[v]);
          for (std::size_t t = 0; t < other.size(); ++t) {
            least_m = std::min(least_m, to_triangle_m(place_m, other[t]));
            const Surface& surface = n == 0 ? scene : part;
            if (p == 0) windings[surface.object[t]] += winding(place_m, other[t]);
          }
          ++samples;
        }
        ++vertices;
        for (const auto& [object, times] : windings) {
          if (std::abs(times) > 0.5) least_m = 0;
        }
        const double shown_m = std::min(least_m, scale.reach_m);
        ASSERT_LE(clearance_m, shown_m) << "vertex " << v << " of node " << n;
        below_voxels.push_back((shown_m - clearance_m) / voxel_m);
        zero += clearance_m == 0;
        reached += clearance_m >= static_cast<float>(scale.reach_m) * (1 - 1e-6);
        const auto gray = linear_rgba(kBeyondScale);
        if (clearance_m < scale.reach_m / 2) {
          EXPECT_NE(node.colors[v], gray);
        }
      }
    }
  }
  std::ranges::sort(below_voxels);
  const double p99 = below_voxels[below_voxels.size() * 99 / 100];
  RecordProperty("samples", std::to_string(samples));
  RecordProperty("p99_voxels", std::to_string(p99));
  EXPECT_LE(p99, 1) << "of " << below_voxels.size() << " vertices";
  // Sampled moments miss the least distance, so the rest may be below by more than it is.
  EXPECT_LE(below_voxels.back(), 2);
  // All kinds of vertices are there.
  EXPECT_GT(zero, vertices / 50);
  EXPECT_GT(reached, vertices / 50);
  EXPECT_LT(zero + reached, vertices * 9 / 10);
  if (!test::kSanitized) {
    EXPECT_GE(samples, 1'000'000u);
  }
}

// Along a path that does not turn, the clearance is the distance itself: sampled moments are nearer
// to it than half of the way between two of them.
TEST(ClearanceMap, IsExactAlongAPathThatDoesNotTurn) {
  constexpr int kPerStep = 200;
  std::size_t vertices = 0, between = 0;
  for (std::uint64_t seed = 1; seed <= 30; seed += test::seed_step(11)) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Surface scene, part;
    add_object(scene, random_body(random, {}, 1));
    add_object(part, random_body(random, {}, uniform(random, 0.2, 1)));
    const glm::dquat turned = test::random_orientation(random);
    dvec3 at_m = 2.0 * test::random_direction(random);
    std::vector<PathRow> rows;
    double longest_m = 0;
    for (std::int64_t n = 0; n < test::integer(random, 1, 4); ++n) {
      rows.push_back({static_cast<double>(n),
                      {at_m.x, at_m.y, at_m.z},
                      {turned.w, turned.x, turned.y, turned.z}});
      dvec3 way = test::random_direction(random);
      if (random() % 2 == 0) way = {0, 0, way.z};
      at_m += way;
      longest_m = std::max(longest_m, glm::length(way));
    }
    const clearance::CenterPath path(rows, {0, 0, 0}, (1 + 1e-6) * radius_m(part));
    MovingScene moving;
    moving.nodes = {node_of(part, 1), node_of(scene, 1)};
    moving.objects = {0, 1}, moving.away_m = {0, 0};
    MapScale scale = scale_of(0.3, 0.1, kRounding * largest_m(scene, part, rows));
    color_by_clearance(moving, scene, part, path, scale, 200, [](double) {});
    const std::vector<Pose> poses = sampled(rows, kPerStep);
    const auto of_scene = triangles_of(scene), of_part = triangles_of(part);
    for (std::size_t n = 0; n < 2; ++n) {
      const mesh::GlbNode& node = moving.nodes[n];
      for (std::size_t v = 0; v < node.vertices_m.size(); v += 1 + random() % 5) {
        double least_m = 1e30, windings = 0;
        for (std::size_t p = 0; p < poses.size(); ++p) {
          const Pose pose = n == 0 ? poses[p] : inverse(poses[p]);
          const dvec3 place_m = pose.position_m + pose.orientation * vec(node.vertices_m[v]);
          for (const auto& triangle : n == 0 ? of_scene : of_part) {
            least_m = std::min(least_m, to_triangle_m(place_m, triangle));
            if (p == 0) windings += winding(place_m, triangle);
          }
        }
        if (std::abs(windings) > 0.5) least_m = 0;
        const double shown_m = std::min(least_m, scale.reach_m);
        ASSERT_LE(node.clearance_m[v], shown_m) << "vertex " << v << " of node " << n;
        // 32-bit floats hold seven digits.
        ASSERT_GE(node.clearance_m[v], shown_m - longest_m / (2 * kPerStep) - 1e-6);
        between += shown_m > 0 && shown_m < scale.reach_m;
        ++vertices;
      }
    }
  }
  EXPECT_GT(between, vertices / 10);
}

// A gap far smaller than scale.within_m, along all of the way.
TEST(ClearanceMap, ShowsTheSmallGapOfAPartThatSlides) {
  constexpr double kGapM = 1e-4;
  Surface scene, part;
  mesh::Mesh below, slider;
  reference::add_box(below, {-1, -1, -1}, {1, 1, 0});
  reference::add_box(slider, {-0.1, -0.1, 0}, {0.1, 0.1, 0.2});
  add_object(scene, below), add_object(part, slider);
  const std::vector<PathRow> rows{{0, {-0.5, 0, kGapM}, {1, 0, 0, 0}},
                                  {1, {0.5, 0.3, kGapM}, {1, 0, 0, 0}}};
  const clearance::CenterPath path(rows, {0, 0, 0}, (1 + 1e-6) * radius_m(part));
  MovingScene moving;
  moving.nodes = {node_of(part, 1)};
  moving.objects = {0}, moving.away_m = {0};
  MapScale scale = scale_of(0.05, 0.01, 0);
  ASSERT_GT(scale.within_m, 10 * kGapM);
  color_by_clearance(moving, scene, part, path, scale, 10'000, [](double) {});
  for (std::size_t v = 0; v < moving.nodes[0].vertices_m.size(); ++v) {
    const double up_m = moving.nodes[0].vertices_m[v][2] + kGapM;
    EXPECT_NEAR(moving.nodes[0].clearance_m[v], std::min(up_m, scale.reach_m), 1e-7);
  }
}

// A vertex that is deep in a solid all the time is near none of its faces.
TEST(ClearanceMap, IsZeroInsideOfASolid) {
  Surface scene, part;
  mesh::Mesh large, small;
  reference::add_box(large, {-1, -1, -1}, {1, 1, 1});
  reference::add_box(small, {-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1});
  add_object(scene, large), add_object(part, small);
  const std::vector<PathRow> rows{{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {0.2, 0, 0}, {1, 0, 0, 0}}};
  const clearance::CenterPath path(rows, {0, 0, 0}, (1 + 1e-6) * radius_m(part));
  MovingScene moving;
  moving.nodes = {node_of(part, 1), node_of(scene, 1)};
  moving.objects = {0, 1}, moving.away_m = {0, 0};
  MapScale scale = scale_of(0.05, 0.01, 0);
  color_by_clearance(moving, scene, part, path, scale, 10'000, [](double) {});
  for (const float clearance_m : moving.nodes[0].clearance_m) EXPECT_EQ(clearance_m, 0);
  for (const float clearance_m : moving.nodes[1].clearance_m) EXPECT_GT(clearance_m, 0.19f);
}

// Halved edges keep a closed surface closed, in its place, and on its side.
TEST(ClearanceMap, SplitTrianglesCoverTheSameSurface) {
  std::size_t added = 0;
  const std::uint64_t kTrials = 30;
  for (std::uint64_t seed = 1; seed <= kTrials; seed += test::seed_step(7)) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Surface surface;
    add_object(surface, random_body(random, {}, 1));
    SplitMesh mesh(node_of(surface, 1));
    const std::size_t vertices = mesh.node.vertices_m.size();
    const auto measured = [](const mesh::GlbNode& node) {
      double area = 0, volume_m3 = 0;
      for (const mesh::Triangle& t : node.triangles) {
        const dvec3 a = vec(node.vertices_m[t[0]]), b = vec(node.vertices_m[t[1]]),
                    c = vec(node.vertices_m[t[2]]);
        area += glm::length(glm::cross(b - a, c - a)) / 2;
        volume_m3 += glm::dot(a, glm::cross(b, c)) / 6;
      }
      return std::pair(area, volume_m3);
    };
    const auto before = measured(mesh.node);
    const dvec3 middle = test::random_direction(random);
    const double near_m = uniform(random, 0.1, 1.5), edge_m = uniform(random, 0.05, 0.5);
    const auto is_near = [&](const Place& center, double radius_m) {
      return glm::length(vec(center) - middle) < near_m + radius_m;
    };
    split_edges(mesh, edge_m, is_near);
    ASSERT_EQ(mesh.is_far.size(), mesh.node.triangles.size());
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
    for (const mesh::Triangle& t : mesh.node.triangles) {
      bool is_long = false, reaches = false;
      for (std::size_t n = 0; n < 3; ++n) {
        const std::uint32_t a = t[n], b = t[(n + 1) % 3];
        ++balance[{a, b}], --balance[{b, a}];
        const dvec3 from = vec(mesh.node.vertices_m[a]), to = vec(mesh.node.vertices_m[b]);
        is_long |= glm::length(to - from) > edge_m;
        reaches |= glm::length(from - middle) < near_m;
      }
      EXPECT_FALSE(is_long && reaches);
    }
    for (const auto& [edge, sum] : balance) ASSERT_EQ(sum, 0);
    EXPECT_NEAR(measured(mesh.node).first, before.first, 1e-5);
    EXPECT_NEAR(measured(mesh.node).second, before.second, 1e-5);
    added += mesh.node.vertices_m.size() - vertices;
  }
  EXPECT_GT(added, 1000u);
}

// The lightness (CIE 1976 L*) grows from step to step by about the same, so that the order of
// colors is seen in gray, too. Each color of the scale differs from the one behind its end.
TEST(ColorScale, GetsEvenlyLighter) {
  const auto lightness = [](const Rgb& color) {
    const auto linear = linear_rgba(color);
    const double y = (0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]) / 255;
    return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
  };
  const double last = std::nextafter(1, 0),
               whole = lightness(color_at(last)) - lightness(color_at(0));
  EXPECT_GT(whole, 70);
  constexpr int kSteps = 9;
  for (int n = 1; n <= kSteps; ++n) {
    const double before = (n - 1.0) / kSteps, here = std::min(n / double{kSteps}, last);
    EXPECT_NEAR(lightness(color_at(here)) - lightness(color_at(before)), whole / kSteps, 2);
    EXPECT_NE(color_at(here), kBeyondScale);
  }
  EXPECT_EQ(color_at(1), kBeyondScale);
  EXPECT_EQ(color_at(-1), color_at(0));
}

}  // namespace
}  // namespace forcelayer::exact
