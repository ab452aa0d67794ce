// Holes that OpenCASCADE leaves in the triangles of a closed shape, where it bends a damaged edge.
#pragma once

#include "formats/mesh/mesh.h"

namespace forcelayer::mesh {

// How far a point that the triangles should cover may be from them: the largest of all outlines of
// holes, each measured across its length. 0 for a closed mesh. A surface that bulges out of its
// outline may be farther. An edge that has another within `tolerance` beside it bounds a slit as
// wide as that.
double widest_hole(const Mesh& mesh, double tolerance);

}  // namespace forcelayer::mesh
