// Bodies that a part holds several times: found, and made and proven once. The proof of the whole
// part, which knows of no copies, holds for the shell.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "pointshell/bake.h"
#include "pointshell/part/copies.h"
#include "pointshell/portions.h"
#include "pointshell/sample/stored_position.h"
#include "pointshell/verify.h"
#include "tests/support/part_support.h"
#include "tests/support/stored_shell.h"

namespace forcelayer {
namespace {

using namespace testing;
using Random = std::mt19937_64;

constexpr double kVoxelM = 0.1;

mesh::Affine turned(double angle, const part::Vec3& axis, bool mirrored,
                    const mesh::Vec3d& translation) {
  const part::Vec3 a = part::normalized(axis);
  const double c = std::cos(angle), s = std::sin(angle), d = 1 - c;
  mesh::Affine placing;
  placing.linear = {c + a.x * a.x * d,       a.x * a.y * d - a.z * s, a.x * a.z * d + a.y * s,
                    a.y * a.x * d + a.z * s, c + a.y * a.y * d,       a.y * a.z * d - a.x * s,
                    a.z * a.x * d - a.y * s, a.z * a.y * d + a.x * s, c + a.z * a.z * d};
  if (mirrored) {
    for (const int n : {0, 3, 6}) placing.linear[static_cast<std::size_t>(n)] *= -1;
  }
  placing.translation = translation;
  return placing;
}

mesh::Affine random_placing(Random& random, const mesh::Vec3d& translation) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  return turned(angle(random), {normal(random), normal(random), normal(random)}, random() % 2 == 0,
                translation);
}

// A pin in a block, so many times and `spacing` apart, turned and mirrored anyhow; and a lone box.
mesh::Assembly pinned_blocks(std::uint64_t seed, int times, double spacing) {
  Random random(seed);
  mesh::Assembly assembly;
  assembly.meshes = {box_mesh(1, 0.7, 0.5), cylinder_mesh(0.2, 1.2, 16), box_mesh(1, 1, 1)};
  for (int n = 0; n < times; ++n) {
    const mesh::Affine placing = random_placing(random, {spacing * n, 0.1 * n, 0});
    assembly.instances.push_back({0, "block", placing});
    assembly.instances.push_back({1, "pin", placing});
  }
  assembly.instances.push_back({2, "box", {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 5, 0}}});
  return assembly;
}

part::Part assembled(const mesh::Assembly& assembly) {
  const part::PartInput input{&assembly, 1};
  return std::move(part::assemble_part({&input, 1})).value();
}

pointshell::BakedShell baked(part::Part part) {
  pointshell::ShellOptions options;
  options.voxel_size_m = kVoxelM;
  options.effort = sample::Effort::kFast;
  return std::move(
             pointshell::bake_shell(std::move(part), options, [](const std::string&, double) {}))
      .value();
}

// The same part without a word about what is there twice.
part::Part without_instances(part::Part part) {
  std::uint32_t mesh = 0;
  for (part::Placing& placing : part.placings) placing.mesh = mesh++;
  return part;
}

