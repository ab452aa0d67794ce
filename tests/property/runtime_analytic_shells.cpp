// The benchmarks' analytic shells hold what they claim: area, normals, covering radius.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <random>

#include "tests/bench/wrench_bench_shell.h"

namespace forcelayer::bench {
namespace {

constexpr double kRadiusM = 0.06, kHeightM = 0.15, kRingM = 0.07, kTubeM = 0.025;

double uniform(std::mt19937_64& random) {
  return std::uniform_real_distribution<double>(0, 1)(random);
}

// Every random surface point has a shell point within the covering radius, by looking at all.
void expect_covered(const AnalyticShell& shell, const std::function<glm::dvec3()>& surface_point) {
  double farthest = 0;
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec3 at = surface_point();
    double nearest = 1e300;
    for (const glm::dvec3& p : shell.points_m) nearest = std::min(nearest, glm::distance(p, at));
    farthest = std::max(farthest, nearest);
  }
  EXPECT_LE(farthest, shell.covering_radius_m * (1 + 1e-9));
  EXPECT_GT(farthest, 0.5 * shell.covering_radius_m);  // or the points are wasted
}

TEST(AnalyticShells, Cone) {
  const double slant = std::hypot(kRadiusM, kHeightM);
  for (const double rho : {0.004, 0.01}) {
    const AnalyticShell shell = cone_shell(kRadiusM, kHeightM, rho);
    double area = 0;
    for (std::size_t i = 0; i < shell.points_m.size(); ++i) {
      const glm::dvec3 &p = shell.points_m[i], &n = shell.normals[i];
      area += shell.areas_m2[i];
      EXPECT_NEAR(glm::length(n), 1, 1e-12);
      const double from_axis = std::hypot(p.x, p.y);
      if (n.z == 1) {
        EXPECT_NEAR(p.z, -kHeightM / 4, 1e-12);
        EXPECT_LE(from_axis, kRadiusM * (1 + 1e-12));
      } else {
        EXPECT_NEAR(from_axis, kRadiusM * (0.75 - p.z / kHeightM), 1e-12);
        const glm::dvec3 tip(0, 0, 0.75 * kHeightM);
        EXPECT_NEAR(glm::dot(n, tip - p), 0, 1e-12);  // along the generatrix
        EXPECT_LE(glm::dot(n, p), 0);                 // inward
      }
    }
    EXPECT_NEAR(area, M_PI * kRadiusM * (kRadiusM + slant), 1e-3 * area);  // arcs are polygons
    std::mt19937_64 random(1);
    expect_covered(shell, [&] {
      const double a = 2 * M_PI * uniform(random), r = kRadiusM * std::sqrt(uniform(random));
      const bool base = uniform(random) < kRadiusM / (kRadiusM + slant);
      const double z = base ? -kHeightM / 4 : kHeightM * (0.75 - r / kRadiusM);
      return glm::dvec3(r * std::cos(a), r * std::sin(a), z);
    });
  }
}

TEST(AnalyticShells, Torus) {
  for (const double rho : {0.004, 0.01}) {
    const AnalyticShell shell = torus_shell(kRingM, kTubeM, rho);
    double area = 0;
    for (std::size_t i = 0; i < shell.points_m.size(); ++i) {
      const glm::dvec3& p = shell.points_m[i];
      area += shell.areas_m2[i];
      const glm::dvec3 ring = kRingM * glm::normalize(glm::dvec3(p.x, p.y, 0));
      EXPECT_NEAR(glm::distance(ring, p), kTubeM, 1e-12);
      EXPECT_NEAR(glm::distance((ring - p) / kTubeM, shell.normals[i]), 0, 1e-9);
    }
    EXPECT_NEAR(area, 4 * M_PI * M_PI * kRingM * kTubeM, 1e-9 * area);
    std::mt19937_64 random(1);
    expect_covered(shell, [&] {
      const double u = 2 * M_PI * uniform(random), v = 2 * M_PI * uniform(random);
      const double from_axis = kRingM + kTubeM * std::cos(v);
      return glm::dvec3(from_axis * std::cos(u), from_axis * std::sin(u), kTubeM * std::sin(v));
    });
  }
}

}  // namespace
}  // namespace forcelayer::bench
