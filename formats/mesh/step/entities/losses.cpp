#include "formats/mesh/step/entities/losses.h"

#include <Interface_Check.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepGeom_Axis2Placement3d.hxx>
#include <StepGeom_BoundedSurface.hxx>
#include <StepGeom_CartesianTransformationOperator3d.hxx>
#include <StepGeom_Curve.hxx>
#include <StepGeom_Direction.hxx>
#include <StepGeom_Pcurve.hxx>
#include <StepGeom_Placement.hxx>
#include <StepGeom_Point.hxx>
#include <StepGeom_Surface.hxx>
#include <StepGeom_SurfaceCurve.hxx>
#include <StepGeom_Vector.hxx>
#include <StepRepr_DefinitionalRepresentation.hxx>
#include <StepRepr_ItemDefinedTransformation.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_PropertyDefinition.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <StepRepr_RepresentationRelationshipWithTransformation.hxx>
#include <StepShape_Block.hxx>
#include <StepShape_BooleanResult.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_FaceBasedSurfaceModel.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_GeometricSet.hxx>
#include <StepShape_HalfSpaceSolid.hxx>
#include <StepShape_RightAngularWedge.hxx>
#include <StepShape_RightCircularCone.hxx>
#include <StepShape_RightCircularCylinder.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
#include <StepShape_Sphere.hxx>
#include <StepShape_TopologicalRepresentationItem.hxx>
#include <StepShape_Torus.hxx>
#include <StepVisual_CoordinatesList.hxx>
#include <StepVisual_TessellatedGeometricSet.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <algorithm>
#include <gp_Vec.hxx>
#include <string_view>
#include <unordered_set>

#include "formats/mesh/step/entities/faces.h"

