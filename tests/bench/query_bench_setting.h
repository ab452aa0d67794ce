// Static scenes, sphere-shaped parts of any number of points, and recorded motions between them.
#pragma once

#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"
#include "formats/pshell.h"

namespace forcelayer::bench {

inline constexpr double kVoxelSizeM = 0.001;

// A sphere of 0.63 points per squared voxel (what certified shells spend), along a space-filling
// curve as pointshell writes it.
struct SpherePart {
  explicit SpherePart(std::size_t points);

  double radius_m;
  Pshell shell;
};

// A mesh of that sphere which deviates from it by a tenth of a voxel: what a mesh collider needs.
mesh::Mesh sphere_mesh(double radius_m);

// Where the part is and what it does there, for the part that it was made for.
struct Setting {
  std::string name;
  mesh::Mesh scene;         // m
  mesh::Mesh grown;         // the scene grown to where contact begins, for colliders of bare meshes
  std::vector<Pose> poses;  // of the part's center, a millisecond apart
};

inline constexpr const char* kSettingNames[] = {"free space", "wall",     "corner", "tight fit",
                                                "everything", "tumbling", "post"};

// The motion of a hand of 50 mm/s and 0.5 rad/s at 1 kHz, but for `tumbling`, which is a new random
// orientation in every frame with every point in contact: the worst case. At `post` the part is
// held against a post of 32 x 32 voxels, so that the patch in contact is the same for any part.
Setting make_setting(const std::string& name, double radius_m, std::size_t frames);

}  // namespace forcelayer::bench
