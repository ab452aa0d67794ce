// Finds the parts of an IGES file that OpenCASCADE did not turn into shapes.
#pragma once

#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <TDocStd_Document.hxx>
#include <XSControl_WorkSession.hxx>
#include <string>
#include <string_view>

#include "formats/mesh/step/entities/faces.h"
#include "formats/mesh/step/entities/lost_pieces.h"

namespace forcelayer::mesh {

// "D45 (type 510)".
std::string iges_name(const Handle(IGESData_IGESModel) & model,
                      const Handle(IGESData_IGESEntity) & entity);

// The name of an entity of either format: "#45 ADVANCED_FACE 'left'", "D45 (type 510)".
std::string entity_name(const Handle(Interface_InterfaceModel) & model,
                        const Handle(Standard_Transient) & entity);

// The damaged entities of faces, and the placings that cannot be settled, of the file that was read
// in `session`, as "1 damaged entity: D45 (type 510)"; "" if nothing is damaged. They refer to what
// is not there or make no sense: OpenCASCADE may crash on them, or read something else. `text`: the
// file.
std::string find_iges_damage(const Handle(XSControl_WorkSession) & session, std::string_view text);

// Each face, solid, placing and external reference of the file that was transferred in `session`
// that is not in `document`: OpenCASCADE leaves out what it finds damaged, and what it does not
// know, without an error.
FileLosses find_iges_losses(const Handle(XSControl_WorkSession) & session,
                            const Handle(TDocStd_Document) & document);

// Surfaces, bodies, groups of them and instances that are blanked in the file, each whole.
std::uint64_t count_blanked_iges(const Handle(XSControl_WorkSession) & session);

}  // namespace forcelayer::mesh
