// Edges of triangles that enclose nothing there: of holes and cracks, and where more than two faces
// meet.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "formats/mesh/mesh.h"
#include "pointshell/part/part.h"

namespace forcelayer::part {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // low and high vertex

// Edges that triangles do not run along as often forwards as backwards, and how much more often
// from the low to the high vertex.
std::map<Edge, int> open_edges_of(const std::vector<mesh::Triangle>& triangles);

// Triangles that close what these open edges of a body leave open: those of edges that hang
// together have one vertex in common, the middle of their ends. The winding numbers of the body and
// of them sum up to a whole number everywhere: as far as the body's is off a whole one, theirs is,
// too. Around a crack they are few, small and flat.
Part caps_of(const Part& body, const std::map<Edge, int>& open);

}  // namespace forcelayer::part
