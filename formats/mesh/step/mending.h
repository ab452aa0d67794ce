// Mends faces that OpenCASCADE does not tessellate as they are.
#pragma once

#include <ShapeBuild_ReShape.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>

namespace forcelayer::mesh {

// The face after ShapeFix_Face: one face or several, none where it fails. What becomes of its edges
// is noted in `context`, which applies it to the rest of the shape. Tolerances grow to at most
// `largest_tolerance_mm`.
TopoDS_Shape mend_face(const TopoDS_Face& face, const Handle(ShapeBuild_ReShape) & context,
                       double largest_tolerance_mm);

}  // namespace forcelayer::mesh
