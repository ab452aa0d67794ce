#include "formats/mesh/step/edge_cover.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GCPnts_TangentialDeflection.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

namespace forcelayer::mesh {
namespace {

double distance_to_segment(const gp_XYZ& p, const gp_XYZ& a, const gp_XYZ& b) {
  const gp_XYZ side = b - a;
  const double length2 = side.SquareModulus();
  const double t = length2 > 0 ? std::clamp((p - a).Dot(side) / length2, 0.0, 1.0) : 0;
  return (p - a - t * side).Modulus();
}

// A segment whose ends are near one triangle is near it everywhere, because a triangle is convex.
bool covers_segment(const std::vector<Corners>& triangles, const gp_XYZ& a, const gp_XYZ& b,
                    double distance_mm) {
  const bool is_near = std::any_of(triangles.begin(), triangles.end(), [&](const Corners& t) {
    return distance_to_triangle(a, t) <= distance_mm && distance_to_triangle(b, t) <= distance_mm;
  });
  if (is_near) return true;
  constexpr double kShortest = 1.0 / 16;  // of the distance
  if ((b - a).Modulus() <= kShortest * distance_mm) return false;
  const gp_XYZ middle = 0.5 * (a + b);
  return covers_segment(triangles, a, middle, distance_mm) &&
         covers_segment(triangles, middle, b, distance_mm);
}

}  // namespace

double distance_to_triangle(const gp_XYZ& p, const Corners& t) {
  const double to_sides =
      std::min({distance_to_segment(p, t[0], t[1]), distance_to_segment(p, t[1], t[2]),
                distance_to_segment(p, t[2], t[0])});
  const gp_XYZ normal = (t[1] - t[0]).Crossed(t[2] - t[0]);
  const double length = normal.Modulus();
  if (!(length > 0)) return to_sides;
  for (std::size_t n = 0; n < 3; ++n) {  // over the inside only the plane is nearer
    if (normal.Dot((t[(n + 1) % 3] - t[n]).Crossed(p - t[n])) < 0) return to_sides;
  }
  return std::min(to_sides, std::abs((p - t[0]).Dot(normal)) / length);
}

std::vector<gp_Pnt> edge_polygon(const TopoDS_Edge& edge, double tolerance_mm) {
  constexpr double kAngularDeflectionRad = 0.1;
  if (BRep_Tool::Degenerated(edge)) return {};
  const BRepAdaptor_Curve curve(edge);
  const GCPnts_TangentialDeflection corners(curve, kAngularDeflectionRad, tolerance_mm);
  std::vector<gp_Pnt> polygon;
  for (Standard_Integer i = 1; i <= corners.NbPoints(); ++i) polygon.push_back(corners.Value(i));
  return polygon;
}

bool has_whole_outline(const TopoDS_Face& face) {
  using Side = std::pair<Standard_Integer, Standard_Integer>;
  TopLoc_Location location;
  const Handle(Poly_Triangulation) made = BRep_Tool::Triangulation(face, location);
  if (made.IsNull()) return false;
  std::set<Side> sides;
  for (Standard_Integer i = 1; i <= made->NbTriangles(); ++i) {
    const Poly_Triangle& triangle = made->Triangle(i);
    for (int n = 0; n < 3; ++n) {
      sides.insert(std::minmax({triangle.Value(n + 1), triangle.Value((n + 1) % 3 + 1)}));
    }
  }
  for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next()) {
    const Handle(Poly_PolygonOnTriangulation) polygon =
        BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(edge.Current()), made, location);
    if (polygon.IsNull()) return false;
    const TColStd_Array1OfInteger& nodes = polygon->Nodes();
    for (Standard_Integer i = nodes.Lower(); i < nodes.Upper(); ++i) {
      const Standard_Integer from = nodes.Value(i), to = nodes.Value(i + 1);
      if (made->Node(from).IsEqual(made->Node(to), 0)) continue;
      if (!sides.contains(std::minmax({from, to}))) return false;
    }
  }
  return true;
}

std::vector<Corners> triangles_of(const TopoDS_Shape& shape) {
  std::vector<Corners> triangles;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) made =
        BRep_Tool::Triangulation(TopoDS::Face(face.Current()), location);
    if (made.IsNull()) continue;
    for (Standard_Integer i = 1; i <= made->NbTriangles(); ++i) {
      Corners& corners = triangles.emplace_back();
      for (int n = 0; n < 3; ++n) {
        const gp_Pnt node = made->Node(made->Triangle(i).Value(n + 1));
        corners[static_cast<std::size_t>(n)] = node.Transformed(location.Transformation()).XYZ();
      }
    }
  }
  return triangles;
}

std::vector<Corners> triangles_of(const Mesh& mesh) {
  std::vector<Corners> triangles;
  for (const Triangle& triangle : mesh.triangles) {
    Corners& corners = triangles.emplace_back();
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& [x, y, z] = mesh.vertices[triangle[n]];
      corners[n] = {x, y, z};
    }
  }
  return triangles;
}

bool covers_edges(const std::vector<Corners>& triangles, const TopoDS_Face& face,
                  double distance_mm, double tolerance_mm) {
  std::vector<std::vector<gp_Pnt>> polygons;
  Bnd_Box around;
  for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next()) {
    polygons.push_back(edge_polygon(TopoDS::Edge(edge.Current()), tolerance_mm));
    for (const gp_Pnt& corner : polygons.back()) around.Add(corner);
  }
  if (around.IsVoid()) return true;
  around.Enlarge(distance_mm);
  std::vector<Corners> near;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(near),
               [&](const Corners& corners) {
                 Bnd_Box box;
                 for (const gp_XYZ& corner : corners) box.Add(gp_Pnt(corner));
                 return !box.IsOut(around);
               });
  for (const std::vector<gp_Pnt>& polygon : polygons) {
    for (std::size_t i = 1; i < polygon.size(); ++i) {
      if (!covers_segment(near, polygon[i - 1].XYZ(), polygon[i].XYZ(),
                          distance_mm - tolerance_mm)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace forcelayer::mesh
