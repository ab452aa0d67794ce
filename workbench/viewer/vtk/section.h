// Where a plane goes through what a mesh encloses.
#pragma once

#include <vtkPlane.h>

#include "workbench/viewer/vtk/geometry.h"

namespace forcelayer::viewer {

struct Section {
  PolyData faces;    // triangles in the plane
  PolyData outline;  // their outer and inner edges, as lines
};

// The filled section of a mesh. Lines in which the plane meets a sheet, which encloses nothing, are
// left out.
Section section_of(const PolyData& mesh, vtkPlane* plane);

}  // namespace forcelayer::viewer
