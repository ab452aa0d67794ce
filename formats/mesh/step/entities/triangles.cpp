#include "formats/mesh/step/entities/triangles.h"

#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <Interface_UndefinedContent.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_PropertyDefinition.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepRepr_RepresentationRelationshipWithTransformation.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepShape_SolidModel.hxx>
#include <StepShape_TopologicalRepresentationItem.hxx>
#include <StepVisual_CoordinatesList.hxx>
#include <StepVisual_TessellatedGeometricSet.hxx>
#include <TColgp_HArray1OfXYZ.hxx>
#include <TCollection_HAsciiString.hxx>
#include <XSControl_TransferReader.hxx>
#include <algorithm>
#include <gp_XYZ.hxx>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "formats/mesh/step/entities/step_units.h"

namespace forcelayer::mesh {
namespace {

using Entity = Handle(Standard_Transient);
using Unknown = Handle(StepData_UndefinedEntity);
using Product = Handle(StepBasic_ProductDefinition);

struct NotUnderstood {};

constexpr int kMostLevels = 8;

// The parameters of an entity that OpenCASCADE does not know, or of a list within; from 1 on.
class Parameters {
 public:
  explicit Parameters(const Unknown& entity)
      : content_(entity.IsNull() ? nullptr : entity->UndefinedContent()) {
    if (content_.IsNull()) throw NotUnderstood{};
  }

  int count() const { return content_->NbParams(); }

  // Null where it is no entity.
  Entity entity(int number) const {
    check(number);
    return content_->IsParamEntity(number) && content_->ParamType(number) == Interface_ParamIdent
               ? content_->ParamEntity(number)
               : Entity();
  }

  Parameters list(int number) const {
    check(number);
    if (!content_->IsParamEntity(number)) throw NotUnderstood{};
    const Unknown inner = Unknown::DownCast(content_->ParamEntity(number));
    if (inner.IsNull() || !inner->IsSub()) throw NotUnderstood{};
    return Parameters(inner);
  }

  int integer(int number) const {
    check(number);
    if (content_->IsParamEntity(number)) throw NotUnderstood{};
    const Handle(TCollection_HAsciiString) text = content_->ParamValue(number);
    if (text.IsNull() || !text->IsIntegerValue()) throw NotUnderstood{};
    return text->IntegerValue();
  }

  double real(int number) const {
    check(number);
    if (content_->IsParamEntity(number)) throw NotUnderstood{};
    const Handle(TCollection_HAsciiString) text = content_->ParamValue(number);
    if (text.IsNull() || !text->IsRealValue()) throw NotUnderstood{};
    return text->RealValue();
  }

 private:
  void check(int number) const {
    if (number < 1 || number > content_->NbParams()) throw NotUnderstood{};
  }

  Handle(Interface_UndefinedContent) content_;
};

// The differences between the four kinds of triangles; edges and points beside them have no area.
struct FaceKind {
  const char* type;
  bool has_link;      // to an exact face, after the normals
  bool is_in_strips;  // strips and fans, not triangles one by one
};
constexpr FaceKind kFaces[] = {{"TRIANGULATED_FACE", true, false},
                               {"COMPLEX_TRIANGULATED_FACE", true, true},
                               {"TRIANGULATED_SURFACE_SET", false, false},
                               {"COMPLEX_TRIANGULATED_SURFACE_SET", false, true}};
constexpr const char* kWithoutArea[] = {"TESSELLATED_EDGE",      "TESSELLATED_CONNECTING_EDGE",
                                        "TESSELLATED_VERTEX",    "TESSELLATED_WIRE",
                                        "TESSELLATED_CURVE_SET", "TESSELLATED_POINT_SET"};

std::string type_of(const Entity& entity) {
  const std::vector<std::string> types = unknown_types(entity);
  return types.size() == 1 ? types.front() : "";
}

const FaceKind* face_kind(const std::string& type) {
  for (const FaceKind& kind : kFaces) {
    if (type == kind.type) return &kind;
  }
  return nullptr;
}

bool is_body(const std::string& type) {
  return type == "TESSELLATED_SOLID" || type == "TESSELLATED_SHELL";
}

bool is_without_area(const std::string& type) {
  return std::find(std::begin(kWithoutArea), std::end(kWithoutArea), type) !=
         std::end(kWithoutArea);
}

bool is_exact(const Entity& entity) {
  return !entity.IsNull() &&
         (entity->IsKind(STANDARD_TYPE(StepShape_TopologicalRepresentationItem)) ||
          entity->IsKind(STANDARD_TYPE(StepShape_SolidModel)));
}

// Collects the triangles of one item. Points that faces share are shared vertices.
class TriangleReader {
 public:
  explicit TriangleReader(double mm_per_unit) : mm_per_unit_(mm_per_unit) {
    mesh_.single_precision = false;
  }

