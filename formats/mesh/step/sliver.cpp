#include "formats/mesh/step/sliver.h"

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "formats/mesh/step/edge_cover.h"

namespace forcelayer::mesh {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

// The one wire of the face as a closed polygon; empty where it has several, or none that closes.
std::vector<gp_Pnt> outline_of(const TopoDS_Face& face, double tolerance_mm) {
  TopExp_Explorer wires(face, TopAbs_WIRE);
  if (!wires.More()) return {};
  const TopoDS_Wire wire = TopoDS::Wire(wires.Current());
  wires.Next();
  if (wires.More()) return {};
  int edges = 0, walked = 0;
  for (TopExp_Explorer edge(wire, TopAbs_EDGE); edge.More(); edge.Next()) ++edges;
  std::vector<gp_Pnt> outline;
  for (BRepTools_WireExplorer walk(wire, face); walk.More(); walk.Next()) {
    ++walked;
    std::vector<gp_Pnt> polygon = edge_polygon(walk.Current(), tolerance_mm);
    if (walk.Current().Orientation() == TopAbs_REVERSED) {
      std::reverse(polygon.begin(), polygon.end());
    }
    outline.insert(outline.end(), polygon.begin(), polygon.end());
  }
  const bool closes = walked == edges && !outline.empty() &&
                      outline.front().Distance(outline.back()) <= tolerance_mm;
  return closes ? outline : std::vector<gp_Pnt>{};
}

// A polygon of points and the fraction of its length at which each of them stands.
struct Chain {
  std::vector<gp_Pnt> points;
  std::vector<double> fractions;  // ascending from 0 to 1

  explicit Chain(std::vector<gp_Pnt> along) : points(std::move(along)), fractions(points.size()) {
    for (std::size_t i = 1; i < points.size(); ++i) {
      fractions[i] = fractions[i - 1] + points[i].Distance(points[i - 1]);
    }
    const double length = fractions.back();
    for (double& fraction : fractions) fraction = length > 0 ? fraction / length : 0;
  }

  gp_Pnt at(double fraction) const {
    const auto after = std::upper_bound(fractions.begin(), fractions.end(), fraction);
    if (after == fractions.begin()) return points.front();
    if (after == fractions.end()) return points.back();
    const auto i = static_cast<std::size_t>(after - fractions.begin());
    const double part = (fraction - fractions[i - 1]) / (fractions[i] - fractions[i - 1]);
    return points[i - 1].Translated(gp_Vec(points[i - 1], points[i]).Multiplied(part));
  }
};

// Between two corners both ends of the segment move straight, so that it is longest at a corner.
double longest_segment(const Chain& a, const Chain& b) {
  double longest = 0;
  for (const Chain* chain : {&a, &b}) {
    for (const double fraction : chain->fractions) {
      longest = std::max(longest, a.at(fraction).Distance(b.at(fraction)));
    }
  }
  return longest;
}

double perimeter(const std::vector<gp_Pnt>& outline) {
  double length = outline.back().Distance(outline.front());
  for (std::size_t i = 1; i < outline.size(); ++i) length += outline[i].Distance(outline[i - 1]);
  return length;
}

double outline_width(const std::vector<gp_Pnt>& outline) {
  constexpr std::size_t kMaxPoints = 2000;  // the farthest two are sought among all pairs
  const std::size_t count = outline.size();
  if (count < 2 || count > kMaxPoints) return kUnknown;
  std::size_t from = 0, to = 1;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      if (outline[i].SquareDistance(outline[j]) > outline[from].SquareDistance(outline[to])) {
        from = i, to = j;
      }
    }
  }
  std::vector<gp_Pnt> forwards, backwards;
  for (std::size_t i = from; i <= to; ++i) forwards.push_back(outline[i]);
  for (std::size_t i = from + count; i >= to; --i) backwards.push_back(outline[i % count]);
  return longest_segment(Chain(std::move(forwards)), Chain(std::move(backwards)));
}

double box_diagonal(const TopoDS_Face& face) {
  Bnd_Box box;
  BRepBndLib::Add(face, box, false);
  if (box.IsVoid() || box.IsOpen()) return kUnknown;
  return std::sqrt(box.SquareExtent());
}

double area_of(const TopoDS_Face& face) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties);
  return std::abs(properties.Mass());
}

}  // namespace

double reach_from_edges(const TopoDS_Face& face, double tolerance_mm) {
  try {
    const double diagonal = box_diagonal(face);
    const std::vector<gp_Pnt> outline = outline_of(face, tolerance_mm);
    const double width = outline_width(outline) + 2 * tolerance_mm;
    if (!(width < diagonal)) return diagonal;
    return area_of(face) <= width * perimeter(outline) ? width : diagonal;
  } catch (const Standard_Failure&) {
    return kUnknown;
  }
}

}  // namespace forcelayer::mesh
