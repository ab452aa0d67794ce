// The contacts that force models are judged by: which part lies how on which static body.
#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <vector>

#include "tests/bench/wrench_bench_case.h"

namespace forcelayer::bench {

inline constexpr double kUnitM = 0.01;         // s = 1; the paper's 5 mm is s = 1/2
inline constexpr double kPaperCover = 0.8661;  // covering radius, voxels

inline constexpr double kSphereRadiusM = 0.1, kCylinderRadiusM = 0.06, kCylinderHalfM = 0.1;
inline const glm::dvec3 kBoxHalfM{0.1, 0.075, 0.05};
// The cone's axis is z, its base below, its centroid the origin; less than 30 degrees at the tip,
// so that its side unrolls to a convex sector.
inline constexpr double kConeRadiusM = 0.06, kConeHeightM = 0.15;
inline const double kConeHalfAngle = std::atan2(kConeRadiusM, kConeHeightM);
inline constexpr double kTorusRingM = 0.07, kTorusTubeM = 0.025;  // about z

// Every contact that is judged.
std::vector<Combination> combinations();

AnalyticShell shell_of(Part part, double covering_radius_m);

// The shell to judge, and the dense one for the truth.
PartShells shells_of(Part part, double voxel_size_m, double covering_radius_voxels);

}  // namespace forcelayer::bench
