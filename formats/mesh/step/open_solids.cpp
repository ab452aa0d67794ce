#include "formats/mesh/step/open_solids.h"

#include <IGESSolid_ManifoldSolid.hxx>
#include <IGESSolid_Shell.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <StepShape_ClosedShell.hxx>
#include <StepShape_ManifoldSolidBrep.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>

#include "formats/mesh/step/entities/lost_pieces.h"
#include "formats/mesh/step/iges/iges_losses.h"
#include "formats/mesh/step/sewing.h"

namespace forcelayer::mesh {
namespace {

using Entity = Handle(Standard_Transient);

bool is_solid(const Entity& entity) {
  return entity->IsKind(STANDARD_TYPE(IGESSolid_ManifoldSolid)) ||
         entity->IsKind(STANDARD_TYPE(StepShape_ManifoldSolidBrep));
}

bool is_closed_shell(const Entity& entity) {
  constexpr int kClosed = 1;
  const auto shell = Handle(IGESSolid_Shell)::DownCast(entity);
  return (!shell.IsNull() && shell->FormNumber() == kClosed) ||
         entity->IsKind(STANDARD_TYPE(StepShape_ClosedShell));
}

bool is_in_solid(const Interface_Graph& graph, const Entity& shell) {
  Interface_EntityIterator user = graph.Sharings(shell);
  for (user.Start(); user.More(); user.Next()) {
    if (is_solid(user.Value())) return true;
  }
  return false;
}

}  // namespace

std::vector<OpenSolid> open_solids(const Handle(XSControl_WorkSession) & session,
                                   double tolerance_mm) {
  const Handle(Interface_InterfaceModel) model = session->Model();
  const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
  std::vector<OpenSolid> found;
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Entity& entity = model->Value(i);
    const bool should_close =
        is_solid(entity) || (is_closed_shell(entity) && !is_in_solid(session->Graph(), entity));
    if (!should_close) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, entity);
    const std::uint64_t open = shape.IsNull() ? 0 : count_open_edges(shape, tolerance_mm);
    if (open == 0) continue;
    found.push_back({entity_name(model, entity) + " is not closed: " + counted(open, "edge") +
                         (open == 1 ? " belongs" : " belong") +
                         " to only one face; check for damaged or missing faces, because no "
                         "guarantee covers missing faces",
                     shape});
  }
  return found;
}

}  // namespace forcelayer::mesh
