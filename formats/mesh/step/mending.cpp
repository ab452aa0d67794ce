#include "formats/mesh/step/mending.h"

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Precision.hxx>
#include <ShapeFix_Face.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>

#include "formats/mesh/step/entities/faces.h"

namespace forcelayer::mesh {
TopoDS_Shape mend_face(const TopoDS_Face& face, const Handle(ShapeBuild_ReShape) & context,
                       double largest_tolerance_mm) {
  try {
    const Handle(ShapeFix_Face) fix = new ShapeFix_Face(face);
    fix->SetContext(context);
    fix->SetPrecision(Precision::Confusion());
    fix->SetMaxTolerance(std::max(largest_tolerance_mm, Precision::Confusion()));
    fix->Perform();
    return context->Apply(face);
  } catch (const Standard_Failure&) {
    return {};
  }
}

std::optional<SewnShape> sew_loose_faces(const TopoDS_Shape& shape, double tolerance_mm) {
  SewnShape sewn;
  BRepBuilderAPI_Sewing sewing(tolerance_mm);
  for (TopExp_Explorer face(shape, TopAbs_FACE, TopAbs_SHELL); face.More(); face.Next()) {
    sewing.Add(face.Current());
    ++sewn.faces;
  }
  if (sewn.faces < 2) return {};
  try {
    sewing.Perform();
  } catch (const Standard_Failure&) {
    return {};  // loose they are read as well
  }
  const TopoDS_Shape joined = sewing.SewedShape();
  if (joined.IsNull() || sewing.NbContigousEdges() == 0 || count_faces(joined) != sewn.faces) {
    return {};
  }
  for (Standard_Integer n = 1; n <= sewing.NbContigousEdges(); ++n) {
    sewn.gap_mm = std::max(sewn.gap_mm, BRep_Tool::Tolerance(sewing.ContigousEdge(n)));
  }
  TopoDS_Compound whole;
  const BRep_Builder builder;
  builder.MakeCompound(whole);
  builder.Add(whole, joined);
  for (TopExp_Explorer shell(shape, TopAbs_SHELL); shell.More(); shell.Next()) {
    builder.Add(whole, shell.Current());
  }
  sewn.shape = whole;
  return sewn;
}

}  // namespace forcelayer::mesh
