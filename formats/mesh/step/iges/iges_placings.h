// Transformation matrices (124) and subfigure instances (408) of an IGES file.
#pragma once

#include <IGESData_IGESEntity.hxx>
#include <XSControl_WorkSession.hxx>
#include <set>
#include <string_view>
#include <vector>

namespace forcelayer::mesh {

// Placings that OpenCASCADE 7.6 leaves out or applies wrong, and that settle_iges_placings() cannot
// rewrite.
struct IgesMisplaced {
  std::vector<Handle(IGESData_IGESEntity)> holders;  // faces, solids and groups, misplaced whole
  std::set<int> geometry;  // directory entries of points, curves and surfaces
};

// Rewrites placings of the file that was read in `session` so that OpenCASCADE applies them right.
// A matrix that names another one becomes their product (IGES 5.3, 4.21), of which OpenCASCADE
// would drop the other. An instance with a matrix gets one matrix for all it says: OpenCASCADE adds
// its translation without the rotation. Returns what it cannot rewrite: matrices that are no
// rotation, mirror and translation, that name each other in a circle, that are not there, or that
// belong to an entity whose matrix OpenCASCADE ignores; scaled instances. `text`: the file.
IgesMisplaced settle_iges_placings(const Handle(XSControl_WorkSession) & session,
                                   std::string_view text);

}  // namespace forcelayer::mesh
