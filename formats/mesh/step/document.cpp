#include "formats/mesh/step/document.h"

#include <IGESCAFControl_Reader.hxx>
#include <IGESData_BasicEditor.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cstdio>

#include "formats/file/file_bytes.h"
#include "formats/mesh/node_names.h"
#include "formats/mesh/step/entities/faces.h"
#include "formats/mesh/step/entities/hidden.h"
#include "formats/mesh/step/entities/losses.h"
#include "formats/mesh/step/entities/names.h"
#include "formats/mesh/step/entities/nesting.h"
#include "formats/mesh/step/entities/step_units.h"
#include "formats/mesh/step/iges/iges_losses.h"
#include "formats/mesh/step/occt_messages.h"
#include "formats/mesh/step/open_solids.h"
#include "formats/mesh/step/references.h"

namespace forcelayer::mesh {
namespace {

template <typename Reader>
void read(const SourceFile& file, Reader& reader) {
  reader.SetNameMode(true);
  reader.SetColorMode(false);
  reader.SetLayerMode(false);
  const OcctMessages messages;
  if (reader.ReadFile(file.path.c_str()) == IFSelect_RetDone) return;
  fail_read(file, ErrorCode::kMeshUnreadable, "",
            "OpenCASCADE cannot parse this file" + messages.reason(), "export the file again");
}

[[noreturn]] void fail_shapes(const SourceFile& file, const OcctMessages& messages) {
  fail_read(file, ErrorCode::kMeshUnreadable, "",
            "OpenCASCADE cannot read the shapes of this file" + messages.reason(),
            "export the file again");
}

// Null where OpenCASCADE gave the product none.
TDF_Label label_of(const Handle(StepBasic_ProductDefinition) & product,
                   const STEPCAFControl_Reader& reader) {
  const TopoDS_Shape shape = TransferBRep::ShapeResult(
      reader.Reader().WS()->TransferReader()->TransientProcess(), product);
  TDF_Label label;
  if (!shape.IsNull()) reader.GetShapeLabelMap().Find(shape, label);
  return label;
}

// The references by the labels of their products.
void keep_references(const SourceFile& file, const std::vector<StepReference>& references,
                     const STEPCAFControl_Reader& reader, StepDocument& document) {
  for (const auto& [product, names] : references) {
    const TDF_Label label = label_of(product, reader);
    if (label.IsNull()) {
      fail_read(file, ErrorCode::kMeshIncomplete, product_name(product),
                "the shape of this product is in the file " + in_quotes(names.front()) +
                    ", but OpenCASCADE leaves this product out",
                "export the assembly into one file");
    }
    document.references[entry_of(label)].push_back(names);
  }
}

// The pieces by the labels of their products.
void keep_losses(FileLosses losses, const STEPCAFControl_Reader& reader, StepDocument& document) {
  for (LostPiece& piece : losses.pieces) {
    for (const auto& product : piece.products) {
      const TDF_Label label = label_of(product, reader);
      if (!label.IsNull()) {
        piece.owners.push_back(entry_of(label));
      } else {
        piece.name += " of " + in_quotes(product_name(product));
      }
    }
  }
  document.losses = std::move(losses);
}

[[noreturn]] void fail_losses(const SourceFile& file, const std::string& text, const char* mend) {
  fail_read(file, ErrorCode::kMeshIncomplete, "", "OpenCASCADE could not read " + text, mend);
}

// Where nothing became a shape, the losses are the reason, if there are any.
void check_shapes(const SourceFile& file, bool has_shapes, const FileLosses& losses,
                  const OcctMessages& messages) {
  if (has_shapes) return;
  if (losses.pieces.empty()) fail_shapes(file, messages);
  fail_losses(file, losses.text, losses.mend);
}

// Missing faces leave edges open, and are reported themselves.
void check_solids(const SourceFile& file, const Handle(XSControl_WorkSession) & session,
                  StepDocument& document) {
  if (!document.losses.pieces.empty()) return;
  constexpr double kMin = 1e-3;
  const double tolerance_mm = std::max(kMin, 1e3 * file.options.deflection_m);
  for (OpenSolid& solid : open_solids(session, tolerance_mm)) {
    document.warnings.push_back(std::move(solid.line));
    document.open_bodies.push_back(solid.shape);
  }
}

// Before OpenCASCADE places each of them.
void check_placings(const SourceFile& file, std::string_view text,
                    const Handle(Interface_InterfaceModel) & model) {
  if (NodeTreeLimit::takes(count_placings(model), text.size())) return;
  fail_read(file, ErrorCode::kMeshUnsupported, "", NodeTreeLimit::kTooMuch,
            "export the file again");
}

std::string hidden_text(const std::string& what) {
  return "the file hides " + what + ", but hidden shapes are read, too";
}

void read_step_file(const SourceFile& file, std::string_view text, StepDocument& document) {
  STEPCAFControl_Reader reader;
  reader.SetPropsMode(false);  // of no use for shapes, and OpenCASCADE crashes on damaged ones
  reader.SetGDTMode(false);
  reader.SetMatMode(false);
  reader.SetViewMode(false);
  const bool is_latin_1 = !is_utf8(text);
  Interface_Static::SetCVal("read.step.codepage", is_latin_1 ? "iso8859-1" : "UTF8");
  read(file, reader);
  const Handle(XSControl_WorkSession) session = reader.Reader().WS();
  const BytesReadAs read_as = is_latin_1 ? BytesReadAs::kLatin1 : BytesReadAs::kThemselves;
  if (auto names = settle_names(session->Model(), read_as)) {
    document.warnings.push_back(std::move(*names));
  }
  if (const std::uint64_t hidden = count_hidden_bodies(session->Model()); hidden > 0) {
    document.warnings.push_back(hidden_text(counted(hidden, "body")));
  }
  if (const std::string damage = find_step_damage(session); !damage.empty()) {
    fail_losses(file, damage, "export the file again");
  }
  const std::vector<StepReference> references = take_references(session);
  check_placings(file, text, session->Model());
  const OcctMessages messages;
  const bool has_shapes = reader.Transfer(document.document);
  keep_losses(find_step_losses(session, document.document), reader, document);
  keep_references(file, references, reader, document);
  if (const std::string shape = shape_without_unit(session); !shape.empty()) {
    document.warnings.push_back(
        shape +
        " has no known unit of length, and was read in millimeters; give the unit with --units");
  } else if (std::string unit = odd_unit(session); !unit.empty()) {
    document.warnings.push_back(std::move(unit));
  }
  check_shapes(file, has_shapes, document.losses, messages);
  check_solids(file, session, document);
}

// The sizes of a file that states another unit than it names are of one of them.
void check_iges_units(const Handle(Interface_InterfaceModel) & any, StepDocument& document) {
  const auto model = Handle(IGESData_IGESModel)::DownCast(any);
  const IGESData_GlobalSection& global = model->GlobalSection();
  constexpr int kByName = 3;
  const std::string name = global.UnitName().IsNull() ? "" : global.UnitName()->ToCString();
  const int of_name = name.empty() ? 0 : IGESData_BasicEditor::UnitNameFlag(name.c_str());
  if (global.UnitFlag() != kByName && of_name > 0 && of_name != global.UnitFlag()) {
    document.warnings.push_back(
        "the file's unit name " + in_quotes(name) + " and unit code " +
        std::to_string(global.UnitFlag()) +
        " contradict each other; the code was used: check the model's size");
  }
  if (global.Scale() != 1) {
    char scale[40];
    std::snprintf(scale, sizeof scale, "%.6g", global.Scale());
    document.warnings.push_back("the model is drawn to a scale of " + std::string(scale) +
                                ", which is not applied: check the model's size");
  }
}

void read_iges_file(const SourceFile& file, std::string_view text, StepDocument& document) {
  IGESCAFControl_Reader reader;
  read(file, reader);
  if (auto names = settle_names(reader.Model(), BytesReadAs::kThemselves)) {
    document.warnings.push_back(std::move(*names));
  }
  if (const std::uint64_t blanked = count_blanked_iges(reader.WS()); blanked > 0) {
    document.warnings.push_back(hidden_text("the faces of " + counted(blanked, "entity")));
  }
  if (const std::string damage = find_iges_damage(reader.WS(), text); !damage.empty()) {
    fail_losses(file, damage, "export the file again, or as STEP");
  }
  check_placings(file, text, reader.Model());
  const OcctMessages messages;
  const bool has_shapes = reader.Transfer(document.document);
  check_iges_units(reader.Model(), document);
  document.losses = find_iges_losses(reader.WS(), document.document);
  check_shapes(file, has_shapes, document.losses, messages);
  check_solids(file, reader.WS(), document);
}

}  // namespace

StepDocument read_step_document(const SourceFile& file) {
  StepDocument document;
  document.document = new TDocStd_Document("BinXCAF");
  document.is_iges = lower_case_extension(file.path).starts_with(".ig");
  const Result<FileBytes> bytes = FileBytes::read(file.path);
  if (!bytes) throw ReadFailure{bytes.error()};
  (document.is_iges ? read_iges_file : read_step_file)(file, text_of(*bytes), document);
  return document;
}

}  // namespace forcelayer::mesh
