// How far a free-form face may lie from its triangles, proven.
#pragma once

#include <TopoDS_Face.hxx>
#include <optional>

namespace forcelayer::mesh {

// An upper bound of the distance from the surface of a tessellated face, within the triangles in
// its parameters, to these triangles: at most a tenth of `wanted_mm` above the largest distance, or
// `wanted_mm` where that is more. Nothing for what is no polynomial spline with continuous
// tangents, and where that takes too long.
//
// OpenCASCADE's own figure compares points of the same parameter. On a spline that its parameter
// runs along at varying speed it is the shift along the surface: 80 mm on one of 8 m whose
// triangles are within 1 mm of it.
std::optional<double> spline_deviation_mm(const TopoDS_Face& face, double wanted_mm);

}  // namespace forcelayer::mesh