  // Bodies list shells and faces, `levels` deep at most: a damaged one may list itself.
  void add(const Entity& entity, int levels = kMostLevels) {
    if (levels == 0) throw NotUnderstood{};
    const std::string type = type_of(entity);
    entities_.push_back(entity);
    if (const FaceKind* const kind = face_kind(type)) {
      add_face(Parameters(Unknown::DownCast(entity)), *kind);
    } else if (is_body(type)) {
      const Parameters items = Parameters(Unknown::DownCast(entity)).list(2);
      for (int i = 1; i <= items.count(); ++i) add(items.entity(i), levels - 1);
    } else if (!is_without_area(type)) {
      throw NotUnderstood{};
    }
  }

  TriangleItem take(const Product& product) {
    if (mesh_.triangles.empty()) throw NotUnderstood{};
    return {product, std::move(mesh_), std::move(entities_)};
  }

 private:
  // Parameters: name, coordinates, largest index, normals, link, indices of points, triangles or
  // strips and fans.
  void add_face(const Parameters& face, const FaceKind& kind) {
    const int first = kind.has_link ? 6 : 5;
    if (face.count() != first + (kind.is_in_strips ? 2 : 1)) throw NotUnderstood{};
    points_ = Handle(StepVisual_CoordinatesList)::DownCast(face.entity(2));
    if (points_.IsNull() || points_->Points().IsNull()) throw NotUnderstood{};
    indices_.clear();
    const Parameters indices = face.list(first);
    for (int i = 1; i <= indices.count(); ++i) indices_.push_back(indices.integer(i));
    const std::size_t begin = mesh_.triangles.size();
    if (!kind.is_in_strips) {
      const Parameters triangles = face.list(first + 1);
      for (int i = 1; i <= triangles.count(); ++i) {
        const Parameters corners = triangles.list(i);
        if (corners.count() != 3) throw NotUnderstood{};
        add_triangle(corners.integer(1), corners.integer(2), corners.integer(3));
      }
      return;
    }
    read_normals(face.list(4));
    add_strips(face.list(first + 1));
    add_fans(face.list(first + 2));
    if (agreement_ >= 0) return;
    for (std::size_t i = begin; i < mesh_.triangles.size(); ++i) {
      std::swap(mesh_.triangles[i][1], mesh_.triangles[i][2]);
    }
  }

  // None, one, or one for each point. Exporters disagree about the side of strips and fans; where
  // there are normals, they tell.
  void read_normals(const Parameters& normals) {
    normals_.clear();
    agreement_ = 0;
    for (int i = 1; i <= normals.count(); ++i) {
      const Parameters normal = normals.list(i);
      normals_.emplace_back(normal.real(1), normal.real(2), normal.real(3));
    }
  }

  void add_strips(const Parameters& strips) {
    for (int i = 1; i <= strips.count(); ++i) {
      const Parameters strip = strips.list(i);
      for (int k = 1; k + 2 <= strip.count(); ++k) {
        const int a = strip.integer(k), b = strip.integer(k + 1), c = strip.integer(k + 2);
        k % 2 == 1 ? add_of_strip(a, c, b) : add_of_strip(a, b, c);
      }
    }
  }

  void add_fans(const Parameters& fans) {
    for (int i = 1; i <= fans.count(); ++i) {
      const Parameters fan = fans.list(i);
      for (int k = 2; k + 1 <= fan.count(); ++k) {
        add_of_strip(fan.integer(1), fan.integer(k + 1), fan.integer(k));
      }
    }
  }

  // Equal corners only lead from one part of a strip to the next.
  void add_of_strip(int a, int b, int c) {
    if (a == b || b == c || a == c) return;
    add_triangle(a, b, c);
    if (normals_.empty()) return;
    const auto& [i, j, k] = mesh_.triangles.back();
    const gp_XYZ side = (point(j) - point(i)) ^ (point(k) - point(i));
    const auto at = normals_.size() == 1 ? 0 : static_cast<std::size_t>(a - 1);
    if (at >= normals_.size()) throw NotUnderstood{};
    agreement_ += side * normals_[at];
  }

