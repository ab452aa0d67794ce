#include "formats/mesh/step/entities/cut.h"

#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepRepr_DefinitionalRepresentation.hxx>
#include <StepRepr_HArray1OfRepresentationItem.hxx>
#include <StepRepr_ItemDefinedTransformation.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <StepRepr_RepresentationRelationship.hxx>
#include <StepShape_ConnectedFaceSet.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_Face.hxx>
#include <StepShape_HArray1OfFace.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepVisual_StyledItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <XSControl_TransferReader.hxx>

namespace forcelayer::mesh {
namespace {

using Entity = Handle(Standard_Transient);

bool is_definition(const Entity& entity) {
  return entity->IsKind(STANDARD_TYPE(StepShape_ShapeDefinitionRepresentation)) ||
         entity->IsKind(STANDARD_TYPE(StepShape_ContextDependentShapeRepresentation));
}

// Whether what is wrong with an entity is wrong with this user of it.
bool passes_on(const Entity& user) {
  if (user->IsKind(STANDARD_TYPE(StepVisual_StyledItem))) return false;
  for (const Handle(Standard_Type) & type :
       {STANDARD_TYPE(StepRepr_RepresentationItem), STANDARD_TYPE(StepRepr_RepresentationMap),
        STANDARD_TYPE(StepRepr_DefinitionalRepresentation),
        STANDARD_TYPE(StepRepr_ItemDefinedTransformation),
        STANDARD_TYPE(StepRepr_RepresentationRelationship),
        STANDARD_TYPE(StepData_UndefinedEntity)}) {
    if (user->IsKind(type)) return true;
  }
  return is_definition(user);
}

// `list` without null handles and without those in `out`.
template <typename Array, typename Set>
Handle(Array) shortened(const Handle(Array) & list, const Set& out) {
  std::vector<typename Array::value_type> left;
  for (Standard_Integer i = list->Lower(); i <= list->Upper(); ++i) {
    if (!list->Value(i).IsNull() && !out.contains(list->Value(i).get())) {
      left.push_back(list->Value(i));
    }
  }
  if (left.empty()) return {};
  Handle(Array) result = new Array(1, static_cast<Standard_Integer>(left.size()));
  for (std::size_t i = 0; i < left.size(); ++i) {
    result->SetValue(static_cast<Standard_Integer>(i + 1), left[i]);
  }
  return result;
}

}  // namespace

StepCut::StepCut(const Handle(XSControl_WorkSession) & session)
    : session_(session), model_(Handle(StepData_StepModel)::DownCast(session->Model())) {}

void StepCut::take_out(const Entity& entity) {
  if (entity->IsKind(STANDARD_TYPE(StepShape_ShapeRepresentation))) {
    return drop_null_items(entity);
  }
  const std::size_t before = pieces_.size();
  const bool is_new = !seen_.contains(entity.get());
  climb(entity);
  // An entity that nothing uses is a piece of its own.
  if (is_new && pieces_.size() == before) add_piece(entity);
}

void StepCut::finish() {
  if (pieces_.empty()) return;
  session_->ComputeGraph(Standard_True);
  session_->TransferReader()->SetGraph(session_->HGraph());
}

void StepCut::climb(const Entity& entity) {
  if (!seen_.insert(entity.get()).second) return;
  if (is_definition(entity)) return replace(entity);
  if (entity->IsKind(STANDARD_TYPE(StepShape_Face))) return climb_from_face(entity);
  Interface_EntityIterator user = session_->Graph().Sharings(entity);
  for (user.Start(); user.More(); user.Next()) look_at_user(entity, user.Value());
}

void StepCut::climb_from_face(const Entity& face) {
  add_piece(face);
  Interface_EntityIterator user = session_->Graph().Sharings(face);
  for (user.Start(); user.More(); user.Next()) {
    if (user.Value()->IsKind(STANDARD_TYPE(StepShape_ConnectedFaceSet))) {
      remove_faces(user.Value());
    } else {
      look_at_user(face, user.Value());
    }
  }
}

void StepCut::look_at_user(const Entity& entity, const Entity& user) {
  if (user->IsKind(STANDARD_TYPE(StepShape_ShapeRepresentation))) {
    remove_item(user, entity);
  } else if (passes_on(user)) {
    climb(user);
  }
}

void StepCut::remove_faces(const Entity& face_set) {
  const auto faces = Handle(StepShape_ConnectedFaceSet)::DownCast(face_set);
  if (faces->CfsFaces().IsNull()) return climb(face_set);
  const Handle(StepShape_HArray1OfFace) left = shortened(faces->CfsFaces(), cut_);
  if (left.IsNull()) return climb(face_set);
  faces->SetCfsFaces(left);
}

void StepCut::remove_item(const Entity& representation, const Entity& item) {
  add_piece(item);
  const auto shape = Handle(StepShape_ShapeRepresentation)::DownCast(representation);
  if (!shape->Items().IsNull()) shape->SetItems(shortened(shape->Items(), cut_));
}

// A list of items one of which is not there keeps the others.
void StepCut::drop_null_items(const Entity& representation) {
  const auto shape = Handle(StepShape_ShapeRepresentation)::DownCast(representation);
  pieces_.push_back({representation, step_piece(session_, representation)});
  pieces_.back().piece.size_mm = 0;
  if (!shape->Items().IsNull()) shape->SetItems(shortened(shape->Items(), cut_));
  model_->ClearReportEntity(model_->Number(representation));
}

void StepCut::replace(const Entity& definition) {
  add_piece(definition);
  Handle(StepShape_ShapeRepresentation) empty = new StepShape_ShapeRepresentation;
  empty->Init(new TCollection_HAsciiString(""), nullptr, nullptr);
  const Standard_Integer number = model_->Number(definition);
  model_->ClearReportEntity(number);
  model_->ReplaceEntity(number, empty);
}

void StepCut::add_piece(const Entity& entity) {
  if (!cut_.insert(entity.get()).second) return;
  pieces_.push_back({entity, step_piece(session_, entity)});
  const auto placing = Handle(StepShape_ContextDependentShapeRepresentation)::DownCast(entity);
  if (placing.IsNull()) return add_below(entity);
  if (placing->RepresentedProductRelation().IsNull()) return;
  const Entity use =
      placing->RepresentedProductRelation()->Definition().ProductDefinitionRelationship();
  if (!use.IsNull()) below_.insert(use.get());
}

void StepCut::add_below(const Entity& entity) {
  if (!below_.insert(entity.get()).second) return;
  Interface_EntityIterator part = session_->Graph().Shareds(entity);
  for (part.Start(); part.More(); part.Next()) add_below(part.Value());
}

}  // namespace forcelayer::mesh
