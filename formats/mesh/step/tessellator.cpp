#include "formats/mesh/step/tessellator.h"

#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>

#include "formats/mesh/step/cost/triangle_forecast.h"
#include "formats/mesh/step/edge_cover.h"
#include "formats/mesh/step/holes.h"
#include "formats/mesh/step/sewing.h"
#include "formats/mesh/step/sliver.h"
#include "formats/mesh/step/spline_deviation.h"

namespace forcelayer::mesh {
namespace {

constexpr double kAngularDeflectionRad = 0.35;  // 20 degrees: what small rounds need to stay round
// Other deflections to try, in those that were asked for.
constexpr double kFinerDeflections[] = {0.5, 0.25}, kCoarserDeflections[] = {2, 4};
// In deflections: how far the edges of a face may be from triangles that do not end at them, and
// polygons from edges in such tests.
constexpr double kLooseReach = 2, kPolygonTolerance = 0.1;

using Faces = std::vector<TopoDS_Face>;

Handle(Poly_Triangulation) triangulation_of(const TopoDS_Face& face, TopLoc_Location& location) {
  const Handle(Poly_Triangulation) made = BRep_Tool::Triangulation(face, location);
  return made.IsNull() || made->NbTriangles() == 0 ? Handle(Poly_Triangulation)() : made;
}

// Faces that OpenCASCADE fails on get no triangles.
void tessellate(const TopoDS_Shape& shape, double deflection_mm) {
  try {
    BRepMesh_IncrementalMesh(shape, deflection_mm, false, kAngularDeflectionRad, false);
  } catch (const Standard_Failure&) {
  }
}

// A face without edges is somewhere in the box of its shape.
LostFace lost_face(const TopoDS_Face& face, const TopoDS_Shape& shape) {
  LostFace lost = box_of_edges(face);
  if (lost.size_mm > 0) return lost;
  lost = box_of_edges(shape);
  lost.has_edges = false;
  return lost;
}

// ReadOptions::deflection_m of kDeflectionBySize.
double deflection_by_size_mm(double diagonal_mm) {
  constexpr double kFinest = 0.1, kFraction = 1e-4;
  return std::max(kFinest, kFraction * diagonal_mm);
}

double deflection_by_size_mm(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, false);
  if (box.IsVoid() || box.IsOpen()) return deflection_by_size_mm(0);
  return deflection_by_size_mm(box.CornerMin().Distance(box.CornerMax()));
}

double deflection_by_size_mm(const Mesh& mesh) {
  const Box box = box_of(mesh, Affine{});
  double square = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    square += std::pow(std::max(0.0, box.high[axis] - box.low[axis]), 2);
  }
  return deflection_by_size_mm(std::sqrt(square));
}

// How far the edges of a face may be from their corners and from each other.
double largest_tolerance(const TopoDS_Face& face) {
  double largest_mm = 0;
  for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next()) {
    largest_mm = std::max(largest_mm, BRep_Tool::Tolerance(TopoDS::Edge(edge.Current())));
  }
  for (TopExp_Explorer corner(face, TopAbs_VERTEX); corner.More(); corner.Next()) {
    largest_mm = std::max(largest_mm, BRep_Tool::Tolerance(TopoDS::Vertex(corner.Current())));
  }
  return largest_mm;
}

// The faces whose triangles have holes where they do not close: all where no edge is of one face
// only, else those of solids, and of bodies that are known to be open, where such edges have no
// other beside them.
FaceSet faces_that_close(const TopoDS_Shape& shape, const FaceSet& of_open_bodies,
                         double tolerance_mm) {
  FaceSet faces;
  const auto add = [&](TopExp_Explorer face, bool all) {
    for (; face.More(); face.Next()) {
      const TopoDS_TShape* current = face.Current().TShape().get();
      if (all || of_open_bodies.contains(current)) faces.insert(current);
    }
  };
  const bool is_closed = count_open_edges(shape) == 0;
  if (!is_closed && count_open_edges(shape, tolerance_mm) == 0) return faces;
  add(TopExp_Explorer(shape, TopAbs_FACE), is_closed);
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) {
    add(TopExp_Explorer(solid.Current(), TopAbs_FACE), true);
  }
  return faces;
}

