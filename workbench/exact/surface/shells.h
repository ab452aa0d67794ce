// Shells of an object: the closed surfaces that its triangles make where corners meet, or nearly.
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

// Turns each closed piece of which it is certain that its normals point to the wrong side: inwards,
// unless it is a cavity. One that lies in another piece of its object is a cavity where the two are
// turned to different sides, and the outer one is none.
void turn_outwards(Surface& surface);

// [triangles] the number of its body, from 0 on, for one object that turn_outwards() has seen. It
// is one body, unless it has several shells: then shells whose boxes meet are bodies of their own.
// A cavity is of the body that it lies in. Open pieces are one shell where their open edges are no
// farther from each other than cracks of `crack_m` allow. Without cracks, an object with an open
// piece is one body.
std::vector<std::uint32_t> shells_apart(const Surface& surface, double crack_m);

}  // namespace forcelayer::exact