  gp_XYZ point(std::uint32_t i) const {
    const Vec3d& at = mesh_.vertices[i];
    return {at[0], at[1], at[2]};
  }

  void add_triangle(int a, int b, int c) {
    const std::uint32_t i = vertex(a), j = vertex(b), k = vertex(c);
    mesh_.triangles.push_back({i, j, k});
  }

  // The vertex of a point of the face, counted from 1: by its indices where it has any, else in the
  // list of coordinates.
  std::uint32_t vertex(int number) {
    if (!indices_.empty()) {
      if (number < 1 || static_cast<std::size_t>(number) > indices_.size()) throw NotUnderstood{};
      number = indices_[static_cast<std::size_t>(number - 1)];
    }
    const Handle(TColgp_HArray1OfXYZ) all = points_->Points();
    if (number < all->Lower() || number > all->Upper()) throw NotUnderstood{};
    const auto [known, is_new] = vertices_.try_emplace(
        {points_.get(), number}, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) {
      const gp_XYZ at = all->Value(number) * mm_per_unit_;
      mesh_.vertices.push_back({at.X(), at.Y(), at.Z()});
    }
    return known->second;
  }

  double mm_per_unit_;
  Mesh mesh_;
  std::vector<Entity> entities_;
  std::map<std::pair<const void*, int>, std::uint32_t> vertices_;
  Handle(StepVisual_CoordinatesList) points_;  // of the face in hand, as are the next three
  std::vector<int> indices_;
  std::vector<gp_XYZ> normals_;
  double agreement_ = 0;  // of normals and triangles: twice their area, signed
};

bool is_representation_of_triangles(const Entity& entity) {
  for (const std::string& type : unknown_types(entity)) {
    if (type.starts_with("TESSELLATED_SHAPE_REPRESENTATION")) return true;
  }
  return false;
}

class TriangleFinder {
 public:
  explicit TriangleFinder(const Handle(XSControl_WorkSession) & session)
      : session_(session), model_(Handle(StepData_StepModel)::DownCast(session->Model())) {}

  std::vector<TriangleItem> take() {
    for (Standard_Integer i = 1; i <= model_->NbEntities(); ++i) {
      const Entity entity = model_->Value(i);
      const std::string type = type_of(entity);
      if (face_kind(type) != nullptr || is_body(type)) take_item(entity);
    }
    if (replace_representations()) {
      session_->ComputeGraph(Standard_True);
      session_->TransferReader()->SetGraph(session_->HGraph());
    }
    return std::move(items_);
  }

 private:
  std::vector<Entity> users_of(const Entity& entity) const {
    std::vector<Entity> users;
    Interface_EntityIterator user = session_->Graph().Sharings(entity);
    for (user.Start(); user.More(); user.Next()) users.push_back(user.Value());
    return users;
  }

  // Reads an item for each product whose shape lists it.
  void take_item(const Entity& entity) {
    if (stands_for_exact(entity)) {
      read_.insert(entity.get());
      return;
    }
    for (const Entity& user : users_of(entity)) {
      const auto known = Handle(StepShape_ShapeRepresentation)::DownCast(user);
      if (known.IsNull() && !is_representation_of_triangles(user)) continue;
      try {
        const Entity context = known.IsNull() ? Parameters(Unknown::DownCast(user)).entity(3)
                                              : Entity(known->ContextOfItems());
        const std::set<Product> products = products_of(user);
        const std::optional<StepUnits> units = units_of(context);
        if (products.size() != 1 || !units) throw NotUnderstood{};
        TriangleReader reader(units->mm);
        reader.add(entity);
        items_.push_back(reader.take(*products.begin()));
        read_.insert(entity.get());
      } catch (const NotUnderstood&) {  // then it counts as lost
        continue;
      }
    }
  }

  bool stands_for_exact(const Entity& entity, int levels = kMostLevels) const {
    if (levels == 0) return false;
    bool has_parts = false, all_stand = true;
    Interface_EntityIterator part = session_->Graph().Shareds(entity);
    for (part.Start(); part.More(); part.Next()) {
      if (is_exact(part.Value())) return true;
      const std::string type = type_of(part.Value());
      if (face_kind(type) == nullptr && !is_body(type)) continue;
      has_parts = true;
      all_stand = all_stand && stands_for_exact(part.Value(), levels - 1);
    }
    return has_parts && all_stand;
  }

