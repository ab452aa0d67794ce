// The motion of a part through its scene as a file for viewers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/mesh/up_axis.h"
#include "formats/mesh/writers/glb.h"
#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/voxcheck/exact_exchange.h"
#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::exact {

// A scene and a part that moves, as nodes for viewers.
struct MovingScene {
  // The part about its centroid, then the objects of the scene from the nearest to the path to the
  // farthest.
  std::vector<mesh::GlbNode> nodes;
  std::vector<std::uint32_t> objects;  // [nodes] number in the voxmap; 0 of the part
  std::vector<double> away_m;          // [nodes] how far boxes of node and motion are apart
  mesh::GlbMotion motion;              // of the part
  mesh::Up up = mesh::Up::kZ;
};

// The animation's times are those of the rows, s, counted from the first one. Rows that change the
// position of no point by more than a micrometer are left out. Objects that are too many triangles
// are left out, with a warning.
MovingScene moving_scene(const voxcheck::ExactRequest& request, const Surface& scene,
                         const Voxmap& voxmap, const Surface& part, const Pshell& shell,
                         const std::vector<PathRow>& rows, std::vector<std::string>& warnings);

}  // namespace forcelayer::exact
