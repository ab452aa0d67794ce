// From a part to its point shell.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "formats/pshell_writer.h"
#include "formats/result.h"
#include "formats/surface_distance.h"
#include "pointshell/normals/orientation.h"
#include "pointshell/part/part.h"
#include "pointshell/sample/covering_points.h"

namespace forcelayer::pointshell {

struct ShellOptions {
  double voxel_size_m = 0;
  double covering_radius_m = 0;  // 0: sqrt(3)/2 voxel, that of voxel centers
  ShellMethod method = ShellMethod::kSurface;
  sample::Effort effort = sample::Effort::kFull;
  double mesh_deviation_m = 0;  // of the mesh from the true part, as the user declares it;
                                // Part::deviation_m is added
  unsigned threads = 0;         // 0: all
};

// The fewest points whose discs of this radius can cover a plane of this area (Kershner 1939).
double planar_bound(double area_m2, double radius_m);

// The radius that the options ask for, m.
double requested_covering_radius(const ShellOptions& options);

// A shell with the arrays that its content refers to.
struct BakedShell {
  PshellHeader header{};
  std::vector<float> x, y, z, nx, ny, nz, weight_m2, cone_cos;
  std::vector<BoundingSphere> blocks, super_blocks;
  std::vector<DistanceLoss> losses;
  std::vector<std::uint8_t> two_sided;  // of points on sheets 1; empty where there are no sheets

  normals::OrientationReport orientation;
  std::uint64_t certificate_pieces = 0;
  std::uint64_t loss_pieces = 0;
  std::uint64_t corner_points = 0;    // added where the others cut off corners and edges
  std::uint64_t hidden_points = 0;    // left out: they lie inside another of the part's bodies
  std::uint64_t loose_triangles = 0;  // that do not count in the volume
  double covered_area_m2 = 0;         // sum of the weights
  double mean_block_radius_m = 0;
  std::vector<std::pair<std::string, double>> stage_seconds;

  PshellContent content() const;                        // valid while this lives and stays
  SurfaceDistanceTerms surface_distance_terms() const;  // the same
};

// Called with the stage that runs and the fraction of the bake that is done, in [0, 1].
using BakeProgress = std::function<void(const std::string& stage, double portion_done)>;

// Errors: kMeshEmpty; kBakeTooLarge where the shell is more than memory or the format holds. The
// same shell for any number of threads. `expected_s`, from cost.h, makes the progress more
// even; 0: not known.
Result<BakedShell> bake_shell(part::Part part, const ShellOptions& options,
                              const BakeProgress& progress, double expected_s = 0);

}  // namespace forcelayer::pointshell
