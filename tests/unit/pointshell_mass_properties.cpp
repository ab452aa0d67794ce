#include "pointshell/part/mass_properties.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/support/part_support.h"

namespace forcelayer {
namespace {

using namespace testing;
using std::numbers::pi;

struct ClosedForm {
  double area, volume;
  part::Vec3 centroid;
  std::array<double, 6> inertia;  // xx yy zz xy xz yz
};

// Tessellation with n segments errs by a few (1/n)^2; the lengths here are about 1.
void expect_near(const part::MassProperties& actual, const ClosedForm& expected, double tolerance) {
  EXPECT_EQ(actual.source, MassSource::kVolume);
  EXPECT_NEAR(actual.area_m2, expected.area, tolerance * expected.area);
  EXPECT_NEAR(actual.volume_m3, expected.volume, tolerance * expected.volume);
  EXPECT_NEAR(part::length(actual.centroid - expected.centroid), 0, tolerance);
  for (int n = 0; n < 6; ++n) EXPECT_NEAR(actual.inertia_m2[n], expected.inertia[n], tolerance);
}

TEST(MassProperties, OfABoxAreExact) {
  const double x = 0.3, y = 0.5, z = 0.7;
  const ClosedForm box{2 * (x * y + y * z + z * x),
                       x * y * z,
                       {},
                       {(y * y + z * z) / 12, (x * x + z * z) / 12, (x * x + y * y) / 12, 0, 0, 0}};
  expect_near(part::mass_properties(part_of(box_mesh(x, y, z))), box, 1e-14);
}

TEST(MassProperties, OfASphere) {
  const double r = 0.8, moment = 0.4 * r * r;
  const ClosedForm sphere{
      4 * pi * r * r, 4.0 / 3 * pi * r * r * r, {}, {moment, moment, moment, 0, 0, 0}};
  expect_near(part::mass_properties(part_of(sphere_mesh(r, 200))), sphere, 1e-3);
}

TEST(MassProperties, OfATorus) {
  const double ring = 1, tube = 0.3;
  const double across = ring * ring / 2 + 5.0 / 8 * tube * tube;
  const double along = ring * ring + 3.0 / 4 * tube * tube;
  const ClosedForm torus{4 * pi * pi * ring * tube,
                         2 * pi * pi * ring * tube * tube,
                         {},
                         {across, across, along, 0, 0, 0}};
  expect_near(part::mass_properties(part_of(torus_mesh(ring, tube, 150))), torus, 1e-3);
}

TEST(MassProperties, OfACylinder) {
  const double r = 0.5, h = 1.2;
  const double across = (3 * r * r + h * h) / 12;
  const ClosedForm cylinder{
      2 * pi * r * (r + h), pi * r * r * h, {}, {across, across, r * r / 2, 0, 0, 0}};
  expect_near(part::mass_properties(part_of(cylinder_mesh(r, h, 300))), cylinder, 1e-3);
}

TEST(MassProperties, OfACone) {
  const double r = 0.5, h = 1.2;
  const double across = 3.0 / 20 * r * r + 3.0 / 80 * h * h;
  const ClosedForm cone{pi * r * (r + std::hypot(r, h)),
                        pi * r * r * h / 3,
                        {0, 0, -h / 4},
                        {across, across, 0.3 * r * r, 0, 0, 0}};
  expect_near(part::mass_properties(part_of(cone_mesh(r, 0, h, 300))), cone, 1e-3);
}

// A box far from the origin and turned: off-diagonal elements are those of the tensor, and nothing
// is lost to cancellation.
TEST(MassProperties, OfATurnedBoxFarAway) {
  mesh::Mesh mesh = box_mesh(0.2, 0.4, 0.6);
  const double c = std::sqrt(0.5);
  for (mesh::Vec3d& v : mesh.vertices) {
    v = {c * v[0] - c * v[1] + 1000, c * v[0] + c * v[1] - 2000, v[2] + 3000};
  }
  const part::MassProperties actual = part::mass_properties(part_of(mesh));
  const double about_x = (0.16 + 0.36) / 12, about_y = (0.04 + 0.36) / 12;
  EXPECT_EQ(actual.source, MassSource::kVolume);
  EXPECT_NEAR(part::length(actual.centroid - part::Vec3{1000, -2000, 3000}), 0, 1e-11);
  EXPECT_NEAR(actual.inertia_m2[0], (about_x + about_y) / 2, 1e-10);
  EXPECT_NEAR(actual.inertia_m2[1], (about_x + about_y) / 2, 1e-10);
  EXPECT_NEAR(actual.inertia_m2[2], (0.04 + 0.16) / 12, 1e-10);
  // R diag(Ix, Iy, Iz) R^T for a turn of 45 degrees about z.
  EXPECT_NEAR(actual.inertia_m2[3], (about_x - about_y) / 2, 1e-10);
  EXPECT_NEAR(actual.inertia_m2[4], 0, 1e-10);
  EXPECT_NEAR(actual.inertia_m2[5], 0, 1e-10);
}

TEST(MassProperties, OfAnOpenMeshComeFromTheArea) {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  mesh.triangles.resize(10);  // without the face at x = +1/2
  const part::MassProperties actual = part::mass_properties(part_of(mesh));
  EXPECT_EQ(actual.source, MassSource::kArea);
  EXPECT_EQ(actual.volume_m3, 0);
  EXPECT_DOUBLE_EQ(actual.area_m2, 5);
  EXPECT_NEAR(actual.centroid.x, -0.1, 1e-15);
}

// Its two faces are one surface.
TEST(MassProperties, ASheetFoldedOntoItselfHasNoVolume) {
  mesh::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  const part::MassProperties actual = part::mass_properties(part_of(mesh));
  EXPECT_EQ(actual.source, MassSource::kArea);
  EXPECT_DOUBLE_EQ(actual.area_m2, 0.5);
}

// Whether `inertia` is that of some mass: no second moment is negative in any of many directions.
bool is_inertia_of_a_mass(const std::array<double, 6>& inertia, std::mt19937_64& random) {
  const auto& [xx, yy, zz, xy, xz, yz] = inertia;
  const double half_trace = (xx + yy + zz) / 2;
  std::normal_distribution<double> normal;
  for (int n = 0; n < 2000; ++n) {
    part::Vec3 u{normal(random), normal(random), normal(random)};
    u = (1 / part::length(u)) * u;
    const double about_u = xx * u.x * u.x + yy * u.y * u.y + zz * u.z * u.z +
                           2 * (xy * u.x * u.y + xz * u.x * u.z + yz * u.y * u.z);
    if (half_trace - about_u < -1e-9 * half_trace) return false;
  }
  return true;
}

TEST(MassProperties, OfBoxesThatCrossThemselvesAreThoseOfSomeMass) {
  int from_area = 0, from_volume = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    mesh::Mesh mesh = box_mesh(1, 1, 1);
    for (mesh::Vec3d& v : mesh.vertices) {
      v = {coordinate(random), coordinate(random), coordinate(random)};
    }
    const part::MassProperties actual = part::mass_properties(part_of(mesh));
    EXPECT_TRUE(is_inertia_of_a_mass(actual.inertia_m2, random)) << "seed " << seed;
    EXPECT_LE(part::max_abs(actual.centroid), 1) << "seed " << seed;
    (actual.source == MassSource::kArea ? from_area : from_volume) += 1;
  }
  EXPECT_GT(from_area, 50);
  EXPECT_GT(from_volume, 20);
}

}  // namespace
}  // namespace forcelayer