TopoDS_Compound compound_of(const Faces& faces) {
  TopoDS_Compound compound;
  const BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, face);
  return compound;
}

// The attempts at one shape.
class ShapeTessellation {
 public:
  ShapeTessellation(const SourceFile& file, const TopoDS_Shape& shape,
                    const FaceSet& of_open_bodies, double deflection_mm)
      : file_(file),
        shape_(shape),
        deflection_mm_(deflection_mm),
        closing_(faces_that_close(shape, of_open_bodies, deflection_mm)) {
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      all_close_ = all_close_ && closing_.contains(face.Current().TShape().get());
    }
  }

  // Finer triangles cost least, and keep the faces joined; dropping a face costs its reach, coarser
  // triangles theirs.
  Tessellation best() {
    tessellate(shape_, deflection_mm_);
    Attempt best = attempt(deflection_mm_);
    for (const double fraction : kFinerDeflections) try_deflection(fraction * deflection_mm_, best);
    drop_slivers(best, deflection_mm_);
    for (const double fraction : kCoarserDeflections)
      try_deflection(fraction * deflection_mm_, best);
    // A sliver that would be dropped where the deflection is chosen by size is no reason to refuse
    // a file for a finer one.
    drop_slivers(best, std::max(deflection_mm_, deflection_by_size_mm(shape_)));
    best.made.wanted_deflection_mm = deflection_mm_;
    for (const TopoDS_Face& face : best.failed) {
      best.made.lost.push_back(lost_face(face, shape_));
    }
    return std::move(best.made);
  }

 private:
  struct Attempt {
    Tessellation made;
    Faces failed;  // not tessellated, and not dropped
  };

  // The triangles of the shape, tessellated at this deflection.
  Attempt attempt(double deflection_mm) const {
    Attempt result;
    result.made.mesh.single_precision = false;
    result.made.deflection_mm = deflection_mm;
    result.made.deviation_mm = deflection_mm;
    std::vector<Triangle> closing;
    for (TopExp_Explorer face(shape_, TopAbs_FACE); face.More(); face.Next()) {
      const TopoDS_Face& current = TopoDS::Face(face.Current());
      if (is_tessellated(current, deflection_mm)) {
        const std::size_t before = result.made.mesh.triangles.size();
        add(current, deflection_mm, result.made);
        if (!all_close_ && closing_.contains(current.TShape().get())) {
          const auto& triangles = result.made.mesh.triangles;
          closing.insert(closing.end(), triangles.begin() + static_cast<std::ptrdiff_t>(before),
                         triangles.end());
        }
      } else {
        result.failed.push_back(current);
      }
    }
    Tessellation& made = result.made;
    double gap_mm = made.edge_gap_mm <= reach_mm(deflection_mm) ? made.tied_gap_mm : 0;
    if (result.failed.empty() && (all_close_ || !closing.empty())) {
      const double tolerance_mm = kPolygonTolerance * deflection_mm_;
      gap_mm =
          std::max(gap_mm, all_close_ ? widest_hole(made.mesh, tolerance_mm)
                                      : widest_hole({made.mesh.vertices, closing}, tolerance_mm));
    }
    made.edge_gap_mm = std::max(made.edge_gap_mm, gap_mm);
    made.deviation_mm = std::max(made.deviation_mm, gap_mm);
    return result;
  }

  // Drops the faces that leave no hole: no point of them is farther than `max_mm` from their edges,
  // and these are within a deviation of triangles of others.
  void drop_slivers(Attempt& result, double max_mm) const {
    if (result.failed.empty()) return;
    Tessellation& made = result.made;
    const double own_mm = made.deviation_mm - made.dropped_reach_mm;  // of the triangles
    const std::vector<Corners> triangles = triangles_of(made.mesh);
    std::erase_if(result.failed, [&](const TopoDS_Face& face) {
      const double tolerance_mm = kPolygonTolerance * deflection_mm_;
      const double reach_mm = reach_from_edges(face, tolerance_mm);
      if (!(reach_mm <= max_mm)) return false;
      if (!covers_edges(triangles, face, own_mm, tolerance_mm)) return false;
      ++made.dropped;
      made.dropped_reach_mm = std::max(made.dropped_reach_mm, reach_mm);
      return true;
    });
    made.deviation_mm = own_mm + made.dropped_reach_mm;
  }

  // Takes this deflection where fewer faces fail at it.
  void try_deflection(double deflection_mm, Attempt& best) const {
    if (best.failed.empty() || !succeeds_alone(best.failed, deflection_mm)) return;
    BRepTools::Clean(shape_);
    tessellate(shape_, deflection_mm);
    keep_better(attempt(deflection_mm), best);
  }

  // Faces that were dropped before are dropped again, where they fail again.
  void keep_better(Attempt other, Attempt& best) const {
    if (best.made.dropped > 0) drop_slivers(other, deflection_mm_);
    if (other.failed.size() < best.failed.size()) best = std::move(other);
  }

  // Whether one of the faces, which are few, succeeds: else the whole shape is not tried.
  bool succeeds_alone(const Faces& faces, double deflection_mm) const {
    const TopoDS_Compound alone = compound_of(faces);
    BRepTools::Clean(alone);
    tessellate(alone, deflection_mm);
    return std::any_of(faces.begin(), faces.end(), [&](const TopoDS_Face& face) {
      return is_tessellated(face, deflection_mm);
    });
  }

  // Whether the face has triangles, and they reach its outline.
  bool is_tessellated(const TopoDS_Face& face, double deflection_mm) const {
    TopLoc_Location ignored;
    const Handle(Poly_Triangulation) made = triangulation_of(face, ignored);
    return !made.IsNull() && (has_whole_outline(face) ||
                              covers_edges(triangles_of(face), face,
                                           reach_mm(std::max(deflection_mm, made->Deflection())),
                                           kPolygonTolerance * deflection_mm_));
  }

  // How far the edges of a face may be from triangles that do not end at them.
  double reach_mm(double deflection_mm) const {
    return kLooseReach * std::max(deflection_mm, deflection_mm_);
  }

  // OpenCASCADE found that the triangles of the face deviate by `found_mm`: its edges, or else its
  // surface, of which a smaller bound may be proven.
  void add_gap(const TopoDS_Face& face, double found_mm, double deflection_mm,
               Tessellation& made) const {
    double gap_mm = found_mm;
    const double near_mm = reach_mm(deflection_mm);
    const double tolerance_mm = largest_tolerance(face);
    const bool are_edges_near =
        (found_mm <= near_mm && tolerance_mm <= near_mm) ||
        covers_edges(triangles_of(face), face, near_mm, kPolygonTolerance * deflection_mm_);
    if (!are_edges_near && found_mm <= near_mm) {
      made.tied_gap_mm = std::max(made.tied_gap_mm, tolerance_mm);
    }
    const bool is_of_surface = are_edges_near && found_mm > near_mm;
    if (is_of_surface) {
      const std::optional<double> proven_mm = spline_deviation_mm(face, near_mm);
      if (proven_mm) gap_mm = std::min(found_mm, std::max(near_mm, *proven_mm));
    }
    double& told_mm = is_of_surface ? made.surface_gap_mm : made.edge_gap_mm;
    told_mm = std::max(told_mm, gap_mm);
    made.deviation_mm = std::max(made.deviation_mm, gap_mm);
  }

  void add(const TopoDS_Face& face, double deflection_mm, Tessellation& made) const {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) triangulation = triangulation_of(face, location);
    add_gap(face, triangulation->Deflection(), deflection_mm, made);
    if (!has_whole_outline(face)) {
      made.deviation_mm = std::max(made.deviation_mm,
                                   reach_mm(std::max(deflection_mm, triangulation->Deflection())));
    }
    Mesh& mesh = made.mesh;
    check_count(file_, mesh.vertices.size() + static_cast<std::uint64_t>(triangulation->NbNodes()),
                "vertices");
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (Standard_Integer i = 1; i <= triangulation->NbNodes(); ++i) {
      const gp_Pnt node = triangulation->Node(i).Transformed(location.Transformation());
      mesh.vertices.push_back({node.X(), node.Y(), node.Z()});
    }
    for (Standard_Integer i = 1; i <= triangulation->NbTriangles(); ++i) {
      Standard_Integer a = 0, b = 0, c = 0;
      triangulation->Triangle(i).Get(a, b, c);
      if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
      const auto corner = [&](Standard_Integer n) {
        return first + static_cast<std::uint32_t>(n - 1);
      };
      mesh.triangles.push_back({corner(a), corner(b), corner(c)});
    }
  }

  const SourceFile& file_;
  const TopoDS_Shape& shape_;
  double deflection_mm_;
  FaceSet closing_;  // those whose triangles should close
  bool all_close_ = true;
};

}  // namespace

