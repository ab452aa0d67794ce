// A scene's triangles in one mesh, for measurements that know no parts.
#pragma once

#include "formats/mesh/scene.h"

namespace forcelayer::bench {

// Every triangle of a scene, world frame, m times `scale`.
mesh::Mesh merged(const mesh::Scene& scene, double scale = 1);

// Longest side of the vertices' box, in the mesh's unit.
double longest_side(const mesh::Mesh& mesh);

}  // namespace forcelayer::bench
