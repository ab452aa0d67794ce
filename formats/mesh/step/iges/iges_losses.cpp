#include "formats/mesh/step/iges/iges_losses.h"

#include <BRep_Tool.hxx>
#include <Geom_Surface.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_UndefinedEntity.hxx>
#include <IGESDraw_CircArraySubfigure.hxx>
#include <IGESGeom_Line.hxx>
#include <IGESSolid_EdgeList.hxx>
#include <IGESSolid_HArray1OfFace.hxx>
#include <IGESSolid_Loop.hxx>
#include <IGESSolid_Shell.hxx>
#include <IGESSolid_VertexList.hxx>
#include <Interface_Check.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <StepData_StepModel.hxx>
#include <TColStd_HArray1OfInteger.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <algorithm>
#include <initializer_list>
#include <unordered_map>

#include "formats/mesh/step/entities/faces.h"
#include "formats/mesh/step/iges/iges_numbers.h"
#include "formats/mesh/step/iges/iges_placings.h"
#include "formats/mesh/step/iges/iges_trims.h"

namespace forcelayer::mesh {
namespace {

using Entity = Handle(IGESData_IGESEntity);
using EntitySet = std::unordered_set<const Standard_Transient*>;

constexpr const char* kMend =
    "export the file again, with solids as boundary representations, or as STEP";

bool is_one_of(const Entity& entity, std::initializer_list<int> types) {
  return std::find(types.begin(), types.end(), entity->TypeNumber()) != types.end();
}

bool is_physically_dependent(const Entity& entity) {
  constexpr int kPhysicallyDependent = 1;
  return (entity->SubordinateStatus() & kPhysicallyDependent) != 0;
}

bool is_trimmed(const Entity& entity) { return is_one_of(entity, {143, 144}); }

// Trimmed and bounded surfaces, and the faces of a boundary representation.
bool is_face(const Entity& entity) { return is_trimmed(entity) || entity->TypeNumber() == 510; }

bool is_surface(const Entity& entity) {
  constexpr int kPlane = 108, kUnbounded = 0;
  if (entity->TypeNumber() == kPlane) return entity->FormNumber() != kUnbounded;
  return is_one_of(entity, {114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198});
}

// The types of entities that bound a face.
bool is_boundary(const Entity& entity) { return is_one_of(entity, {141, 142, 508}); }

// Primitives, sweeps, Boolean trees and assemblies of constructive solids.
bool is_constructive(const Entity& entity) {
  return is_one_of(entity, {150, 152, 154, 156, 158, 160, 162, 164, 168, 180, 182, 184, 430});
}

// Instances, single and in arrays, of what is defined once.
bool is_placing(const Entity& entity) { return is_one_of(entity, {408, 412, 414, 420}); }

constexpr int kExternalReference = 416;

bool is_group(const Entity& entity) {
  return is_placing(entity) || is_one_of(entity, {308, 320, 402, 406});
}

bool fails(const Handle(IGESData_IGESModel) & model, const Entity& entity) {
  const Standard_Integer number = model->Number(entity);
  return number > 0 && model->Check(number, Standard_True)->NbFails() > 0;
}

// Which groups and placings have faces, over others too.
class FaceHolders {
 public:
  explicit FaceHolders(const Handle(XSControl_WorkSession) & session)
      : model_(Handle(IGESData_IGESModel)::DownCast(session->Model())), graph_(session->Graph()) {}

  // True too for one that makes no sense: nobody knows what it places.
  bool holds(const Entity& entity) {
    if (is_face(entity) || is_surface(entity)) return true;
    const auto [known, is_new] = holds_.try_emplace(entity.get(), false);
    if (!is_new) return known->second;
    bool holds_any = is_group(entity) && fails(model_, entity);
    // The graph of OpenCASCADE lacks what a circular array repeats.
    const auto circle = Handle(IGESDraw_CircArraySubfigure)::DownCast(entity);
    if (!circle.IsNull() && !circle->BaseEntity().IsNull() && holds(circle->BaseEntity())) {
      holds_any = true;
    }
    Interface_EntityIterator part = graph_.Shareds(entity);
    for (part.Start(); part.More() && !holds_any; part.Next()) {
      const Entity other = Entity::DownCast(part.Value());
      holds_any = !other.IsNull() && holds(other);
    }
    return holds_[entity.get()] = holds_any;
  }

