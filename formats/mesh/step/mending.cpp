#include "formats/mesh/step/mending.h"

#include <Precision.hxx>
#include <ShapeFix_Face.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>

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

}  // namespace forcelayer::mesh