  // Products whose shape the representation is, or is related to without a placing.
  std::set<Product> products_of(const Entity& representation) const {
    std::set<Product> products = own_products_of(representation);
    for (const Entity& user : users_of(representation)) {
      const auto relation = Handle(StepRepr_RepresentationRelationship)::DownCast(user);
      if (relation.IsNull() ||
          relation->IsKind(STANDARD_TYPE(StepRepr_RepresentationRelationshipWithTransformation))) {
        continue;
      }
      for (const auto& other : {relation->Rep1(), relation->Rep2()}) {
        if (!other.IsNull()) products.merge(own_products_of(other));
      }
    }
    return products;
  }

  std::set<Product> own_products_of(const Entity& representation) const {
    std::set<Product> products;
    for (const Entity& user : users_of(representation)) {
      const auto definition = Handle(StepShape_ShapeDefinitionRepresentation)::DownCast(user);
      if (definition.IsNull()) continue;
      const auto shape = Handle(StepRepr_ProductDefinitionShape)::DownCast(
          definition->Definition().PropertyDefinition());
      if (shape.IsNull()) continue;
      const Product product = shape->Definition().ProductDefinition();
      if (!product.IsNull()) products.insert(product);
    }
    return products;
  }

  // OpenCASCADE reads a reference to what it does not know as none, and gives the product no label.
  bool replace_representations() {
    bool any = false;
    for (Standard_Integer i = 1; i <= model_->NbEntities(); ++i) {
      const Entity entity = model_->Value(i);
      if (!is_representation_of_triangles(entity)) continue;
      Handle(StepRepr_RepresentationContext) context;
      try {
        const Parameters parameters(Unknown::DownCast(entity));
        if (!is_read_whole(parameters.list(2))) continue;
        context = Handle(StepRepr_RepresentationContext)::DownCast(parameters.entity(3));
      } catch (const NotUnderstood&) {
      }
      if (context.IsNull()) continue;
      Handle(StepShape_ShapeRepresentation) empty = new StepShape_ShapeRepresentation;
      empty->Init(new TCollection_HAsciiString(""), nullptr, context);
      for (const Entity& user : users_of(entity)) refer(user, empty);
      model_->ReplaceEntity(i, empty);
      any = true;
    }
    return any;
  }

  // Whether no item but those that were read has an area: what is not read must stay to be found.
  bool is_read_whole(const Parameters& items) const {
    for (int i = 1; i <= items.count(); ++i) {
      const Entity item = items.entity(i);
      if (item.IsNull() || (has_area(item) && !read_.contains(item.get()))) return false;
    }
    return true;
  }

  bool has_area(const Entity& item, int levels = kMostLevels) const {
    if (levels == 0) return true;
    const std::vector<std::string> types = unknown_types(item);
    if (!types.empty()) return types.size() > 1 || !is_without_area(types.front());
    if (!item->IsKind(STANDARD_TYPE(StepVisual_TessellatedGeometricSet))) return false;
    Interface_EntityIterator part = session_->Graph().Shareds(item);
    for (part.Start(); part.More(); part.Next()) {
      if (has_area(part.Value(), levels - 1)) return true;
    }
    return false;
  }

  void refer(const Entity& user, const Handle(StepShape_ShapeRepresentation) & empty) {
    const auto definition = Handle(StepShape_ShapeDefinitionRepresentation)::DownCast(user);
    const auto relation = Handle(StepRepr_RepresentationRelationship)::DownCast(user);
    if (!definition.IsNull()) {
      definition->SetUsedRepresentation(empty);
    } else if (!relation.IsNull() && relation->Rep1().IsNull()) {
      relation->SetRep1(empty);
    } else if (!relation.IsNull() && relation->Rep2().IsNull()) {
      relation->SetRep2(empty);
    } else {
      return;
    }
    model_->ClearReportEntity(model_->Number(user));
  }

  Handle(XSControl_WorkSession) session_;
  Handle(StepData_StepModel) model_;
  std::vector<TriangleItem> items_;
  std::set<const Standard_Transient*> read_;
};

}  // namespace

std::vector<TriangleItem> take_triangles(const Handle(XSControl_WorkSession) & session) {
  return TriangleFinder(session).take();
}

std::vector<std::string> unknown_types(const Handle(Standard_Transient) & entity) {
  std::vector<std::string> types;
  for (Unknown part = Unknown::DownCast(entity); !part.IsNull(); part = part->Next()) {
    types.emplace_back(part->StepType());
  }
  return types;
}

}  // namespace forcelayer::mesh