 private:
  Handle(IGESData_IGESModel) model_;
  const Interface_Graph& graph_;
  std::unordered_map<const IGESData_IGESEntity*, bool> holds_;
};

// All that refer to it, over others too.
std::vector<Entity> holders_of(const Interface_Graph& graph, const Entity& entity) {
  std::vector<Entity> holders{entity};
  std::unordered_set<const Standard_Transient*> seen{entity.get()};
  for (std::size_t n = 0; n < holders.size(); ++n) {
    Interface_EntityIterator user = graph.Sharings(holders[n]);
    for (user.Start(); user.More(); user.Next()) {
      const Entity holder = Entity::DownCast(user.Value());
      if (!holder.IsNull() && seen.insert(holder.get()).second) holders.push_back(holder);
    }
  }
  return holders;
}

class IgesCheck {
 public:
  IgesCheck(const Handle(XSControl_WorkSession) & session,
            const Handle(TDocStd_Document) & document, const IgesDamage& damage)
      : model_(Handle(IGESData_IGESModel)::DownCast(session->Model())),
        graph_(session->Graph()),
        process_(session->TransferReader()->TransientProcess()),
        faces_(document),
        holders_(session),
        damage_(damage) {}

  FileLosses find() {
    FileLosses found;
    found.mend = kMend;
    found.pieces = damage_.pieces;
    lost_faces_.count = damage_.cut_faces;
    lost_faces_.names = damage_.faces;
    lost_placings_.names = damage_.placings;
    for (Standard_Integer i = 1; i <= model_->NbEntities(); ++i) look_at(model_->Entity(i));
    std::vector<Losses> all = {lost_faces_, lost_owners_, lost_solids_, lost_placings_,
                               lost_files_};
    for (const Entity& entity : lost_) {
      found.pieces.push_back({name_of(entity), {}, owners_of(holders_of(graph_, entity)), {}, 0});
    }
    for (std::size_t n = 0; n < damage_.pieces.size(); ++n) {
      found.pieces[n].owners = owners_of(damage_.holders[n]);
    }
    all.push_back({"damaged entity", 0, damage_.others});
    found.text = text_of(all);
    return found;
  }

 private:
  void look_at(const Entity& entity) {
    if (damage_.below.contains(entity.get())) return;
    if (is_face(entity) || (is_surface(entity) && stands_alone(entity))) {
      if (is_face(entity) || !is_physically_dependent(entity)) ++lost_faces_.count;
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process_, entity);
      if (!faces_.has(shape) || lacks_a_boundary(entity, shape)) lose(entity, lost_faces_);
    } else if (is_constructive(entity) && stands_alone(entity)) {
      if (!faces_.has(TransferBRep::ShapeResult(process_, entity))) {
        lose(entity, lost_solids_);
      }
    } else if (is_boundary(entity) && is_orphan(entity)) {
      lose(entity, lost_owners_);
    } else if (entity->TypeNumber() == kExternalReference) {
      lose(entity, lost_files_);
    } else if (is_placing(entity) && holders_.holds(entity)) {
      if (!faces_.has(TransferBRep::ShapeResult(process_, entity))) {
        lose(entity, lost_placings_);
      }
    }
  }

  // OpenCASCADE drops a boundary of which it makes no outline: of a plate with a hole the hole's
  // cover is left. Of a closed surface it joins two boundaries by a seam. A face without any gets
  // no triangles.
  static bool lacks_a_boundary(const Entity& entity, const TopoDS_Shape& shape) {
    std::uint64_t outlines = 0;
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      const Handle(Geom_Surface) surface = BRep_Tool::Surface(TopoDS::Face(face.Current()));
      if (surface->IsUClosed() || surface->IsVClosed()) return false;
      for (TopoDS_Iterator wire(face.Current()); wire.More(); wire.Next()) {
        if (wire.Value().ShapeType() == TopAbs_WIRE) ++outlines;
      }
    }
    return outlines > 0 && outlines < count_boundaries(entity);
  }

  void lose(const Entity& entity, Losses& kind) {
    kind.names.push_back(name_of(entity));
    lost_.push_back(entity);
  }

