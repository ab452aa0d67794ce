// Solids that do not close as OpenCASCADE reads them.
#pragma once

#include <TopoDS_Shape.hxx>
#include <XSControl_WorkSession.hxx>
#include <string>
#include <vector>

namespace forcelayer::mesh {

struct OpenSolid {
  std::string line;  // for the user
  TopoDS_Shape shape;
};

// Each solid or closed shell of the file that was transferred in `session` that has edges of one
// face only, where all its faces are sewn within `tolerance_mm`: a damaged edge or face leaves it
// open. OpenCASCADE makes a shell of some such solids.
std::vector<OpenSolid> open_solids(const Handle(XSControl_WorkSession) & session,
                                   double tolerance_mm);

}  // namespace forcelayer::mesh