namespace forcelayer::mesh {
namespace {

using Entity = Handle(Standard_Transient);

constexpr const char* kMend =
    "export each solid as a boundary representation within a product, or export triangles, such as "
    "STL";
constexpr int kMaxLevels = 8;  // of what lists what; a damaged entity may list itself

// The types of an entity that OpenCASCADE does not know: one, or those of a complex entity. Empty
// for one that it knows.
std::vector<std::string> unknown_types(const Entity& entity) {
  std::vector<std::string> types;
  for (auto part = Handle(StepData_UndefinedEntity)::DownCast(entity); !part.IsNull();
       part = part->Next()) {
    types.emplace_back(part->StepType());
  }
  return types;
}

bool is_solid(const Entity& entity) {
  for (const Handle(Standard_Type) & type :
       {STANDARD_TYPE(StepShape_SolidModel), STANDARD_TYPE(StepShape_BooleanResult),
        STANDARD_TYPE(StepShape_Block), STANDARD_TYPE(StepShape_Sphere),
        STANDARD_TYPE(StepShape_Torus), STANDARD_TYPE(StepShape_RightAngularWedge),
        STANDARD_TYPE(StepShape_RightCircularCone), STANDARD_TYPE(StepShape_RightCircularCylinder),
        STANDARD_TYPE(StepShape_HalfSpaceSolid), STANDARD_TYPE(StepShape_ShellBasedSurfaceModel),
        STANDARD_TYPE(StepShape_FaceBasedSurfaceModel)}) {
    if (entity->IsKind(type)) return true;
  }
  return false;
}

// Solids, shells and faces of a schema that OpenCASCADE does not know: the tessellated ones and the
// newer primitives of AP242 among them.
bool is_unknown_solid(const std::string& type) {
  for (const std::string_view end :
       {"_SOLID", "_SOLID_TAPERED", "_FACE", "_SHELL", "_BREP", "_SURFACE_MODEL"}) {
    if (type.ends_with(end)) return true;
  }
  for (const std::string_view primitive :
       {"ELLIPSOID", "ECCENTRIC_CONE", "FACETED_PRIMITIVE", "RECTANGULAR_PYRAMID", "TETRAHEDRON",
        "CONVEX_HEXAHEDRON", "CYCLIDE_SEGMENT"}) {
    if (type.starts_with(primitive)) return true;
  }
  return false;
}

// Triangles that are a shape where a shape representation lists them, and the picture of a
// dimension where an annotation does.
bool is_surface_set(const std::string& type) { return type.ends_with("TRIANGULATED_SURFACE_SET"); }

bool lists_shapes(const Entity& user) {
  if (user->IsKind(STANDARD_TYPE(StepShape_ShapeRepresentation))) return true;
  for (const std::string& type : unknown_types(user)) {
    if (type.starts_with("TESSELLATED_SHAPE_REPRESENTATION")) return true;
  }
  return false;
}

// Whether OpenCASCADE places a mapped item right at this target: it drops scales and mirrors of an
// operator without a word, and completes axes that are left out differently from ISO 10303-42.
bool can_be_placed(const Handle(StepRepr_RepresentationItem) & target) {
  if (target.IsNull()) return false;
  const auto general = Handle(StepGeom_CartesianTransformationOperator)::DownCast(target);
  if (general.IsNull()) return true;
  const auto in_space = Handle(StepGeom_CartesianTransformationOperator3d)::DownCast(target);
  if (in_space.IsNull() || (general->HasScale() && general->Scale() != 1)) return false;
  const int axes = general->HasAxis1() + general->HasAxis2() + in_space->HasAxis3();
  if (axes == 0) return true;
  if (axes < 3) return false;
  const auto vector_of = [](const Handle(StepGeom_Direction) & axis) {
    return gp_Vec(axis->DirectionRatiosValue(1), axis->DirectionRatiosValue(2),
                  axis->DirectionRatiosValue(3));
  };
  const gp_Vec x = vector_of(general->Axis1()), y = vector_of(general->Axis2());
  return x.Crossed(y).Dot(vector_of(in_space->Axis3())) > 0;
}

// Whether an occurrence in an assembly has a placing that OpenCASCADE reads; it takes another kind
// for none, and leaves the part at the origin.
bool can_be_placed(const Handle(StepShape_ContextDependentShapeRepresentation) & occurrence) {
  if (occurrence->RepresentationRelation().IsNull() ||
      occurrence->RepresentedProductRelation().IsNull() ||
      occurrence->RepresentedProductRelation()
          ->Definition()
          .ProductDefinitionRelationship()
          .IsNull()) {
    return false;
  }
  const auto relation = Handle(StepRepr_RepresentationRelationshipWithTransformation)::DownCast(
      occurrence->RepresentationRelation());
  if (relation.IsNull()) return true;
  const Handle(StepRepr_ItemDefinedTransformation) placing =
      relation->TransformationOperator().ItemDefinedTransformation();
  if (placing.IsNull()) return false;
  for (const auto& frame : {placing->TransformItem1(), placing->TransformItem2()}) {
    if (Handle(StepGeom_Axis2Placement3d)::DownCast(frame).IsNull()) return false;
  }
  return true;
}

class StepCheck {
 public:
  StepCheck(const Handle(XSControl_WorkSession) & session,
            const Handle(TDocStd_Document) & document)
      : session_(session),
        model_(Handle(StepData_StepModel)::DownCast(session->Model())),
        graph_(session->Graph()),
        process_(session->TransferReader()->TransientProcess()),
        faces_(document) {}

  FileLosses find() {
    FileLosses found;
    found.mend = kMend;
    for (Standard_Integer i = 1; i <= model_->NbEntities() && !is_assembly_; ++i) {
      is_assembly_ = model_->Value(i)->IsKind(STANDARD_TYPE(StepRepr_NextAssemblyUsageOccurrence));
    }
    for (Standard_Integer i = 1; i <= model_->NbEntities(); ++i) look_at(model_->Value(i), found);
    for (const Entity& entity : lost_) {
      if (is_used_by_lost(entity)) continue;
      add(entity, lost_solids_, found);
      add_below(entity);
    }
    for (const Entity& face : lost_face_entities_) {
      if (!below_lost_.contains(face.get())) add(face, lost_faces_, found);
    }
    found.text = text_of({lost_faces_, lost_solids_, lost_placings_});
    return found;
  }

 private:
  void add(const Entity& entity, Losses& kind, FileLosses& found) {
    found.pieces.push_back(step_piece(session_, entity));
    kind.names.push_back(found.pieces.back().name);
  }

  // The faces of a lost solid are lost with it.
  void add_below(const Entity& entity) {
    if (!below_lost_.insert(entity.get()).second) return;
    Interface_EntityIterator part = graph_.Shareds(entity);
    for (part.Start(); part.More(); part.Next()) add_below(part.Value());
  }