  // The labels of the document that hold faces of these entities.
  std::vector<std::string> owners_of(const std::vector<Entity>& holders) const {
    std::set<std::string> owners;
    for (const Entity& holder : holders) {
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process_, holder);
      if (!shape.IsNull()) owners.merge(faces_.owners_of(shape));
    }
    return {owners.begin(), owners.end()};
  }

  // Whether it is geometry of its own: no construction, and nothing but groups refers to it.
  bool stands_alone(const Entity& entity) const {
    if (entity->UseFlag() != 0) return false;
    Interface_EntityIterator user = graph_.Sharings(entity);
    for (user.Start(); user.More(); user.Next()) {
      const Entity other = Entity::DownCast(user.Value());
      if (!other.IsNull() && !is_group(other)) return false;
    }
    return true;
  }

  // Whether it says that it is a part of another entity, and no entity that is read refers to it.
  bool is_orphan(const Entity& entity) const {
    return is_physically_dependent(entity) && graph_.Sharings(entity).NbEntities() == 0;
  }

  std::string name_of(const Entity& entity) const { return iges_name(model_, entity); }

  Handle(IGESData_IGESModel) model_;
  const Interface_Graph& graph_;
  Handle(Transfer_TransientProcess) process_;
  DocumentFaces faces_;
  FaceHolders holders_;
  const IgesDamage& damage_;
  std::vector<Entity> lost_;
  Losses lost_faces_{"face", 0, {}}, lost_solids_{"solid", 0, {}}, lost_placings_{"placing", 0, {}},
      lost_files_{"external reference", 0, {}}, lost_owners_{"faceless boundary", 0, {}};
};

constexpr int kFace = 510, kShell = 514, kSolid = 186;

bool is_of_boundary_representation(const Entity& entity) {
  return is_one_of(entity, {kSolid, 502, 504, 508, kFace, kShell});
}

// Takes faces out of their shells, and whole solids where a shell itself is damaged.
class IgesCut {
 public:
  IgesCut(const Handle(XSControl_WorkSession) & session, IgesDamage& damage)
      : session_(session),
        model_(Handle(IGESData_IGESModel)::DownCast(session->Model())),
        damage_(damage) {}

  void climb(const Entity& entity) {
    if (!seen_.insert(entity.get()).second) return;
    Interface_EntityIterator user = session_->Graph().Sharings(entity);
    bool is_used = false;
    for (user.Start(); user.More(); user.Next()) {
      const Entity other = Entity::DownCast(user.Value());
      if (other.IsNull() || !is_of_boundary_representation(other)) continue;
      const auto shell = Handle(IGESSolid_Shell)::DownCast(other);
      is_used = true;
      if (entity->TypeNumber() == kFace && !shell.IsNull() && remove_face(shell, entity)) {
        replace(entity);
      } else {
        climb(other);
      }
    }
    if (!is_used) replace(entity);
  }

  void finish() {
    if (damage_.pieces.empty()) return;
    session_->ComputeGraph(Standard_True);
    session_->TransferReader()->SetGraph(session_->HGraph());
  }

 private:
  // False where no face would be left.
  static bool remove_face(const Handle(IGESSolid_Shell) & shell, const Entity& face) {
    std::vector<Standard_Integer> left;
    for (Standard_Integer i = 1; i <= shell->NbFaces(); ++i) {
      if (!shell->Face(i).IsNull() && shell->Face(i) != face) left.push_back(i);
    }
    if (left.empty()) return false;
    const auto count = static_cast<Standard_Integer>(left.size());
    Handle(IGESSolid_HArray1OfFace) faces = new IGESSolid_HArray1OfFace(1, count);
    Handle(TColStd_HArray1OfInteger) sides = new TColStd_HArray1OfInteger(1, count);
    for (Standard_Integer i = 1; i <= count; ++i) {
      const Standard_Integer from = left[static_cast<std::size_t>(i - 1)];
      faces->SetValue(i, shell->Face(from));
      sides->SetValue(i, shell->Orientation(from) ? 1 : 0);
    }
    shell->Init(faces, sides);
    return true;
  }

