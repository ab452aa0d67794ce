// Finds points and directions in space that a STEP file gives other than three numbers.
#pragma once

#include <Standard_Transient.hxx>
#include <XSControl_WorkSession.hxx>
#include <string_view>
#include <unordered_set>

namespace forcelayer::mesh {

// The points, directions and lists of coordinates that geometry in space refers to and that have
// fewer or more than three numbers, in the file of this text that was read in `session`:
// OpenCASCADE takes a number that is left out for 0, and leaves out a fourth.
std::unordered_set<const Standard_Transient*> entities_without_three_numbers(
    const Handle(XSControl_WorkSession) & session, std::string_view text);

}  // namespace forcelayer::mesh
