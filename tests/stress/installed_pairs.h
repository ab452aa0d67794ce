// Parts where they are installed, made at random: what they are installed in, how they come out,
// and both solids as formulas.
#pragma once

#include <cstdint>
#include <functional>
#include <random>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"

namespace forcelayer::stress {

// In the pair's own frame: it comes out along +z.
struct InstalledPair {
  const char* kind = "";
  mesh::Mesh scene;      // pair axes, m
  mesh::Mesh part;       // part axes, m
  Pose pair_from_part;   // where it is installed
  double removal_m = 0;  // as far as it has to go to be clear of everything
  // How deep a place lies in the scene (pair axes) or in the part (part axes), m; not above 0:
  // outside. Round solids are taken as round: their facets are off by 0.2% of the radius. What is
  // below a sheet has gone through it.
  std::function<double(const glm::dvec3&)> depth_in_scene_m, depth_in_part_m;

  double gap_m = 0, voxel_size_m = 0;
  Pose world_from_pair;
};

constexpr int kInstalledKinds = 7;

// Pair `seed`: kinds take turns; voxels of 1 to 5 mm, gaps of 0 to 1 mm, features of three to
// thirty voxels, turned at random against the grid. The same seed gives the same pair.
InstalledPair installed_pair(std::uint64_t seed);

}  // namespace forcelayer::stress