TEST(Copies, AreFoundWhereNothingIsNearThem) {
  const double radius = std::sqrt(0.75) * kVoxelM;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const part::Part part = assembled(pinned_blocks(seed, 5, 3));
    const auto groups = part::find_copies(part, radius);
    ASSERT_EQ(groups.size(), 1u);
    EXPECT_EQ(groups[0].bodies.size(), 2u);
    ASSERT_EQ(groups[0].copies.size(), 4u);
    EXPECT_LT(groups[0].slack_m, 1e-4 * radius);
    const auto originals = part::original_triangles(part, groups);
    for (std::uint32_t t = 0; t < originals.size(); ++t) {
      for (const part::Copy& copy : groups[0].copies) {
        const auto at = std::find(copy.bodies.begin(), copy.bodies.end(), part.body[t]);
        if (at == copy.bodies.end()) continue;
        EXPECT_EQ(part.body[originals[t]],
                  groups[0].bodies[static_cast<std::size_t>(at - copy.bodies.begin())]);
        const part::Vec3 moved =
            copy.from_original.moved(part::centroid(part::triangle_piece(part, originals[t])));
        EXPECT_LT(part::length(moved - part::centroid(part::triangle_piece(part, t))), 1e-12);
      }
    }
  }
  // As near as to share points; with another body near; stretched; without instances.
  EXPECT_TRUE(part::find_copies(assembled(pinned_blocks(1, 5, 0.9)), radius).empty());
  mesh::Assembly crowded = pinned_blocks(1, 2, 3);
  crowded.instances[4].assembly_from_mesh.translation = {3, 0.1, 0};
  EXPECT_TRUE(part::find_copies(assembled(crowded), radius).empty());
  mesh::Assembly stretched = pinned_blocks(1, 2, 3);
  for (double& x : stretched.instances[2].assembly_from_mesh.linear) x *= 1.001;
  for (double& x : stretched.instances[3].assembly_from_mesh.linear) x *= 1.001;
  EXPECT_TRUE(part::find_copies(assembled(stretched), radius).empty());
  EXPECT_TRUE(
      part::find_copies(without_instances(assembled(pinned_blocks(1, 5, 3))), radius).empty());
}

// The slack is above all that a copy's points and surface are off, with placings in single
// precision and points as far from the middle as the part reaches.
TEST(Copies, AreOffByTheirSlackAtMost) {
  const double radius = std::sqrt(0.75) * kVoxelM;
  double largest_portion = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    mesh::Assembly assembly = pinned_blocks(seed, 5, 100);
    for (mesh::MeshInstance& instance : assembly.instances) {
      for (double& x : instance.assembly_from_mesh.linear) x = static_cast<float>(x);
    }
    const part::Part part = assembled(assembly);
    const auto groups = part::find_copies(part, radius);
    ASSERT_EQ(groups.size(), 1u);
    EXPECT_LT(groups[0].slack_m, 1e-3 * radius);
    part::Box box;
    for (const part::Vec3& v : part.vertices) box.grow(v);
    const part::TriangleTree tree(part);
    const auto portions = pointshell::portions_of(tree, radius, box.low, groups);
    ASSERT_EQ(portions.size(), 2u);
    EXPECT_EQ(portions[0].slack, groups[0].slack_m);
    EXPECT_LE(portions[0].radius + portions[0].slack, radius * (1 + 1e-15));
    EXPECT_EQ(portions[1].radius, radius);
    const auto originals = part::original_triangles(part, groups);
    for (std::size_t n = 0; n < portions[0].copies.size(); ++n) {
      const part::Motion& motion = portions[0].copies[n];
      double stretch = 0, rounding = 0, off = 0;
      for (const part::Vec3& row : motion.rows) {
        stretch = std::max(stretch, std::abs(part::length(row) - 1));
      }
      for (std::uint32_t t = 0; t < originals.size(); ++t) {
        if (part.body[t] != groups[0].copies[n].bodies[0]) continue;
        const part::Piece own = part::triangle_piece(part, t);
        for (const part::Vec3& corner : part::triangle_piece(part, originals[t])) {
          const part::Vec3 moved = motion.moved(corner - box.low);
          rounding = std::max(rounding, part::length(sample::as_stored(moved) - moved));
          double smallest = 1;
          for (const part::Vec3& other : own) {
            smallest = std::min(smallest, part::length(other - box.low - moved));
          }
          off = std::max(off, smallest);
        }
      }
      EXPECT_LE(rounding + off + stretch * radius, portions[0].slack);
      largest_portion =
          std::max(largest_portion, (rounding + off + stretch * radius) / portions[0].slack);
    }
  }
  EXPECT_GT(largest_portion, 0.1) << "the slack is far too large";
}

