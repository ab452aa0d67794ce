// Tessellates the shapes of a STEP or IGES file.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// The triangles of a shape in its own frame, millimeters.
class StepTessellator {
 public:
  StepTessellator(const SourceFile& file, double deflection_mm)
      : file_(file), deflection_mm_(deflection_mm) {}

  // `name` is the node, for errors.
  Mesh tessellate(const TopoDS_Shape& shape, const std::string& name);

  double largest_deflection_mm() const { return largest_deflection_mm_; }

 private:
  bool add(const TopoDS_Face& face, Mesh& mesh);

  const SourceFile& file_;
  double deflection_mm_;
  double largest_deflection_mm_ = 0;
};

}  // namespace forcelayer::mesh
