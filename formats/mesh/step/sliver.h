// How far the points of a face are from its edges.
#pragma once

#include <TopoDS_Face.hxx>

namespace forcelayer::mesh {

// No point of `face` is farther than this, in millimeters, from some point of its edges; infinite
// where that is not known. `tolerance_mm`: of the polygons that stand for the edges; it is part
// of the result.
//
// The bound is the diagonal of the face's box, or the width of its outline where that is less: the
// outline is cut at its two farthest points, and the segments between points of the two halves at
// equal fractions of their lengths sweep over every point of the face, which is thus nearer to the
// outline than the longest segment is long. That holds for a face that lies within its outline (a
// sphere with a slit does not), as its area shows.
double reach_from_edges(const TopoDS_Face& face, double tolerance_mm);

}  // namespace forcelayer::mesh
