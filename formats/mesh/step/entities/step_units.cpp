#include "formats/mesh/step/entities/step_units.h"

#include <Interface_Check.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <StepBasic_ConversionBasedUnitAndLengthUnit.hxx>
#include <StepBasic_ConversionBasedUnitAndPlaneAngleUnit.hxx>
#include <StepBasic_LengthMeasureWithUnit.hxx>
#include <StepBasic_PlaneAngleMeasureWithUnit.hxx>
#include <StepBasic_SiUnitAndLengthUnit.hxx>
#include <StepBasic_SiUnitAndPlaneAngleUnit.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepGeom_Placement.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepShape_ShapeRepresentation.hxx>

#include "formats/mesh/step/entities/lost_pieces.h"

namespace forcelayer::mesh {

namespace {

// Whether the context of a representation states a unit of length that is understood.
bool has_unit_of_length(const Handle(Standard_Transient) & context) {
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
  return !units.IsNull() && factors.ComputeFactors(units) == 0 && factors.LengthDone();
}

}  // namespace

std::string shape_without_unit(const Handle(XSControl_WorkSession) & session) {
  const auto model = Handle(StepData_StepModel)::DownCast(session->Model());
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const auto shape = Handle(StepShape_ShapeRepresentation)::DownCast(model->Value(i));
    if (shape.IsNull() || has_unit_of_length(shape->ContextOfItems())) continue;
    for (Standard_Integer n = 1; n <= shape->NbItems(); ++n) {
      const auto item = shape->ItemsValue(n);
      if (!item.IsNull() && !item->IsKind(STANDARD_TYPE(StepGeom_Placement))) {
        return step_name(model, shape);
      }
    }
  }
  return "";
}

std::string odd_unit(const Handle(XSControl_WorkSession) & session) {
  const auto model = Handle(StepData_StepModel)::DownCast(session->Model());
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient)& entity = model->Value(i);
    const auto is = [&](const Handle(Standard_Type) & type) { return entity->IsKind(type); };
    const bool is_si_length = is(STANDARD_TYPE(StepBasic_SiUnitAndLengthUnit)),
               is_si_angle = is(STANDARD_TYPE(StepBasic_SiUnitAndPlaneAngleUnit));
    const bool is_length = is_si_length ||
                           is(STANDARD_TYPE(StepBasic_ConversionBasedUnitAndLengthUnit)) ||
                           is(STANDARD_TYPE(StepBasic_LengthMeasureWithUnit));
    const bool is_angle = is_si_angle ||
                          is(STANDARD_TYPE(StepBasic_ConversionBasedUnitAndPlaneAngleUnit)) ||
                          is(STANDARD_TYPE(StepBasic_PlaneAngleMeasureWithUnit));
    if (!is_length && !is_angle) continue;
    const auto si = Handle(StepBasic_SiUnit)::DownCast(entity);
    const bool is_other = (is_si_length && si->Name() != StepBasic_sunMetre) ||
                          (is_si_angle && si->Name() != StepBasic_sunRadian);
    if (is_other || model->Check(i, Standard_True)->NbFails() > 0) {
      return step_name(model, entity) + " is not a plausible unit of " +
             (is_length ? "length: check the model's size, and give the unit with --units"
                        : "angle: check the model's conical faces");
    }
  }
  return "";
}

}  // namespace forcelayer::mesh
