#include "formats/mesh/step/iges/iges_losses.h"

#include <BRep_Tool.hxx>
#include <Geom_Surface.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESDraw_CircArraySubfigure.hxx>
#include <IGESGeom_BoundedSurface.hxx>
#include <IGESGeom_CurveOnSurface.hxx>
#include <IGESGeom_TrimmedSurface.hxx>
#include <Interface_Check.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <StepData_StepModel.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <algorithm>
#include <initializer_list>
#include <unordered_map>
#include <unordered_set>

#include "formats/mesh/step/entities/faces.h"
#include "formats/mesh/step/iges/iges_placings.h"

namespace forcelayer::mesh {
namespace {

using Entity = Handle(IGESData_IGESEntity);

constexpr const char* kMend =
    "export the file as STEP, or as IGES with solids as boundary representations";

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

// How many boundaries a trimmed or bounded surface has; 0 for other entities.
std::uint64_t count_boundaries(const Entity& entity) {
  const auto trimmed = Handle(IGESGeom_TrimmedSurface)::DownCast(entity);
  if (!trimmed.IsNull()) {
    return static_cast<std::uint64_t>(trimmed->NbInnerContours()) + trimmed->HasOuterContour();
  }
  const auto bounded = Handle(IGESGeom_BoundedSurface)::DownCast(entity);
  return bounded.IsNull() ? 0 : static_cast<std::uint64_t>(bounded->NbBoundaries());
}

// A boundary that names no surface lies on that of its face.
bool only_lacks_surface(const Entity& entity) {
  const auto boundary = Handle(IGESGeom_CurveOnSurface)::DownCast(entity);
  return !boundary.IsNull() && boundary->Surface().IsNull() && !boundary->Curve3D().IsNull();
}

class IgesCheck {
 public:
  IgesCheck(const Handle(XSControl_WorkSession) & session,
            const Handle(TDocStd_Document) & document)
      : model_(Handle(IGESData_IGESModel)::DownCast(session->Model())),
        graph_(session->Graph()),
        process_(session->TransferReader()->TransientProcess()),
        faces_(document),
        holders_(session) {}

  FileLosses find() {
    FileLosses found;
    found.mend = kMend;
    for (Standard_Integer i = 1; i <= model_->NbEntities(); ++i) look_at(model_->Entity(i));
    for (const Entity& entity : lost_) {
      found.pieces.push_back({name_of(entity), {}, owners_of(holders_of(graph_, entity))});
    }
    found.text = text_of({lost_faces_, lost_owners_, lost_solids_, lost_placings_, lost_files_});
    return found;
  }

 private:
  void look_at(const Entity& entity) {
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
  std::vector<Entity> lost_;
  Losses lost_faces_{"face", 0, {}}, lost_solids_{"solid", 0, {}}, lost_placings_{"placing", 0, {}},
      lost_files_{"external reference", 0, {}}, lost_owners_{"faceless boundary", 0, {}};
};

constexpr int kFace = 510, kShell = 514, kSolid = 186;

bool is_of_boundary_representation(const Entity& entity) {
  return is_one_of(entity, {kSolid, 502, 504, 508, kFace, kShell});
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

std::string find_iges_damage(const Handle(XSControl_WorkSession) & session, std::string_view text) {
  const auto model = Handle(IGESData_IGESModel)::DownCast(session->Model());
  const IgesMisplaced misplaced = settle_iges_placings(session, text);
  Losses placings{"placing", 0, {}}, others{"damaged entity", 0, {}};
  FaceHolders face_holders(session);
  for (const Entity& entity : misplaced.holders) {
    if (is_of_boundary_representation(entity) || face_holders.holds(entity)) {
      placings.names.push_back(iges_name(model, entity));
    }
  }
  const auto is_of_faces = [&](const Entity& entity) {
    const std::vector<Entity> holders = holders_of(session->Graph(), entity);
    return std::any_of(holders.begin(), holders.end(), [](const Entity& holder) {
      return is_face(holder) || is_surface(holder) || is_of_boundary_representation(holder);
    });
  };
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Entity entity = model->Entity(i);
    const bool is_damaged = (fails(model, entity) && !only_lacks_surface(entity)) ||
                            misplaced.geometry.contains(model->DNum(entity));
    if (is_damaged && is_of_faces(entity)) others.names.push_back(iges_name(model, entity));
  }
  return text_of({placings, others});
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
                            const Handle(TDocStd_Document) & document) {
  return IgesCheck(session, document).find();
}

}  // namespace forcelayer::mesh
