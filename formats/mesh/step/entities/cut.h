// Takes damaged entities out of a STEP model before OpenCASCADE makes shapes of it.
#pragma once

#include <XSControl_WorkSession.hxx>
#include <unordered_set>
#include <vector>

#include "formats/mesh/step/entities/lost_pieces.h"

namespace forcelayer::mesh {

// A face of a shell, an item of a shape representation, or a placing in an assembly that was taken
// out.
struct CutPiece {
  Handle(Standard_Transient) entity;
  LostPiece piece;
};

class StepCut {
 public:
  explicit StepCut(const Handle(XSControl_WorkSession) & session);

  // Takes out the smallest pieces that need `entity`, of which OpenCASCADE may make nonsense.
  void take_out(const Handle(Standard_Transient) & entity);

  // Once all is taken out; the graph of the session is then that of what is left.
  void finish();

  const std::vector<CutPiece>& pieces() const { return pieces_; }

  // Whether the document lacks this face, solid or occurrence because it belongs to a piece.
  bool explains(const Handle(Standard_Transient) & entity) const {
    return below_.contains(entity.get());
  }

 private:
  void climb(const Handle(Standard_Transient) & entity);
  void climb_from_face(const Handle(Standard_Transient) & face);
  void look_at_user(const Handle(Standard_Transient) & entity,
                    const Handle(Standard_Transient) & user);
  void remove_faces(const Handle(Standard_Transient) & face_set);
  void remove_item(const Handle(Standard_Transient) & representation,
                   const Handle(Standard_Transient) & item);
  void drop_null_items(const Handle(Standard_Transient) & representation);
  void replace(const Handle(Standard_Transient) & definition);
  void add_piece(const Handle(Standard_Transient) & entity);
  void add_below(const Handle(Standard_Transient) & entity);

  Handle(XSControl_WorkSession) session_;
  Handle(StepData_StepModel) model_;
  std::vector<CutPiece> pieces_;
  std::unordered_set<const Standard_Transient*> seen_, cut_, below_;
};

}  // namespace forcelayer::mesh
