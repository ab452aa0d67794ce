// Finds the parts of an IGES file that OpenCASCADE did not turn into shapes.
#pragma once

#include <TDocStd_Document.hxx>
#include <XSControl_WorkSession.hxx>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// Throws kMeshIncomplete with the directory entries where a part of a boundary representation of
// the file that was read in `session` makes no sense: OpenCASCADE may crash on it.
void check_iges_references(const SourceFile& file, const Handle(XSControl_WorkSession) & session);

// Throws kMeshIncomplete with the directory entries where a face, a surface that stands alone, a
// constructive solid or a placing of the file that was read and transferred in `session` is not in
// `document`.
void check_iges_losses(const SourceFile& file, const Handle(XSControl_WorkSession) & session,
                       const Handle(TDocStd_Document) & document);

}  // namespace forcelayer::mesh
