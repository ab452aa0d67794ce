#include "formats/mesh/step/entities/iges_losses.h"

#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Check.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <algorithm>
#include <initializer_list>
#include <unordered_map>

#include "formats/mesh/step/entities/faces.h"

namespace forcelayer::mesh {
namespace {

using Entity = Handle(IGESData_IGESEntity);

constexpr const char* kMend =
    "export the file again, with solids as boundary representations, or as STEP";

bool is_one_of(const Entity& entity, std::initializer_list<int> types) {
  return std::find(types.begin(), types.end(), entity->TypeNumber()) != types.end();
}

// Trimmed and bounded surfaces, and the faces of a boundary representation.
bool is_face(const Entity& entity) { return is_one_of(entity, {143, 144, 510}); }

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
bool is_placing(const Entity& entity) { return is_one_of(entity, {408, 412, 414}); }

constexpr int kExternalReference = 416;

bool is_group(const Entity& entity) { return is_one_of(entity, {308, 402, 406, 408, 412, 414}); }

std::string name_of(const Handle(IGESData_IGESModel) & model, const Entity& entity) {
  return "D" + std::to_string(model->DNum(entity)) + " (type " +
         std::to_string(entity->TypeNumber()) + ")";
}

class IgesCheck {
 public:
  IgesCheck(const Handle(XSControl_WorkSession) & session,
            const Handle(TDocStd_Document) & document)
      : model_(Handle(IGESData_IGESModel)::DownCast(session->Model())),
        graph_(session->Graph()),
        process_(session->TransferReader()->TransientProcess()),
        faces_(document) {}

  void check(const SourceFile& file) {
    for (Standard_Integer i = 1; i <= model_->NbEntities(); ++i) look_at(model_->Entity(i));
    fail_for_losses(file, {lost_faces_, lost_owners_, lost_solids_, lost_placings_, lost_files_},
                    kMend);
  }

 private:
  void look_at(const Entity& entity) {
    if (is_face(entity) || (is_surface(entity) && stands_alone(entity))) {
      ++lost_faces_.count;
      if (!faces_.has(TransferBRep::ShapeResult(process_, entity))) {
        lost_faces_.names.push_back(name_of(entity));
      }
    } else if (is_constructive(entity) && stands_alone(entity)) {
      if (!faces_.has(TransferBRep::ShapeResult(process_, entity))) {
        lost_solids_.names.push_back(name_of(entity));
      }
    } else if (is_boundary(entity) && is_orphan(entity)) {
      lost_owners_.names.push_back(name_of(entity));
    } else if (entity->TypeNumber() == kExternalReference) {
      lost_files_.names.push_back(name_of(entity));
    } else if (is_placing(entity) && holds_faces(entity)) {
      if (!faces_.has(TransferBRep::ShapeResult(process_, entity))) {
        lost_placings_.names.push_back(name_of(entity));
      }
    }
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
    constexpr int kPhysicallyDependent = 1;
    return (entity->SubordinateStatus() & kPhysicallyDependent) != 0 &&
           graph_.Sharings(entity).NbEntities() == 0;
  }

  bool holds_faces(const Entity& entity) {
    if (is_face(entity) || is_surface(entity)) return true;
    const auto [known, is_new] = holds_.try_emplace(entity.get(), false);
    if (!is_new) return known->second;
    bool holds = false;
    Interface_EntityIterator part = graph_.Shareds(entity);
    for (part.Start(); part.More(); part.Next()) {
      const Entity other = Entity::DownCast(part.Value());
      if (!other.IsNull() && holds_faces(other)) holds = true;
    }
    return holds_[entity.get()] = holds;
  }

  std::string name_of(const Entity& entity) const { return mesh::name_of(model_, entity); }

  Handle(IGESData_IGESModel) model_;
  const Interface_Graph& graph_;
  Handle(Transfer_TransientProcess) process_;
  DocumentFaces faces_;
  std::unordered_map<const IGESData_IGESEntity*, bool> holds_;
  Losses lost_faces_{"face", 0, {}}, lost_solids_{"solid", 0, {}}, lost_placings_{"placing", 0, {}},
      lost_files_{"external reference", 0, {}}, lost_owners_{"face with the boundary", 0, {}};
};

constexpr int kFace = 510;

bool is_of_boundary_representation(const Entity& entity) {
  return is_one_of(entity, {186, 502, 504, 508, kFace, 514});
}

}  // namespace

void check_iges_references(const SourceFile& file, const Handle(XSControl_WorkSession) & session) {
  const auto model = Handle(IGESData_IGESModel)::DownCast(session->Model());
  Losses faces{"face", 0, {}}, others{"damaged entity", 0, {}};
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Entity entity = model->Entity(i);
    if (!is_of_boundary_representation(entity)) continue;
    const bool is_face = entity->TypeNumber() == kFace;
    if (is_face) ++faces.count;
    if (model->Check(i, Standard_True)->NbFails() == 0) continue;
    (is_face ? faces : others).names.push_back(name_of(model, entity));
  }
  fail_for_losses(file, {faces, others}, kMend);
}

void check_iges_losses(const SourceFile& file, const Handle(XSControl_WorkSession) & session,
                       const Handle(TDocStd_Document) & document) {
  IgesCheck(session, document).check(file);
}

}  // namespace forcelayer::mesh
