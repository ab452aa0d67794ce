// The units that a representation of a STEP file is written in.
#pragma once

#include <XSControl_WorkSession.hxx>
#include <string>

namespace forcelayer::mesh {

// A representation of the file in `session` that lists shapes and whose context states no unit of
// length, as "#10 ADVANCED_BREP_SHAPE_REPRESENTATION"; "" where there is none.
std::string shape_without_unit(const Handle(XSControl_WorkSession) & session);

// A line about the first unit of length or angle of the file that is damaged, or of something else,
// such as a millisecond; "" where there is none. OpenCASCADE takes it for some unit without a word.
std::string odd_unit(const Handle(XSControl_WorkSession) & session);

}  // namespace forcelayer::mesh
