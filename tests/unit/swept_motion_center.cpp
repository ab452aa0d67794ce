// The center about which a swept part turns is the one that pointshell computes of the same meshes,
// or is reported to be uncertain by at least the difference.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pointshell/normals/orientation.h"
#include "pointshell/part/mass_properties.h"
#include "pointshell/part/part.h"
#include "tests/support/random_numbers.h"
#include "tests/support/soups.h"
#include "voxelize/sweep/motion_center.h"

namespace forcelayer {
namespace {

using mesh::Mesh;
using mesh::Vec3d;

part::Vec3 pointshell_center_m(const std::vector<Mesh>& parts) {
  mesh::Assembly assembly;
  for (const Mesh& part : parts) {
    if (part.triangles.empty()) continue;
    auto& instance = assembly.instances.emplace_back();
    instance.mesh = static_cast<std::uint32_t>(assembly.meshes.size());
    instance.name = std::to_string(instance.mesh);
    assembly.meshes.push_back(part);
  }
  const part::PartInput input{&assembly, 1};
  auto assembled = part::assemble_part(std::span(&input, 1));
  EXPECT_TRUE(assembled);
  const auto report = normals::orient_outwards(*assembled, 1e-4);
  return part::mass_properties(*assembled, report.loose).centroid;
}

Mesh cube(const Vec3d& middle, double edge, unsigned missing = 0) {
  Mesh mesh;
  const double h = edge / 2;
  reference::add_box(mesh, {middle[0] - h, middle[1] - h, middle[2] - h},
                     {middle[0] + h, middle[1] + h, middle[2] + h}, missing);
  return mesh;
}

Mesh inverted(Mesh mesh) {
  for (auto& [a, b, c] : mesh.triangles) std::swap(b, c);
  return mesh;
}

Mesh joined(Mesh mesh, const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles)
    mesh.triangles.push_back({a + first, b + first, c + first});
  return mesh;
}

// A cube of which one edge has one more vertex, and a triangle without area closes the gap.
Mesh cube_with_sliver() {
  Mesh mesh = cube({0, 0, 0}, 0.02, 0b100000);
  const double h = 0.01;
  const Vec3d a{-h, -h, h}, b{h, -h, h}, c{h, h, h}, d{-h, h, h}, between{0, -h, h};
  reference::add_triangle(mesh, a, between, d);
  reference::add_triangle(mesh, between, b, c);
  reference::add_triangle(mesh, between, c, d);
  reference::add_triangle(mesh, a, b, between);
  return mesh;
}

enum class Center { kCertain, kUncertain };

void expect_center(const char* name, const std::vector<Mesh>& parts, Center expected) {
  SCOPED_TRACE(name);
  const sweep::MotionCenter center = sweep::motion_center(parts);
  const part::Vec3 there = pointshell_center_m(parts);
  const double apart_m =
      std::hypot(center.at_m[0] - there.x, center.at_m[1] - there.y, center.at_m[2] - there.z);
  EXPECT_LE(apart_m, center.uncertainty_m + 1e-12);
  EXPECT_EQ(center.uncertainty_m == 0, expected == Center::kCertain);
}

TEST(MotionCenter, IsThatOfPointshellOrUncertain) {
  const Mesh large = cube({0, 0, 0}, 0.02), small = cube({0.1, 0, 0}, 0.01);
  expect_center("one solid", {large}, Center::kCertain);
  expect_center("one solid inside out", {inverted(small)}, Center::kCertain);
  expect_center("solids of one mesh", {joined(large, small)}, Center::kCertain);
  expect_center("solids of one mesh inside out", {inverted(joined(large, small))},
                Center::kCertain);
  expect_center("solids of unlike orientation", {large, inverted(small)}, Center::kCertain);
  expect_center("a solid and nothing", {Mesh{}, large}, Center::kCertain);
  Mesh ball;
  reference::add_sphere(ball, {0.1, 0, 0}, 0.01, 6);
  expect_center("a triangle with two equal corners", {ball}, Center::kCertain);
  expect_center("solids that overlap", {large, cube({0.005, 0.002, 0}, 0.02)}, Center::kCertain);
  expect_center("solids that share a face", {large, cube({0.02, 0, 0}, 0.02)}, Center::kCertain);
  expect_center("a solid in a solid", {large, cube({0.002, 0, 0}, 0.01)}, Center::kCertain);
  expect_center("a sheet", {cube({0, 0, 0}, 0.02, 0b10)}, Center::kCertain);
  expect_center("two sheets", {joined(cube({0, 0, 0}, 0.02, 0b111110), cube({0.1, 0, 0}, 0.01, 1))},
                Center::kCertain);

  expect_center("one mesh of unlike orientation", {joined(large, inverted(small))},
                Center::kUncertain);
  expect_center("a cavity", {joined(large, inverted(cube({0.002, 0, 0}, 0.01)))},
                Center::kUncertain);
  expect_center("a stray sheet", {joined(large, cube({0.1, 0, 0}, 0.01, 0b111110))},
                Center::kUncertain);
  expect_center("a stray sheet of its own", {large, cube({0.1, 0, 0}, 0.01, 0b111110)},
                Center::kUncertain);
  expect_center("a triangle without area", {joined(cube_with_sliver(), small)}, Center::kUncertain);
  expect_center("a body of two objects",
                {cube({0, 0, 0}, 0.02, 0b1), cube({0, 0, 0}, 0.02, 0b111110), small},
                Center::kUncertain);
  expect_center("an object twice", {large, small, small}, Center::kUncertain);
  Mesh back_to_back = cube({0.1, 0, 0}, 0.01, 0b111110);
  back_to_back = joined(back_to_back, inverted(back_to_back));
  expect_center("a sheet of two faces", {joined(large, back_to_back)}, Center::kUncertain);
  expect_center("one face turned",
                {joined(cube({0, 0, 0}, 0.02, 0b10), inverted(cube({0, 0, 0}, 0.02, 0b111101)))},
                Center::kUncertain);
}

TEST(MotionCenter, OfRandomPartsIsThatOfPointshellOrUncertain) {
  int certain = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    test::Random random(seed);
    std::vector<Mesh> parts(static_cast<std::size_t>(test::integer(random, 1, 3)));
    for (Mesh& part : parts) {
      const auto bodies = test::integer(random, 1, 2);
      for (std::int64_t n = 0; n < bodies; ++n) {
        const Vec3d middle{test::uniform(random, -0.05, 0.05), test::uniform(random, -0.05, 0.05),
                           test::uniform(random, -0.05, 0.05)};
        const unsigned missing = random() % 8 == 0 ? 1u << random() % 6 : 0;
        Mesh body = cube(middle, test::uniform(random, 0.005, 0.03), missing);
        if (random() % 4 == 0) body = inverted(std::move(body));
        part = joined(std::move(part), body);
      }
    }
    const sweep::MotionCenter center = sweep::motion_center(parts);
    const part::Vec3 there = pointshell_center_m(parts);
    EXPECT_LE(
        std::hypot(center.at_m[0] - there.x, center.at_m[1] - there.y, center.at_m[2] - there.z),
        center.uncertainty_m + 1e-12)
        << "seed " << seed;
    certain += center.uncertainty_m == 0 ? 1 : 0;
  }
  EXPECT_GT(certain, 50);
  EXPECT_LT(certain, 150);
}

}  // namespace
}  // namespace forcelayer
