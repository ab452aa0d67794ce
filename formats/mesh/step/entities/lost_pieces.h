// The parts of a STEP file that did not become shapes: their names, products and places.
#pragma once

#include <Interface_Graph.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepData_StepModel.hxx>
#include <XSControl_WorkSession.hxx>
#include <set>
#include <string>
#include <vector>

namespace forcelayer::mesh {

// A face, solid or placing that the document of a file lacks.
struct LostPiece {
  std::string name;                                        // "#45 ADVANCED_FACE 'left'"
  std::set<Handle(StepBasic_ProductDefinition)> products;  // whose shape lacks it, in STEP
  std::vector<std::string> owners;                         // entry_of() their labels
};

// All that a file lacks; no pieces where it lacks nothing.
struct FileLosses {
  std::string text;  // "2 of 6 faces: #45 ADVANCED_FACE 'left', #77 ADVANCED_FACE; 1 solid: ..."
  std::vector<LostPiece> pieces;
  const char* mend = "";
};

// "#45 ADVANCED_FACE 'left'".
std::string step_name(const Handle(StepData_StepModel) & model,
                      const Handle(Standard_Transient) & entity);

// The entity of the file in `session` as a piece, by its users as they are now.
LostPiece step_piece(const Handle(XSControl_WorkSession) & session,
                     const Handle(Standard_Transient) & entity);

}  // namespace forcelayer::mesh
