#include "tests/bench/shell_bench_shapes.h"

#include <algorithm>
#include <cmath>

#include "tests/support/analytic_shapes.h"

namespace forcelayer::bench {
namespace {

constexpr double kSphereRadius = 0.5;
constexpr double kRingRadius = 0.35, kTubeRadius = 0.15;
constexpr part::Vec3 kBox{1, 0.7, 0.4};
constexpr double kCylinderRadius = 0.25, kCylinderHeight = 1;
constexpr double kConeRadius = 0.4, kConeHeight = 1;

std::vector<FaceTruth> sorted(std::vector<FaceTruth> faces) {
  std::sort(faces.begin(), faces.end(),
            [](const FaceTruth& a, const FaceTruth& b) { return a.distance < b.distance; });
  return faces;
}

part::Vec3 away_from_axis(const part::Vec3& p) { return part::normalized(part::Vec3{p.x, p.y, 0}); }
part::Vec3 along_axis(double z) { return {0, 0, z > 0 ? 1.0 : -1.0}; }

std::vector<FaceTruth> sphere_faces(const part::Vec3& p) {
  return {{std::abs(part::length(p) - kSphereRadius), part::normalized(p)}};
}

std::vector<FaceTruth> torus_faces(const part::Vec3& p) {
  const part::Vec3 from_ring = p - kRingRadius * away_from_axis(p);
  return {{std::abs(part::length(from_ring) - kTubeRadius), part::normalized(from_ring)}};
}

std::vector<FaceTruth> box_faces(const part::Vec3& p) {
  return sorted({{std::abs(std::abs(p.x) - kBox.x / 2), {p.x > 0 ? 1.0 : -1.0, 0, 0}},
                 {std::abs(std::abs(p.y) - kBox.y / 2), {0, p.y > 0 ? 1.0 : -1.0, 0}},
                 {std::abs(std::abs(p.z) - kBox.z / 2), along_axis(p.z)}});
}

std::vector<FaceTruth> cylinder_faces(const part::Vec3& p) {
  return sorted({{std::abs(std::hypot(p.x, p.y) - kCylinderRadius), away_from_axis(p)},
                 {std::abs(std::abs(p.z) - kCylinderHeight / 2), along_axis(p.z)}});
}

// Beside its side and its base, the tip: there the side's normal turns all the way round.
std::vector<FaceTruth> cone_faces(const part::Vec3& p) {
  const double slant = std::hypot(kConeRadius, kConeHeight);
  const double out = kConeHeight / slant, up = kConeRadius / slant;  // the side's normal
  const part::Vec3 tip{0, 0, kConeHeight / 2};
  const part::Vec3 side = out * away_from_axis(p) + up * part::Vec3{0, 0, 1};
  return sorted({{std::abs(out * std::hypot(p.x, p.y) + up * (p.z - tip.z)), side},
                 {std::abs(p.z + kConeHeight / 2), {0, 0, -1}},
                 {part::length(p - tip), {0, 0, 1}}});
}

}  // namespace

std::vector<AnalyticShape> analytic_shapes() {
  constexpr int kSegments = 96;  // facets meet at 3.75 degrees
  using namespace testing;
  return {{"sphere", sphere_mesh(kSphereRadius, kSegments), sphere_faces},
          {"torus", torus_mesh(kRingRadius, kTubeRadius, kSegments / 2), torus_faces},
          {"box", box_mesh(kBox.x, kBox.y, kBox.z), box_faces},
          {"cylinder", cylinder_mesh(kCylinderRadius, kCylinderHeight, kSegments), cylinder_faces},
          {"cone", cone_mesh(kConeRadius, 0, kConeHeight, kSegments), cone_faces}};
}

}  // namespace forcelayer::bench
