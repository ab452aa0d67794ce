// Lists that a STEP file leaves empty, and OpenCASCADE crashes on.
#pragma once

#include <Interface_InterfaceModel.hxx>

namespace forcelayer::mesh {

// Gives them an element that is nothing, where nothing is lost by that: a curve in space needs none
// in the parameters of a surface. False where there are none.
bool fill_empty_lists(const Handle(Interface_InterfaceModel) & model);

}  // namespace forcelayer::mesh