  // With all that nothing else refers to, which OpenCASCADE would else read on its own: the plane
  // of a face is one without end.
  void replace(const Entity& entity) {
    add_piece(entity);
    if (is_face(entity)) ++damage_.cut_faces;
    empty_trims(entity);
    const std::vector<Entity> all = all_below(entity);
    EntitySet within;
    for (const Entity& part : all) within.insert(part.get());
    const EntitySet kept = used_outside(all, within);
    for (const Entity& part : all) {
      if (kept.contains(part.get())) continue;
      replaced_.insert(part.get());
      const Standard_Integer number = model_->Number(part);
      if (number == 0) continue;
      model_->ClearReportEntity(number);
      model_->ReplaceEntity(number, new IGESData_UndefinedEntity);
    }
  }

  // It, and all that it refers to, over others too, but no other face that a group may list.
  std::vector<Entity> all_below(const Entity& entity) const {
    std::vector<Entity> all{entity};
    EntitySet seen{entity.get()};
    const auto add = [&](const Entity& part) {
      if (!part.IsNull() && !is_trimmed(part) && seen.insert(part.get()).second)
        all.push_back(part);
    };
    for (std::size_t n = 0; n < all.size(); ++n) {
      const Entity of = all[n];
      for (const Entity& part : parts_of_trimmed(of)) add(part);
      Interface_EntityIterator part = session_->Graph().Shareds(of);
      for (part.Start(); part.More(); part.Next()) add(Entity::DownCast(part.Value()));
    }
    return all;
  }

  // Those but the first that an entity outside refers to, with all below them.
  EntitySet used_outside(const std::vector<Entity>& all, const EntitySet& within) const {
    EntitySet kept;
    for (std::size_t n = 1; n < all.size(); ++n) {
      Interface_EntityIterator user = session_->Graph().Sharings(all[n]);
      for (user.Start(); user.More(); user.Next()) {
        const Standard_Transient* other = user.Value().get();
        if (within.contains(other) || replaced_.contains(other)) continue;
        for (const Entity& part : all_below(all[n])) kept.insert(part.get());
        break;
      }
    }
    kept.erase(all.front().get());
    return kept;
  }

  void add_piece(const Entity& entity) {
    damage_.pieces.push_back({iges_name(model_, entity), {}, {}, {}, 0});
    damage_.holders.push_back(holders_of(session_->Graph(), entity));
    for (const Entity& part : all_below(entity)) damage_.below.insert(part.get());
  }

  Handle(XSControl_WorkSession) session_;
  Handle(IGESData_IGESModel) model_;
  IgesDamage& damage_;
  EntitySet seen_, replaced_;
};

// Edges of boundary representations that make no sense. The loops that use them are damaged: a list
// of edges serves all loops of a solid.
class IgesEdges {
 public:
  explicit IgesEdges(const Handle(IGESData_IGESModel) & model) : model_(model) {}

  // Whether the edges of an entity that could be read make no sense.
  bool is_damaged(const Entity& entity) const {
    const auto loop = Handle(IGESSolid_Loop)::DownCast(entity);
    if (loop.IsNull()) return false;
    for (Standard_Integer i = 1; i <= loop->NbEdges(); ++i) {
      constexpr int kEdge = 0;
      if (loop->EdgeType(i) == kEdge && is_damaged(loop->Edge(i), loop->ListIndex(i))) return true;
    }
    return false;
  }

 private:
  bool is_damaged(const Entity& list, Standard_Integer i) const {
    const auto edges = Handle(IGESSolid_EdgeList)::DownCast(list);
    if (edges.IsNull()) return true;
    if (fails(model_, edges)) return false;  // it is damaged itself
    if (i < 1 || i > edges->NbEdges() || edges->Curve(i).IsNull()) return true;
    return fails(model_, edges->Curve(i)) || is_point(edges->Curve(i)) ||
           is_damaged(edges->StartVertexList(i), edges->StartVertexIndex(i)) ||
           is_damaged(edges->EndVertexList(i), edges->EndVertexIndex(i));
  }

  bool is_damaged(const Handle(IGESSolid_VertexList) & list, Standard_Integer i) const {
    return list.IsNull() || (!fails(model_, list) && (i < 1 || i > list->NbVertices()));
  }

  // A line whose numbers are left out: OpenCASCADE crashes on some.
  static bool is_point(const Entity& curve) {
    const auto line = Handle(IGESGeom_Line)::DownCast(curve);
    return !line.IsNull() && line->StartPoint().Distance(line->EndPoint()) == 0;
  }

  Handle(IGESData_IGESModel) model_;
};

