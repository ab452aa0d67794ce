#include "formats/mesh/step/entities/step_units.h"

#include <STEPConstruct_UnitContext.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepGeom_Placement.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepShape_ShapeRepresentation.hxx>

#include "formats/mesh/step/entities/lost_pieces.h"

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

std::string shape_without_unit(const Handle(XSControl_WorkSession) & session) {
  const auto model = Handle(StepData_StepModel)::DownCast(session->Model());
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const auto shape = Handle(StepShape_ShapeRepresentation)::DownCast(model->Value(i));
    if (shape.IsNull() || units_of(shape->ContextOfItems())) continue;
    for (Standard_Integer n = 1; n <= shape->NbItems(); ++n) {
      const auto item = shape->ItemsValue(n);
      if (!item.IsNull() && !item->IsKind(STANDARD_TYPE(StepGeom_Placement))) {
        return step_name(model, shape);
      }
    }
  }
  return "";
}

}  // namespace forcelayer::mesh
