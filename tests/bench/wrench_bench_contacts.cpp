#include "tests/bench/wrench_bench_contacts.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::bench {

std::vector<Combination> combinations() {
  using enum Part;
  using enum Stance;
  using Body = StaticKind;
  const double right = M_PI / 2, narrow = M_PI / 3, convex = 1.5 * M_PI;
  return {
      {"sphere on plane", kSphere, kAnyWay, Body::kPlane},
      {"box face on plane", kBox, kFaceDown, Body::kPlane},
      {"cylinder side on plane", kCylinder, kFaceDown, Body::kPlane},
      {"cylinder cap on plane", kCylinder, kCapDown, Body::kPlane},
      {"sphere on sphere", kSphere, kAnyWay, Body::kSphere, 0.2},
      {"cylinder side on sphere", kCylinder, kFaceDown, Body::kSphere, 0.2},
      {"box face on sphere", kBox, kFaceDown, Body::kSphere, 0.2},
      {"sphere in bore", kSphere, kAnyWay, Body::kBore, 0.2},
      {"cylinder in bore", kCylinder, kAlongBore, Body::kBore, 0.15},
      {"box edge in bore", kBox, kAlongBore, Body::kBore, 0.2, 0, false},
      {"box corner on plane", kBox, kAnyWay, Body::kPlane, 0, 0, false},
      {"box edge on plane", kBox, kEdgeDown, Body::kPlane, 0, 0, false},
      {"sphere on edge", kSphere, kAnyWay, Body::kWedge, 0, convex, false},
      {"box face on edge", kBox, kFaceDown, Body::kWedge, 0, convex, false},
      {"cylinder side on edge", kCylinder, kFaceDown, Body::kWedge, 0, convex, false},
      {"sphere in wedge 90", kSphere, kAnyWay, Body::kWedge, 0, right, false, true},
      {"sphere in wedge 60", kSphere, kAnyWay, Body::kWedge, 0, narrow, false, true},
      {"cylinder in wedge 90", kCylinder, kAlongWedge, Body::kWedge, 0, right, false, true},
      {"box edge in wedge 90", kBox, kEdgeDown, Body::kWedge, 0, right, false, true},
      {"sphere in wedge 90, one offset", kSphere, kAnyWay, Body::kWedge, 0, right, false},
      {"cylinder in wedge 90, one offset", kCylinder, kAlongWedge, Body::kWedge, 0, right, false},
      {"cone side on plane", kCone, kFaceDown, Body::kPlane},
      {"cone base on plane", kCone, kCapDown, Body::kPlane},
      {"cone side on sphere", kCone, kFaceDown, Body::kSphere, 0.2},
      {"torus flat on plane", kTorus, kCapDown, Body::kPlane},
      {"torus on plane", kTorus, kAnyWay, Body::kPlane},
      {"torus seated on sphere", kTorus, kCapDown, Body::kSphere, 0.2},
      {"torus in bore", kTorus, kAlongBore, Body::kBore, 0.15},
      {"cone on plane", kCone, kAnyWay, Body::kPlane, 0, 0, false},
      {"torus on edge", kTorus, kAnyWay, Body::kWedge, 0, 1.5 * M_PI, false},
      {"torus in wedge 90", kTorus, kAnyWay, Body::kWedge, 0, M_PI / 2, false, true},
  };
}

AnalyticShell shell_of(Part part, double covering_radius_m) {
  if (part == Part::kSphere) return sphere_shell(kSphereRadiusM, covering_radius_m);
  if (part == Part::kBox) return box_shell(kBoxHalfM, covering_radius_m);
  if (part == Part::kCone) return cone_shell(kConeRadiusM, kConeHeightM, covering_radius_m);
  if (part == Part::kTorus) return torus_shell(kTorusRingM, kTorusTubeM, covering_radius_m);
  return cylinder_shell(kCylinderRadiusM, kCylinderHalfM, covering_radius_m);
}

PartShells shells_of(Part part, double voxel_size_m, double covering_radius_voxels) {
  return {shell_of(part, covering_radius_voxels * voxel_size_m),
          shell_of(part, std::clamp(0.2 * voxel_size_m, 0.0007, 0.002))};
}

}  // namespace forcelayer::bench
