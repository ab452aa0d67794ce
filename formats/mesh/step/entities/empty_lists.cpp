#include "formats/mesh/step/entities/empty_lists.h"

#include <StepBasic_DerivedUnit.hxx>
#include <StepBasic_HArray1OfDerivedUnitElement.hxx>
#include <StepGeom_HArray1OfPcurveOrSurface.hxx>
#include <StepGeom_SurfaceCurve.hxx>

namespace forcelayer::mesh {
namespace {

bool fill(const Handle(Standard_Transient) & entity) {
  const auto curve = Handle(StepGeom_SurfaceCurve)::DownCast(entity);
  if (!curve.IsNull() && curve->AssociatedGeometry().IsNull() && !curve->Curve3d().IsNull()) {
    curve->SetAssociatedGeometry(new StepGeom_HArray1OfPcurveOrSurface(1, 1));
    return true;
  }
  const auto unit = Handle(StepBasic_DerivedUnit)::DownCast(entity);
  if (!unit.IsNull() && unit->Elements().IsNull()) {
    unit->SetElements(new StepBasic_HArray1OfDerivedUnitElement(1, 1));
    return true;
  }
  return false;
}

}  // namespace

bool fill_empty_lists(const Handle(Interface_InterfaceModel) & model) {
  bool is_any_filled = false;
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    if (!fill(model->Value(i))) continue;
    model->ClearReportEntity(i);
    is_any_filled = true;
  }
  return is_any_filled;
}

}  // namespace forcelayer::mesh
