// The units that a representation of a STEP file is written in.
#pragma once

#include <Standard_Handle.hxx>
#include <Standard_Transient.hxx>
#include <optional>

namespace forcelayer::mesh {

struct StepUnits {
  double mm = 1, radians = 1;  // of one unit of length and of one of angle
};

// The units of a representation's context; nothing where it states no unit of length.
std::optional<StepUnits> units_of(const Handle(Standard_Transient) & context);

}  // namespace forcelayer::mesh
