// Whether triangles reach everywhere along the edges of a face.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <array>
#include <gp_Pnt.hxx>
#include <vector>

#include "formats/mesh/mesh.h"

namespace forcelayer::mesh {

// The edge as a polygon in its curve's direction that deviates from it by at most `tolerance_mm`;
// empty for an edge without length.
std::vector<gp_Pnt> edge_polygon(const TopoDS_Edge& edge, double tolerance_mm);

// Whether the edges of a tessellated face run along edges of its triangles. OpenCASCADE gives some
// faces triangles that do not reach their outline.
bool has_whole_outline(const TopoDS_Face& face);

using Corners = std::array<gp_XYZ, 3>;  // of a triangle, millimeters
double distance_to_triangle(const gp_XYZ& p, const Corners& t);
std::vector<Corners> triangles_of(const TopoDS_Shape& shape);
std::vector<Corners> triangles_of(const Mesh& mesh);

// Whether every point of the edges of `face` is within `distance_mm` of the triangles. The edges
// are replaced by polygons with this tolerance, which the distance includes.
bool covers_edges(const std::vector<Corners>& triangles, const TopoDS_Face& face,
                  double distance_mm, double tolerance_mm);

}  // namespace forcelayer::mesh
