#include "formats/mesh/step/entities/hidden.h"

#include <StepRepr_MappedItem.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_FaceBasedSurfaceModel.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
#include <StepVisual_Invisibility.hxx>
#include <StepVisual_InvisibleItem.hxx>
#include <StepVisual_LayeredItem.hxx>
#include <StepVisual_PresentationLayerAssignment.hxx>
#include <StepVisual_StyledItem.hxx>
#include <StepVisual_StyledItemTarget.hxx>
#include <set>

namespace forcelayer::mesh {
namespace {

using Entity = Handle(Standard_Transient);

class HiddenBodies {
 public:
  std::uint64_t count() const { return bodies_.size(); }

  void add(const Entity& hidden) {
    if (hidden.IsNull()) return;
    if (const auto style = Handle(StepVisual_StyledItem)::DownCast(hidden); !style.IsNull()) {
      add_body(style->Item());
      add_body(style->ItemAP242().Value());
    } else if (const auto layer = Handle(StepVisual_PresentationLayerAssignment)::DownCast(hidden);
               !layer.IsNull() && !layer->AssignedItems().IsNull()) {
      for (Standard_Integer i = 1; i <= layer->NbAssignedItems(); ++i) {
        add_body(layer->AssignedItemsValue(i).Value());
      }
    }
  }

 private:
  void add_body(const Entity& entity) {
    if (entity.IsNull()) return;
    for (const Handle(Standard_Type) & type :
         {STANDARD_TYPE(StepShape_SolidModel), STANDARD_TYPE(StepShape_ShellBasedSurfaceModel),
          STANDARD_TYPE(StepShape_FaceBasedSurfaceModel), STANDARD_TYPE(StepRepr_MappedItem),
          STANDARD_TYPE(StepShape_ShapeRepresentation)}) {
      if (entity->IsKind(type)) bodies_.insert(entity.get());
    }
  }

  std::set<const Standard_Transient*> bodies_;
};

}  // namespace

std::uint64_t count_hidden_bodies(const Handle(Interface_InterfaceModel) & model) {
  HiddenBodies hidden;
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const auto invisible = Handle(StepVisual_Invisibility)::DownCast(model->Value(i));
    if (invisible.IsNull() || invisible->InvisibleItems().IsNull()) continue;
    for (Standard_Integer n = 1; n <= invisible->NbInvisibleItems(); ++n) {
      hidden.add(invisible->InvisibleItemsValue(n).Value());
    }
  }
  return hidden.count();
}

}  // namespace forcelayer::mesh