TEST(Copies, OfAShellHoldTheProofOfTheWholePart) {
  for (const double spacing : {3.0, 200.0}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", spacing " << spacing);
      const part::Part part = assembled(pinned_blocks(seed, 5, spacing));
      ASSERT_EQ(part::find_copies(part, std::sqrt(0.75) * kVoxelM).size(), 1u);
      const pointshell::BakedShell shell = baked(part), flat = baked(without_instances(part));
      EXPECT_LT(2 * shell.certificate_pieces, flat.certificate_pieces) << "proven more than once";
      EXPECT_NEAR(static_cast<double>(shell.x.size()), static_cast<double>(flat.x.size()),
                  0.05 * static_cast<double>(flat.x.size()));
      // Where pin and block meet, hidden points go by where points happen to lie: 1.2% is the most
      // that was seen.
      EXPECT_NEAR(shell.covered_area_m2, flat.covered_area_m2, 0.02 * flat.covered_area_m2);
      EXPECT_DOUBLE_EQ(shell.header.volume_m3, flat.header.volume_m3);
      EXPECT_EQ(shell.orientation.patches, flat.orientation.patches);
      EXPECT_EQ(shell.hidden_points % 5, 0u);
      const Pshell file = stored(shell);
      EXPECT_TRUE(pointshell::verify_shell(file, part).proven);
      EXPECT_TRUE(pointshell::verify_losses(file, part).proven);
    }
  }
}

// One of three open sheets stands before a wall, which hides much of one side of it: all have both
// sides all the same.
TEST(Copies, OfSheetsAreSheetsWhereverTheyStand) {
  for (const double wall_x : {0.0, 3.0, 6.0}) {
    mesh::Assembly assembly;
    assembly.meshes = {{}, box_mesh(0.2, 5, 5)};
    assembly.meshes[0].vertices = {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}};
    assembly.meshes[0].triangles = {{0, 1, 2}, {0, 2, 3}};
    for (const double x : {0.0, 3.0, 6.0}) {
      assembly.instances.push_back({0, "sheet", {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {x, 0, 0}}});
    }
    assembly.instances.push_back(
        {1, "wall", {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {wall_x + 0.35, 0.5, 0.5}}});
    const part::Part part = assembled(assembly);
    ASSERT_EQ(part::find_copies(part, std::sqrt(0.75) * kVoxelM).size(), 1u);
    const pointshell::BakedShell shell = baked(part);
    EXPECT_EQ(shell.orientation.sheets.size(), 3u) << "wall at " << wall_x;
    EXPECT_GT(std::count(shell.two_sided.begin(), shell.two_sided.end(), 1), 3 * 50);
    EXPECT_TRUE(pointshell::verify_shell(stored(shell), part).proven);
  }
}

// Time does not grow with the square of the sizes in which a mesh is there: those after the first
// hundred are made by themselves.
TEST(Copies, AreSoughtOfTheFirstHundredSizes) {
  const auto groups_after = [](int sizes) {
    mesh::Assembly assembly;
    assembly.meshes = {box_mesh(0.1, 0.1, 0.1)};
    for (int n = 0; n < sizes + 2; ++n) {
      const double scale = 1 + 0.01 * std::min(n, sizes);
      assembly.instances.push_back(
          {0, "box", {{scale, 0, 0, 0, scale, 0, 0, 0, scale}, {1.0 * n, 0, 0}}});
    }
    return part::find_copies(assembled(assembly), 0.1).size();
  };
  EXPECT_EQ(groups_after(98), 1u);
  EXPECT_EQ(groups_after(100), 0u);
}

// A file in which all blocks are inside out, or one triangle of each of their faces: then rounding
// decides which half of its area a copy keeps at first.
TEST(Copies, FaceOutwardsAsTheirOriginalsDo) {
  const double volume = baked(assembled(pinned_blocks(7, 9, 3))).header.volume_m3;
  for (const std::size_t step : {1u, 2u}) {
    mesh::Assembly assembly = pinned_blocks(7, 9, 3);
    std::vector<mesh::Triangle>& triangles = assembly.meshes[0].triangles;
    for (std::size_t t = 0; t < triangles.size(); t += step) {
      std::swap(triangles[t][1], triangles[t][2]);
    }
    const pointshell::BakedShell shell = baked(assembled(assembly));
    EXPECT_EQ(shell.orientation.flipped_triangles, 9 * triangles.size() / step);
    EXPECT_NEAR(shell.header.volume_m3, volume, 1e-12 * volume);
  }
}

}  // namespace
}  // namespace forcelayer
