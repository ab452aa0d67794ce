// Finds the parts of a STEP file that OpenCASCADE did not turn into shapes.
#pragma once

#include <TDocStd_Document.hxx>
#include <XSControl_WorkSession.hxx>
#include <string_view>
#include <unordered_set>

#include "formats/mesh/step/entities/cut.h"
#include "formats/mesh/step/entities/faces.h"
#include "formats/mesh/step/entities/lost_pieces.h"

namespace forcelayer::mesh {

// Damage that was taken out of a file before it was transferred.
struct StepDamage {
  StepCut cut;
  std::vector<Losses> told;  // but for faces, which are counted at the end
};

// Takes out of the file of this text, which was read in `session`, what cannot be read: geometry,
// topology and placings that refer to what is not there or make no sense, on which OpenCASCADE may
// crash, and those that it would place wrong without a word.
StepDamage take_out_damage(const Handle(XSControl_WorkSession) & session, std::string_view text);

using ReadEntities = std::unordered_set<const Standard_Transient*>;

// The damage, and each face, solid and placing of the file that was transferred in
// `session` that is neither in `document` nor in `read`: OpenCASCADE leaves constructive and
// tessellated solids out, and what it finds damaged, without an error.
FileLosses find_step_losses(const Handle(XSControl_WorkSession) & session,
                            const Handle(TDocStd_Document) & document, const ReadEntities& read,
                            const StepDamage& damage);

}  // namespace forcelayer::mesh