  void look_at(const Entity& entity, FileLosses& found) {
    if (entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface))) {
      ++lost_faces_.count;
      if (!is_in_document(entity)) lost_face_entities_.push_back(entity);
    } else if (is_solid(entity)) {
      if (!is_in_document(entity)) lose(entity);
    } else if (entity->IsKind(STANDARD_TYPE(StepShape_GeometricSet))) {
      if (count_faces(result_of(entity)) < surfaces_of(entity)) lose(entity);
    } else if (entity->IsKind(STANDARD_TYPE(StepGeom_BoundedSurface))) {
      // OpenCASCADE reads those of sets and faces, not those that a shape lists on their own.
      if (is_item_of_shape(entity) && !is_in_document(entity)) lose(entity);
    } else if (entity->IsKind(STANDARD_TYPE(StepData_UndefinedEntity))) {
      if (is_lost_unknown(entity)) lose(entity);
    } else if (is_lost_placing(entity) || is_of_no_product(entity)) {
      add(entity, lost_placings_, found);
    }
  }

  void lose(const Entity& entity) {
    lost_.push_back(entity);
    is_lost_.insert(entity.get());
  }

  std::vector<Entity> users_of(const Entity& entity) const {
    std::vector<Entity> users;
    Interface_EntityIterator user = graph_.Sharings(entity);
    for (user.Start(); user.More(); user.Next()) users.push_back(user.Value());
    return users;
  }

  template <typename Test>
  bool has_user(const Entity& entity, const Test& test) const {
    const std::vector<Entity> users = users_of(entity);
    return std::any_of(users.begin(), users.end(), test);
  }

  // Operands and parts go with the solid that they belong to.
  bool is_used_by_lost(const Entity& entity) const {
    return has_user(entity, [&](const Entity& user) { return is_lost_.contains(user.get()); });
  }

  bool is_item_of_shape(const Entity& entity) const {
    return has_user(entity, [](const Entity& user) {
      return user->IsKind(STANDARD_TYPE(StepShape_ShapeRepresentation));
    });
  }

  TopoDS_Shape result_of(const Entity& entity) const {
    return TransferBRep::ShapeResult(process_, entity);
  }

  bool is_in_document(const Entity& entity) const { return faces_.has(result_of(entity)); }

  std::uint64_t surfaces_of(const Entity& set) const {
    std::uint64_t count = 0;
    Interface_EntityIterator element = graph_.Shareds(set);
    for (element.Start(); element.More(); element.Next()) {
      if (element.Value()->IsKind(STANDARD_TYPE(StepGeom_Surface))) ++count;
    }
    return count;
  }

  // A part of another one is lost or read with it.
  bool is_lost_unknown(const Entity& entity) const {
    const auto is_body = [](const Entity& one) {
      const std::vector<std::string> types = unknown_types(one);
      return std::any_of(types.begin(), types.end(), is_unknown_solid);
    };
    if (is_body(entity)) return !has_user(entity, is_body) && !stands_for_what_was_read(entity);
    const std::vector<std::string> types = unknown_types(entity);
    return std::any_of(types.begin(), types.end(), is_surface_set) && is_listed_as_shape(entity);
  }

  // By a shape representation, or by a set that one lists.
  bool is_listed_as_shape(const Entity& entity, int levels = kMaxLevels) const {
    return levels == 0 || has_user(entity, [&](const Entity& user) {
             return lists_shapes(user) ||
                    (user->IsKind(STANDARD_TYPE(StepVisual_TessellatedGeometricSet)) &&
                     is_listed_as_shape(user, levels - 1));
           });
  }

  // Triangles that are there beside the exact face, shell or solid that they approximate.
  bool stands_for_what_was_read(const Entity& entity, int levels = kMaxLevels) const {
    if (levels == 0) return false;
    Interface_EntityIterator part = graph_.Shareds(entity);
    bool has_parts = false, all_parts_stand = true;
    for (part.Start(); part.More(); part.Next()) {
      if (part.Value()->IsKind(STANDARD_TYPE(StepData_UndefinedEntity))) {
        has_parts = true;
        all_parts_stand = all_parts_stand && stands_for_what_was_read(part.Value(), levels - 1);
      } else if (is_in_document(part.Value())) {
        return true;
      }
    }
    return has_parts && all_parts_stand;
  }

