// Shells of an object: the closed surfaces that its triangles make where corners meet.
//
// Where two shells run through each other, each has faces inside of the other. Those bound no
// material, and so no depth.
#pragma once

#include <cstdint>
#include <vector>

#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::exact {

// [triangles] the number of its piece. Triangles of one object that have a corner in common, by its
// position, are of one piece; pieces are numbered in the order of their first triangles.
std::vector<std::uint32_t> pieces_of(const Surface& surface);

// [triangles] the number of its body, in the order of the objects. An object is one body, unless
// each of its pieces is closed: then pieces whose boxes meet, or of which only one has normals that
// point inwards, are bodies of their own. A cavity is of the body that it lies in.
std::vector<std::uint32_t> shells_apart(const Surface& surface);

}  // namespace forcelayer::exact
