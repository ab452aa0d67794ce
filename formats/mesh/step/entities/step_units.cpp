#include "formats/mesh/step/entities/step_units.h"

#include <STEPConstruct_UnitContext.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>

namespace forcelayer::mesh {

std::optional<StepUnits> units_of(const Handle(Standard_Transient) & context) {
  Handle(StepRepr_GlobalUnitAssignedContext) units;
  if (const auto full = Handle(
          StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx)::DownCast(context);
      !full.IsNull()) {
    units = full->GlobalUnitAssignedContext();
  } else if (const auto brief =
                 Handle(StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext)::
                     DownCast(context);
             !brief.IsNull()) {
    units = brief->GlobalUnitAssignedContext();
  }
  STEPConstruct_UnitContext factors;
  if (units.IsNull() || factors.ComputeFactors(units) != 0 || !factors.LengthDone()) {
    return {};
  }
  return StepUnits{factors.LengthFactor(),
                   factors.PlaneAngleDone() ? factors.PlaneAngleFactor() : 1};
}

}  // namespace forcelayer::mesh
