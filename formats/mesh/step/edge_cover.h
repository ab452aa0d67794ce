// Whether triangles reach everywhere along the edges of a face.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Pnt.hxx>
#include <vector>

namespace forcelayer::mesh {

// The edge as a polygon in its curve's direction that deviates from it by at most `tolerance_mm`;
// empty for an edge without length.
std::vector<gp_Pnt> edge_polygon(const TopoDS_Edge& edge, double tolerance_mm);

// Whether every point of the edges of `face` is within `distance_mm` of the triangles that `shape`
// has. The edges are replaced by polygons with this tolerance, which the distance includes.
bool covers_edges(const TopoDS_Shape& shape, const TopoDS_Face& face, double distance_mm,
                  double tolerance_mm);

}  // namespace forcelayer::mesh
