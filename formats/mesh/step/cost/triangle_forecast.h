// How many triangles a shape will have, before it is tessellated.
#pragma once

#include <TopoDS_Shape.hxx>

namespace forcelayer::mesh {

// About: from curvatures at some points of each face, which ask for edges of triangles no longer
// than the deflection, or the angle between them, allows. Planes count as next to nothing.
double forecast_triangles(const TopoDS_Shape& shape, double deflection_mm, double angle_rad);

}  // namespace forcelayer::mesh
