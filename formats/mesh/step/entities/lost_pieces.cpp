#include "formats/mesh/step/entities/lost_pieces.h"

#include <Interface_EntityIterator.hxx>
#include <Interface_UndefinedContent.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <StepRepr_RepresentationRelationshipWithTransformation.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepVisual_StyledItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <unordered_set>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {
namespace {

using Entity = Handle(Standard_Transient);

// The whole of an occurrence in an assembly.
Handle(StepBasic_ProductDefinition) whole_of(const Entity& entity) {
  auto use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(entity);
  const auto placing = Handle(StepShape_ContextDependentShapeRepresentation)::DownCast(entity);
  if (!placing.IsNull() && !placing->RepresentedProductRelation().IsNull()) {
    use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(
        placing->RepresentedProductRelation()->Definition().ProductDefinitionRelationship());
  }
  return use.IsNull() ? Handle(StepBasic_ProductDefinition)() : use->RelatingProductDefinition();
}

// Looks for an entity's products among what refers to it.
class PieceFinder {
 public:
  PieceFinder(const Handle(XSControl_WorkSession) & session, const Entity& entity)
      : graph_(session->Graph()) {
    if (const auto whole = whole_of(entity); !whole.IsNull()) {
      piece.products.insert(whole);
      return;
    }
    climb(entity);
  }

  LostPiece piece;

 private:
  void climb(const Entity& entity) {
    if (!seen_.insert(entity.get()).second) return;
    Interface_EntityIterator user = graph_.Sharings(entity);
    for (user.Start(); user.More(); user.Next()) look_at_user(user.Value());
  }

  void look_at_user(const Entity& user) {
    if (const auto shape = Handle(StepShape_ShapeDefinitionRepresentation)::DownCast(user);
        !shape.IsNull()) {
      add_product(shape);
    } else if (const auto relation = Handle(StepRepr_RepresentationRelationship)::DownCast(user);
               !relation.IsNull()) {
      if (relation->IsKind(STANDARD_TYPE(StepRepr_RepresentationRelationshipWithTransformation)))
        return;
      for (const auto& other : {relation->Rep1(), relation->Rep2()}) {
        if (!other.IsNull()) climb(other);
      }
    } else if (!user->IsKind(STANDARD_TYPE(StepVisual_StyledItem)) &&
               (user->IsKind(STANDARD_TYPE(StepShape_ShapeRepresentation)) ||
                user->IsKind(STANDARD_TYPE(StepRepr_RepresentationItem)) ||
                user->IsKind(STANDARD_TYPE(StepRepr_RepresentationMap)) ||
                user->IsKind(STANDARD_TYPE(StepData_UndefinedEntity)))) {
      climb(user);
    }
  }

  void add_product(const Handle(StepShape_ShapeDefinitionRepresentation) & shape) {
    const auto of =
        Handle(StepRepr_ProductDefinitionShape)::DownCast(shape->Definition().PropertyDefinition());
    if (of.IsNull()) return;
    const Handle(StepBasic_ProductDefinition) product = of->Definition().ProductDefinition();
    if (!product.IsNull()) piece.products.insert(product);
  }

  const Interface_Graph& graph_;
  std::unordered_set<const Standard_Transient*> seen_;
};

}  // namespace

std::string step_name(const Handle(StepData_StepModel) & model, const Entity& entity) {
  std::string name = "#" + std::to_string(model->IdentLabel(entity)) + " ";
  const auto unknown = Handle(StepData_UndefinedEntity)::DownCast(entity);
  Handle(TCollection_HAsciiString) given;
  if (!unknown.IsNull()) {
    name += unknown->StepType();
    Entity none;
    Interface_ParamType type{};
    const Handle(Interface_UndefinedContent) content = unknown->UndefinedContent();
    if (content->NbParams() > 0 && content->ParamType(1) == Interface_ParamText) {
      content->ParamData(1, type, none, given);
      given->RemoveAll('\'', Standard_True);
    }
  } else {
    name += model->TypeName(entity);
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(entity);
    if (!item.IsNull()) given = item->Name();
  }
  if (!given.IsNull() && !given->IsEmpty()) name += " " + in_quotes(given->ToCString());
  return name;
}

LostPiece step_piece(const Handle(XSControl_WorkSession) & session, const Entity& entity) {
  LostPiece piece = PieceFinder(session, entity).piece;
  piece.name = step_name(Handle(StepData_StepModel)::DownCast(session->Model()), entity);
  return piece;
}

}  // namespace forcelayer::mesh
