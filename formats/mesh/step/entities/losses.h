// Finds the parts of a STEP file that OpenCASCADE did not turn into shapes.
#pragma once

#include <TDocStd_Document.hxx>
#include <XSControl_WorkSession.hxx>
#include <string>

#include "formats/mesh/step/entities/lost_pieces.h"

namespace forcelayer::mesh {

// The damaged entities of the file that was read in `session`, as "2 damaged entities: #16
// CLOSED_SHELL, ..."; "" if nothing was lost. They refer to what is not there or make no sense, so
// that OpenCASCADE may crash on them, or place shapes wrong without a word.
std::string find_step_damage(const Handle(XSControl_WorkSession) & session);

// Each face, solid and placing of the file that was transferred in `session` that is not in
// `document`: OpenCASCADE leaves constructive and tessellated solids out, and what it finds
// damaged, without an error.
FileLosses find_step_losses(const Handle(XSControl_WorkSession) & session,
                            const Handle(TDocStd_Document) & document);

}  // namespace forcelayer::mesh
