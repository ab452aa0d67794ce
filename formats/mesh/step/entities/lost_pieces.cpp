#include "formats/mesh/step/entities/lost_pieces.h"

#include <Interface_EntityIterator.hxx>
#include <Interface_UndefinedContent.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <StepRepr_RepresentationRelationshipWithTransformation.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_PolyLoop.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepShape_VertexPoint.hxx>
#include <StepVisual_StyledItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <cmath>
#include <gp_XYZ.hxx>
#include <optional>
#include <unordered_set>

#include "formats/mesh/reader.h"
#include "formats/mesh/step/entities/step_units.h"

namespace forcelayer::mesh {
namespace {

using Entity = Handle(Standard_Transient);
using EntitySet = std::unordered_set<const Standard_Transient*>;

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

// Looks for an entity's products among what refers to it, and for its corners among what it refers
// to.
class PieceFinder {
 public:
  PieceFinder(const Handle(XSControl_WorkSession) & session, const Entity& entity)
      : graph_(session->Graph()) {
    if (const auto whole = whole_of(entity); !whole.IsNull()) {
      piece.products.insert(whole);
      return;
    }
    climb(entity);
    if (is_placed_ || !mm_per_unit_) return;
    find_corners(entity);
    set_place();
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
    } else if (user->IsKind(STANDARD_TYPE(StepShape_ShapeRepresentation))) {
      const auto items = Handle(StepShape_ShapeRepresentation)::DownCast(user);
      if (const auto units = units_of(items->ContextOfItems()); units && !mm_per_unit_) {
        mm_per_unit_ = units->mm;
      }
      climb(user);
    } else if (!user->IsKind(STANDARD_TYPE(StepVisual_StyledItem)) &&
               (user->IsKind(STANDARD_TYPE(StepRepr_RepresentationItem)) ||
                user->IsKind(STANDARD_TYPE(StepRepr_RepresentationMap)) ||
                user->IsKind(STANDARD_TYPE(StepData_UndefinedEntity)))) {
      is_placed_ = is_placed_ || user->IsKind(STANDARD_TYPE(StepRepr_MappedItem));
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

  void find_corners(const Entity& entity) {
    if (!below_.insert(entity.get()).second) return;
    if (const auto vertex = Handle(StepShape_VertexPoint)::DownCast(entity); !vertex.IsNull()) {
      add_corner(Handle(StepGeom_CartesianPoint)::DownCast(vertex->VertexGeometry()));
    } else if (const auto loop = Handle(StepShape_PolyLoop)::DownCast(entity); !loop.IsNull()) {
      Interface_EntityIterator part = graph_.Shareds(loop);
      for (part.Start(); part.More(); part.Next()) {
        add_corner(Handle(StepGeom_CartesianPoint)::DownCast(part.Value()));
      }
    } else {
      Interface_EntityIterator part = graph_.Shareds(entity);
      for (part.Start(); part.More(); part.Next()) find_corners(part.Value());
    }
  }

  void add_corner(const Handle(StepGeom_CartesianPoint) & point) {
    if (point.IsNull() || point->NbCoordinates() != 3) return;
    Vec3d corner;
    for (std::size_t n = 0; n < 3; ++n) {
      corner[n] = *mm_per_unit_ * point->CoordinatesValue(static_cast<Standard_Integer>(n + 1));
    }
    extend(box_, corner);
  }

  void set_place() {
    if (!(box_.low[0] <= box_.high[0])) return;
    double square = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      piece.center_mm[n] = 0.5 * (box_.low[n] + box_.high[n]);
      square += std::pow(box_.high[n] - box_.low[n], 2);
    }
    piece.size_mm = std::sqrt(square);
  }

  const Interface_Graph& graph_;
  EntitySet seen_, below_;
  Box box_ = empty_box();
  std::optional<double> mm_per_unit_;
  bool is_placed_ = false;  // by mapped items: its corners are not where the shape is
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
