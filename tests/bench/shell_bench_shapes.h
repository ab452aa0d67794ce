// Shapes with a closed form, to judge a shell's normals and places against.
#pragma once

#include <vector>

#include "formats/mesh/mesh.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::bench {

// One smooth face of a shape, seen from a place near it.
struct FaceTruth {
  double distance;     // m, from the place
  part::Vec3 outward;  // unit normal where the face is nearest
};

struct AnalyticShape {
  const char* name;
  mesh::Mesh mesh;  // 1 m across, give or take; tessellated
  // All faces, the nearest first.
  std::vector<FaceTruth> (*faces)(const part::Vec3& place);
};

// Sphere, torus, box, cylinder and cone.
std::vector<AnalyticShape> analytic_shapes();

}  // namespace forcelayer::bench