  // A mapped item, or an occurrence in an assembly, of what has faces.
  bool is_lost_placing(const Entity& entity) const {
    if (entity->DynamicType() == STANDARD_TYPE(StepRepr_MappedItem)) {
      const auto item = Handle(StepRepr_MappedItem)::DownCast(entity);
      return is_item_of_shape(entity) && !is_in_document(entity) && holds_faces(item);
    }
    const auto use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(entity);
    if (use.IsNull() || count_faces(result_of(use)) > 0) return false;
    const Handle(StepBasic_ProductDefinition) whole = use->RelatingProductDefinition(),
                                              part = use->RelatedProductDefinition();
    std::unordered_set<const Standard_Transient*> seen;
    if (whole.IsNull() || part.IsNull() || !has_faces(part, seen)) return false;
    return !contains_face_of(result_of(whole), result_of(part));
  }

  // A shape with faces that no product of an assembly has: OpenCASCADE leaves it at the origin, and
  // the occurrences of its product out.
  bool is_of_no_product(const Entity& entity) const {
    const auto shape = Handle(StepShape_ShapeRepresentation)::DownCast(entity);
    if (shape.IsNull() || shape->Items().IsNull() || !is_assembly_) return false;
    for (Standard_Integer i = 1; i <= shape->NbItems(); ++i) {
      const Entity item = shape->ItemsValue(i);
      if (!item.IsNull() && is_in_document(item) && step_piece(session_, item).products.empty()) {
        return true;
      }
    }
    return false;
  }

  // Whether it has faces of its own, or in an assembly below it.
  bool has_faces(const Entity& product, std::unordered_set<const Standard_Transient*>& seen) const {
    if (!seen.insert(product.get()).second) return false;
    if (count_faces(result_of(product)) > 0) return true;
    return has_user(product, [&](const Entity& user) {
      const auto use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(user);
      if (use.IsNull() || use->RelatingProductDefinition() != product) return false;
      const Entity part = use->RelatedProductDefinition();
      return !part.IsNull() && has_faces(part, seen);
    });
  }

  bool holds_faces(const Handle(StepRepr_MappedItem) & item) const {
    if (item->MappingSource().IsNull()) return false;
    const Handle(StepRepr_Representation) source = item->MappingSource()->MappedRepresentation();
    if (source.IsNull()) return false;
    for (Standard_Integer i = 1; i <= source->NbItems(); ++i) {
      if (count_faces(result_of(source->ItemsValue(i))) > 0) return true;
    }
    return false;
  }

  Handle(XSControl_WorkSession) session_;
  Handle(StepData_StepModel) model_;
  const Interface_Graph& graph_;
  Handle(Transfer_TransientProcess) process_;
  DocumentFaces faces_;
  bool is_assembly_ = false;
  std::vector<Entity> lost_;
  std::unordered_set<const Standard_Transient*> is_lost_, below_lost_;
  std::vector<Entity> lost_face_entities_;
  Losses lost_faces_{"face", 0, {}}, lost_solids_{"solid", 0, {}}, lost_placings_{"placing", 0, {}};
};

bool is_geometry(const Entity& entity) {
  if (is_solid(entity)) return true;
  for (const Handle(Standard_Type) & type :
       {STANDARD_TYPE(StepShape_TopologicalRepresentationItem), STANDARD_TYPE(StepGeom_Point),
        STANDARD_TYPE(StepGeom_Curve), STANDARD_TYPE(StepGeom_Surface),
        STANDARD_TYPE(StepGeom_Placement), STANDARD_TYPE(StepGeom_Direction),
        STANDARD_TYPE(StepGeom_Vector), STANDARD_TYPE(StepVisual_CoordinatesList),
        STANDARD_TYPE(StepRepr_DefinitionalRepresentation), STANDARD_TYPE(StepShape_GeometricSet),
        STANDARD_TYPE(StepShape_ShapeRepresentation)}) {
    if (entity->IsKind(type)) return true;
  }
  return false;
}

// Curves in the parameters of a surface are read where they make sense, else computed again.
bool is_in_parameters(const Entity& entity) {
  return entity->IsKind(STANDARD_TYPE(StepGeom_Pcurve)) ||
         entity->IsKind(STANDARD_TYPE(StepGeom_SurfaceCurve));
}

