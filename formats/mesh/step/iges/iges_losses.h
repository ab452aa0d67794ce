// Finds the parts of an IGES file that OpenCASCADE did not turn into shapes.
#pragma once

#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <TDocStd_Document.hxx>
#include <XSControl_WorkSession.hxx>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "formats/mesh/step/entities/faces.h"
#include "formats/mesh/step/entities/lost_pieces.h"

namespace forcelayer::mesh {

// "D45 (type 510)".
std::string iges_name(const Handle(IGESData_IGESModel) & model,
                      const Handle(IGESData_IGESEntity) & entity);

// The name of an entity of either format: "#45 ADVANCED_FACE 'left'", "D45 (type 510)".
std::string entity_name(const Handle(Interface_InterfaceModel) & model,
                        const Handle(Standard_Transient) & entity);

// Damage that was taken out of a file before it was transferred.
struct IgesDamage {
  std::vector<std::string> faces, placings, others;  // names
  std::uint64_t cut_faces = 0;                       // taken out
  std::vector<LostPiece> pieces;
  std::vector<std::vector<Handle(IGESData_IGESEntity)>> holders;  // [pieces] all that refer to them
  std::unordered_set<const Standard_Transient*> below;            // entities that the pieces hold
};

// Takes out of the file that was read in `session` the faces and solids that refer to what is not
// there or make no sense: OpenCASCADE may crash on them, or read something else. `text`: the file.
IgesDamage take_out_iges_damage(const Handle(XSControl_WorkSession) & session,
                                std::string_view text);

// The damage, and each face, solid, placing and external reference of the file that was
// transferred in `session` that is not in `document`: OpenCASCADE leaves out what it finds damaged,
// and what it does not know, without an error.
FileLosses find_iges_losses(const Handle(XSControl_WorkSession) & session,
                            const Handle(TDocStd_Document) & document, const IgesDamage& damage);

// Surfaces, bodies, groups of them and instances that are blanked in the file, each whole.
std::uint64_t count_blanked_iges(const Handle(XSControl_WorkSession) & session);

}  // namespace forcelayer::mesh
