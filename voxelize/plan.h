// --plan: standoff, file size and time of a voxel size, before anything is baked at it.
//
// Standoff, gap and shell points follow from the definitions. File size and time are extrapolated
// from bakes at two coarse sizes, which cost little.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "voxelize/bake.h"

namespace forcelayer::voxelize {

struct PlannedSize {
  double voxel_size_m = 0;
  // The distance from a surface at which the force begins, where a resting contact holds a point of
  // the part: as asked for, or by the layers the mean over where the surface lies in its voxel,
  // half a voxel less at worst. In voxels: k with Chebyshev layers along the lattice, more in other
  // directions; k + 0.73 with Euclidean layers; k + 0.87 with stored distances, plus the depth of a
  // compliance beyond one voxel.
  double standoff_m = 0;
  // The narrowest gap between parallel walls along the lattice that a thin part passes without
  // contact, wherever it lies: 2k + 2 voxels with Chebyshev layers, else twice the standoff of
  // stored distances and a voxel, 2k + 2.73 with k layers. A part of thickness t needs t more.
  double narrowest_gap_m = 0;
  // The narrowest gap less the part's thickness that a part two voxels thick or more passes in
  // contact on both sides, and the separation proven then for a shell of the usual covering radius,
  // 0 for none (formats/guard.h).
  double passed_gap_m = 0;
  double guaranteed_separation_m = 0;
  bool possible = true;            // whether the standoff is one of this voxel size
  double shell_points_per_m2 = 0;  // of the moving part's surface, at pointshell's default radius
  double file_bytes = 0;           // estimated
  double bake_s = 0;               // estimated: without reading, on as many threads as the bake has
  bool fits = true;                // whether the file format and this machine can hold it
};

struct Plan {
  std::array<PlannedSize, 3> sizes;     // at the voxel size, its half and its quarter
  std::array<double, 2> probe_sizes_m;  // voxel sizes of the coarse bakes
  std::string too_large;                // why the largest size that does not fit does not
};

// Errors are those of bake().
Result<Plan> plan_bakes(std::span<const SceneObject> objects, const BakeOptions& options);

std::string table_of(const Plan& plan);
nlohmann::ordered_json report_of(const Plan& plan);

}  // namespace forcelayer::voxelize
