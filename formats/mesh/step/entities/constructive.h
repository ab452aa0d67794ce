// Constructive solids of a STEP file (ISO 10303-42): primitives, swept areas, and Boolean results
// of them. OpenCASCADE 7.6 knows these entities and makes no shapes of them.
#pragma once

#include <XSControl_WorkSession.hxx>

#include "formats/mesh/step/entities/losses.h"

namespace forcelayer::mesh {

// Makes the shapes of the constructive solids that shape representations list, in a file that was
// read and not yet transferred; the transfer then takes them like others. Returns the entities that
// they are made of. Leaves a solid alone that it does not understand whole, or whose Boolean result
// is doubtful: check_step_losses() names it.
ReadEntities make_constructive_solids(const Handle(XSControl_WorkSession) & session);

}  // namespace forcelayer::mesh
