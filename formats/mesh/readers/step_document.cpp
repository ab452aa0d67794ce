#include "formats/mesh/readers/step_document.h"

#include <IGESCAFControl_Reader.hxx>
#include <Interface_InterfaceModel.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

namespace forcelayer::mesh {
namespace {

[[noreturn]] void fail(const SourceFile& file, ErrorCode code, std::string what) {
  fail_read(file, code, "", std::move(what), "export the file again");
}

// Every face of a STEP file must have become a shape.
void check_faces(const SourceFile& file, const Handle(XSControl_WorkSession) & session) {
  const Handle(Interface_InterfaceModel) model = session->Model();
  const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
  std::uint64_t faces = 0, lost = 0;
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    if (!entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface))) continue;
    ++faces;
    if (TransferBRep::ShapeResult(process, entity).IsNull()) ++lost;
  }
  if (lost == 0) return;
  fail(file, ErrorCode::kMeshIncomplete,
       "OpenCASCADE could not read " + std::to_string(lost) + " of " + counted(faces, "face"));
}

template <typename Reader>
void transfer(const SourceFile& file, Reader& reader, Handle(TDocStd_Document) & document) {
  reader.SetNameMode(true);
  reader.SetColorMode(false);
  reader.SetLayerMode(false);
  if (reader.ReadFile(file.path.c_str()) != IFSelect_RetDone) {
    fail(file, ErrorCode::kMeshUnreadable, "OpenCASCADE cannot parse this file");
  }
  if (!reader.Transfer(document)) {
    fail(file, ErrorCode::kMeshUnreadable, "OpenCASCADE cannot read the shapes of this file");
  }
}

}  // namespace

Handle(TDocStd_Document) read_step_document(const SourceFile& file) {
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  if (lower_case_extension(file.path).starts_with(".ig")) {
    IGESCAFControl_Reader reader;
    transfer(file, reader, document);
  } else {
    STEPCAFControl_Reader reader;
    transfer(file, reader, document);
    check_faces(file, reader.Reader().WS());
  }
  return document;
}

}  // namespace forcelayer::mesh