LostFace box_of_edges(const TopoDS_Shape& shape) {
  Bnd_Box box;
  for (TopExp_Explorer edge(shape, TopAbs_EDGE); edge.More(); edge.Next()) {
    BRepBndLib::Add(edge.Current(), box, false);
  }
  if (box.IsVoid() || box.IsOpen()) return {};
  const gp_XYZ low = box.CornerMin().XYZ(), high = box.CornerMax().XYZ();
  const gp_XYZ center = 0.5 * (low + high);
  return {{center.X(), center.Y(), center.Z()}, (high - low).Modulus(), true};
}

// Without triangles where there is nothing to sew.
Tessellation StepTessellator::tessellate_sewn(const TopoDS_Shape& shape,
                                              double deflection_mm) const {
  const auto sewn = sew_loose_faces(shape, deflection_mm);
  if (!sewn) return {};
  Tessellation made =
      ShapeTessellation(file_, sewn->shape, faces_of_open_bodies_, deflection_mm).best();
  made.sewn = sewn->faces;
  made.sewn_gap_mm = sewn->gap_mm;
  made.open_edges = sewn->open_edges;
  made.sewing_tolerance_mm = deflection_mm;
  made.deviation_mm += sewn->gap_mm;
  return made;
}

Tessellation StepTessellator::tessellate_at(const TopoDS_Shape& shape, double deflection_mm) const {
  Tessellation made = tessellate_sewn(shape, deflection_mm);
  if (made.sewn == 0 || !made.lost.empty()) {
    Tessellation loose =
        ShapeTessellation(file_, shape, faces_of_open_bodies_, deflection_mm).best();
    if (made.sewn == 0 || loose.lost.size() < made.lost.size()) made = std::move(loose);
  }
  return made;
}

