// Finds the parts of a STEP file that OpenCASCADE did not turn into shapes.
#pragma once

#include <TDocStd_Document.hxx>
#include <XSControl_WorkSession.hxx>
#include <unordered_set>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// Throws kMeshIncomplete with the entities where geometry or topology of the file that was read in
// `session` refers to what is not there or makes no sense: OpenCASCADE may crash on it.
void check_step_references(const SourceFile& file, const Handle(XSControl_WorkSession) & session);

using ReadEntities = std::unordered_set<const Standard_Transient*>;

// Throws kMeshIncomplete with the entities where a face, a solid or a placing of the file that was
// read and transferred in `session` is neither in `document` nor in `read`: OpenCASCADE leaves
// constructive and tessellated solids out, and what it finds damaged, without an error.
void check_step_losses(const SourceFile& file, const Handle(XSControl_WorkSession) & session,
                       const Handle(TDocStd_Document) & document, const ReadEntities& read);

}  // namespace forcelayer::mesh