// Shapes that belong to no product, placings of nothing, occurrences of nothing or nowhere.
bool lacks_an_end(const Entity& entity) {
  const auto shape = Handle(StepShape_ShapeDefinitionRepresentation)::DownCast(entity);
  if (!shape.IsNull()) return shape->Definition().PropertyDefinition().IsNull();
  const auto use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(entity);
  if (!use.IsNull()) {
    return use->RelatingProductDefinition().IsNull() || use->RelatedProductDefinition().IsNull();
  }
  const auto item = Handle(StepRepr_MappedItem)::DownCast(entity);
  return !item.IsNull() && item->MappingSource().IsNull();
}

// Entities of what these list may be newer than OpenCASCADE, and are looked at by themselves.
bool lists_what_may_be_newer(const Entity& entity) {
  return is_solid(entity) || entity->IsKind(STANDARD_TYPE(StepShape_GeometricSet)) ||
         entity->IsKind(STANDARD_TYPE(StepShape_ShapeRepresentation));
}

// Whether OpenCASCADE's check of the text tells of a reference that leads nowhere, or of what is no
// number, which it takes for 0; it also fails what is harmless, such as a name that is left out.
bool leads_nowhere(const Handle(StepData_StepModel) & model, Standard_Integer number) {
  const Handle(Interface_Check) check = model->Check(number, Standard_True);
  const bool may_be_odd = is_in_parameters(model->Value(number));
  const bool is_list = lists_what_may_be_newer(model->Value(number));
  for (Standard_Integer i = 1; i <= check->NbFails(); ++i) {
    const std::string_view fail = check->CFail(i, Standard_True);
    const auto says = [&](std::string_view words) { return fail.find(words) != fail.npos; };
    if (says("nresolved")) return true;
    if (is_list) {
      if (says("not an Entity")) return true;
      continue;
    }
    if (says("Count of Parameters")) return true;
    if (!may_be_odd && (says("not a Real") || says("Boolean"))) return true;
    if (!may_be_odd && (says("illegal type") || says("not an Entity") || says("not a LIST"))) {
      return true;
    }
  }
  return false;
}

// Whether the source of a mapped item has faces or solids, so that its place matters.
bool has_faces_below(const Interface_Graph& graph, const Entity& entity,
                     std::unordered_set<const Standard_Transient*>& seen) {
  if (!seen.insert(entity.get()).second) return false;
  if (entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface)) || is_solid(entity)) return true;
  Interface_EntityIterator part = graph.Shareds(entity);
  for (part.Start(); part.More(); part.Next()) {
    if (has_faces_below(graph, part.Value(), seen)) return true;
  }
  return false;
}

bool is_misplaced(const Interface_Graph& graph, const Entity& entity) {
  const auto occurrence = Handle(StepShape_ContextDependentShapeRepresentation)::DownCast(entity);
  if (!occurrence.IsNull()) return !can_be_placed(occurrence);
  if (entity->DynamicType() != STANDARD_TYPE(StepRepr_MappedItem)) return false;
  const auto item = Handle(StepRepr_MappedItem)::DownCast(entity);
  if (item->MappingSource().IsNull() || can_be_placed(item->MappingTarget())) return false;
  std::unordered_set<const Standard_Transient*> seen;
  return has_faces_below(graph, item->MappingSource(), seen);
}

}  // namespace

std::string find_step_damage(const Handle(XSControl_WorkSession) & session) {
  const auto model = Handle(StepData_StepModel)::DownCast(session->Model());
  Losses placings{"placing", 0, {}}, others{"damaged entity", 0, {}};
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Entity& entity = model->Value(i);
    if (is_geometry(entity) ? leads_nowhere(model, i) : lacks_an_end(entity)) {
      others.names.push_back(step_name(model, entity));
    } else if (is_misplaced(session->Graph(), entity)) {
      placings.names.push_back(step_name(model, entity));
    }
  }
  return text_of({placings, others});
}

FileLosses find_step_losses(const Handle(XSControl_WorkSession) & session,
                            const Handle(TDocStd_Document) & document) {
  return StepCheck(session, document).find();
}

}  // namespace forcelayer::mesh