void StepTessellator::add_open_bodies(std::span<const TopoDS_Shape> bodies) {
  for (const TopoDS_Shape& body : bodies) {
    for (TopExp_Explorer face(body, TopAbs_FACE); face.More(); face.Next()) {
      faces_of_open_bodies_.insert(face.Current().TShape().get());
    }
  }
}

double StepTessellator::forecast(const TopoDS_Shape& shape) const {
  return forecast_triangles(shape, deflection_mm(shape), kAngularDeflectionRad);
}

double StepTessellator::deflection_mm(const TopoDS_Shape& shape) const {
  return deflection_mm_ == kDeflectionBySize ? deflection_by_size_mm(shape) : deflection_mm_;
}

Tessellation StepTessellator::tessellate(const TopoDS_Shape& shape, const std::string& name) {
  const bool by_size = deflection_mm_ == kDeflectionBySize;
  const double deflection_mm = this->deflection_mm(shape);
  Tessellation made = tessellate_at(shape, deflection_mm);
  if (by_size && deflection_by_size_mm(made.mesh) < deflection_mm / 2) {
    // The box of an edge that leads away from its faces is not the size of the shape.
    const double finer_mm = deflection_by_size_mm(made.mesh);
    BRepTools::Clean(shape);
    made = tessellate_at(shape, finer_mm);
  }
  check_finite(file_, made.mesh, name);
  return made;
}

}  // namespace forcelayer::mesh
