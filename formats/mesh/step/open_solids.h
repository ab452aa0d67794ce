// Solids that do not close as OpenCASCADE reads them.
#pragma once

#include <XSControl_WorkSession.hxx>
#include <string>
#include <vector>

namespace forcelayer::mesh {

// A line about each solid or closed shell of the file that was transferred in `session` that has
// edges of one face only, where all its faces are sewn within `tolerance_mm`: a damaged edge or
// face leaves it open.
std::vector<std::string> open_solids(const Handle(XSControl_WorkSession) & session,
                                     double tolerance_mm);

}  // namespace forcelayer::mesh
