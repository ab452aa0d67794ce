// Scenes and parts at whose random poses a clearance is judged, and these poses.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "tests/stress/clearance_judge.h"
#include "tests/support/random_numbers.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::stress {

// `objects` in world, m; the part about the middle of its box.
struct ClearanceScene {
  std::vector<mesh::Mesh> objects;
  mesh::Mesh part;
  double voxel_size_m = 0;
  double standoff_m = 0;  // 0: two layers
  std::optional<std::array<double, 6>> roi_m;
};

// A family of scenes. Equal seeds give equal scenes.
struct ClearanceFamily {
  std::string_view name;
  std::string_view group;  // generated, sample, shared
  int poses;               // that one scene is worth: what its bake costs
  // `models` is the folder of the shared models.
  ClearanceScene (*make)(std::uint64_t seed, const std::string& models);
  std::string_view needs;  // a file of the models, or empty
};
std::span<const ClearanceFamily> clearance_families();

// Overlapping solids, open sheets, thin walls and threads beside a small part, by seed: with a
// region of interest that cuts them, far from the world's origin, or beside a part hundreds of
// voxels long.
ClearanceScene generated_clearance_scene(std::uint64_t seed);

// The bakes of a scene, open; distances and objects are stored.
class BakedClearance {
 public:
  // Throws std::runtime_error where a bake fails.
  explicit BakedClearance(const ClearanceScene& scene);
  Voxmap open_scene() const;
  Pshell open_part() const;

 private:
  test::ScratchFolder folder_;
};

// Poses of the part on random lines, turning, each nearer than the one before: by less than the
// distance, so that no surface is crossed. A line ends where they meet, or have passed.
class Approach {
 public:
  Approach(const ClearanceScene& scene, std::uint64_t seed);

  // The next world_from_part. `exact_m` is the distance at `at`, where the part is now.
  Pose next(const Pose& at, double exact_m);
  // The first of a line.
  Pose begin();

 private:
  test::Random random_;
  const ClearanceScene& scene_;
  double part_radius_m_, start_m_;
  glm::dvec3 way_{0}, aim_m_{0};
};

}  // namespace forcelayer::stress