// The entities that use these entries of the directory, over others too.
enum class Users { kFacesOrSurfaces, kAllThatPlaces };

// The faces that use them; of those that no face uses, the surfaces, or the solids and placings
// too.
EntitySet users_of(const Interface_Graph& graph, const Handle(IGESData_IGESModel) & model,
                   const std::set<int>& entries, Users kind) {
  EntitySet users;
  if (entries.empty()) return users;
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Entity entity = model->Entity(i);
    if (!entries.contains(model->DNum(entity))) continue;
    const std::vector<Entity> holders = holders_of(graph, entity);
    const bool has_faces = std::any_of(holders.begin(), holders.end(), is_face);
    for (const Entity& holder : holders) {
      const bool places =
          kind == Users::kAllThatPlaces &&
          (is_placing(holder) || is_constructive(holder) || is_of_boundary_representation(holder));
      if (has_faces ? is_face(holder) : is_surface(holder) || places) users.insert(holder.get());
    }
  }
  return users;
}

}  // namespace

std::string iges_name(const Handle(IGESData_IGESModel) & model, const Entity& entity) {
  return "D" + std::to_string(model->DNum(entity)) + " (type " +
         std::to_string(entity->TypeNumber()) + ")";
}

std::string entity_name(const Handle(Interface_InterfaceModel) & model,
                        const Handle(Standard_Transient) & entity) {
  const auto iges = Handle(IGESData_IGESModel)::DownCast(model);
  if (!iges.IsNull()) return iges_name(iges, Handle(IGESData_IGESEntity)::DownCast(entity));
  return step_name(Handle(StepData_StepModel)::DownCast(model), entity);
}

IgesDamage take_out_iges_damage(const Handle(XSControl_WorkSession) & session,
                                std::string_view text) {
  const auto model = Handle(IGESData_IGESModel)::DownCast(session->Model());
  IgesDamage damage;
  const IgesEdges edges(model);
  const IgesMisplaced misplaced = settle_iges_placings(session, text);
  EntitySet garbled =
      users_of(session->Graph(), model, iges_entries_without_numbers(text), Users::kAllThatPlaces);
  garbled.merge(users_of(session->Graph(), model, misplaced.geometry, Users::kFacesOrSurfaces));
  std::vector<Entity> damaged;
  FaceHolders face_holders(session);
  for (const Entity& entity : misplaced.holders) {
    if (!is_of_boundary_representation(entity) && !face_holders.holds(entity)) continue;
    damage.placings.push_back(iges_name(model, entity));
    damaged.push_back(entity);
  }
  EntitySet is_misplaced;
  for (const Entity& entity : damaged) is_misplaced.insert(entity.get());
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Entity entity = model->Entity(i);
    if (is_misplaced.contains(entity.get())) continue;
    const bool is_damaged =
        garbled.contains(entity.get()) ||
        (is_of_boundary_representation(entity)
             ? model->Check(i, Standard_True)->NbFails() > 0 || edges.is_damaged(entity)
             : is_badly_trimmed(model, entity));
    if (!is_damaged) continue;
    (is_face(entity) ? damage.faces : damage.others).push_back(iges_name(model, entity));
    damaged.push_back(entity);
  }
  IgesCut cut(session, damage);
  for (const Entity& entity : damaged) cut.climb(entity);
  cut.finish();
  return damage;
}

std::uint64_t count_blanked_iges(const Handle(XSControl_WorkSession) & session) {
  constexpr int kBlanked = 1, kGroup = 402;
  const auto model = Handle(IGESData_IGESModel)::DownCast(session->Model());
  FaceHolders holders(session);
  std::uint64_t count = 0;
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Entity entity = model->Entity(i);
    if (entity->BlankStatus() != kBlanked || is_physically_dependent(entity)) continue;
    const bool is_body = entity->TypeNumber() == kSolid || is_trimmed(entity) || is_surface(entity);
    const bool is_of_bodies = entity->TypeNumber() == kGroup || is_placing(entity);
    if (is_body || (is_of_bodies && holders.holds(entity))) ++count;
  }
  return count;
}

FileLosses find_iges_losses(const Handle(XSControl_WorkSession) & session,
                            const Handle(TDocStd_Document) & document, const IgesDamage& damage) {
  return IgesCheck(session, document, damage).find();
}

}  // namespace forcelayer::mesh
