#include "formats/mesh/step/references.h"

#include <Interface_InterfaceModel.hxx>
#include <STEPConstruct_ExternRefs.hxx>
#include <StepBasic_DocumentFile.hxx>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepRepr_PropertyDefinition.hxx>
#include <StepRepr_PropertyDefinitionRepresentation.hxx>
#include <StepRepr_Representation.hxx>
#include <TCollection_HAsciiString.hxx>
#include <algorithm>

#include "formats/mesh/checks/confined_path.h"

namespace forcelayer::mesh {
namespace {

namespace fs = std::filesystem;

// All names of a reference. FileName() gives one of several fields of the file; emptied, it gives
// the next.
std::vector<std::string> take_names(const STEPConstruct_ExternRefs& references,
                                    Standard_Integer number) {
  constexpr std::size_t kMaxFields = 16;
  std::vector<std::string> names;
  while (names.size() < kMaxFields) {
    const Standard_CString name = references.FileName(number);
    if (name == nullptr || *name == '\0') break;
    names.emplace_back(name);
    *const_cast<char*>(name) = '\0';
  }
  return names;
}

// LoadExternRefs() crashes on a property of a document without a representation that it knows.
void give_formats(const Handle(XSControl_WorkSession) & session) {
  const Handle(Interface_InterfaceModel) model = session->Model();
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const auto property =
        Handle(StepRepr_PropertyDefinitionRepresentation)::DownCast(model->Value(i));
    if (property.IsNull() || !property->UsedRepresentation().IsNull()) continue;
    const Handle(StepRepr_PropertyDefinition) definition =
        property->Definition().PropertyDefinition();
    if (definition.IsNull() || definition->Definition().DocumentFile().IsNull()) continue;
    property->SetUsedRepresentation(new StepRepr_Representation);
  }
}

// A name as a path of this system, and whether it began with a drive of another.
struct Cleaned {
  fs::path path;
  bool has_drive = false;
};

Cleaned cleaned(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  if (name.starts_with("file://")) name.erase(0, 7);
  if (name.size() > 2 && name[0] == '/' && name[2] == ':') name.erase(0, 1);  // file:///C:/
  const bool has_drive = name.size() > 1 && name[1] == ':';
  if (has_drive) name.erase(0, 2);
  return {name, has_drive || name.starts_with("//")};
}

// The paths to look at in turn: each name, then each field after the first as the folder of the
// first.
std::vector<fs::path> paths_of(const std::vector<std::string>& names) {
  std::vector<fs::path> paths;
  const Cleaned first = cleaned(names.front());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [path, has_drive] = cleaned(names[i]);
    if (has_drive) continue;
    if (i > 0 && !first.has_drive && first.path.is_relative()) paths.push_back(path / first.path);
    paths.push_back(path);
  }
  for (const std::string& name : names) paths.push_back(cleaned(name).path.filename());
  return paths;
}

}  // namespace

std::vector<StepReference> take_references(const Handle(XSControl_WorkSession) & session) {
  give_formats(session);
  STEPConstruct_ExternRefs found(session);
  found.LoadExternRefs();
  std::vector<StepReference> references;
  std::vector<std::vector<std::string>> all;
  for (Standard_Integer i = 1; i <= found.NbExternRefs(); ++i) {
    // Several products may share one field: what was taken before counts for them, too.
    std::vector<std::string> names = take_names(found, i);
    if (names.empty()) {
      for (Standard_Integer j = 1; j < i; ++j) {
        const bool shared = !found.DocFile(i).IsNull() && found.DocFile(i) == found.DocFile(j);
        if (shared) names = all[static_cast<std::size_t>(j - 1)];
      }
    }
    all.push_back(names);
    if (!names.empty() && !found.ProdDef(i).IsNull()) {
      references.push_back({found.ProdDef(i), std::move(names)});
    }
  }
  return references;
}

std::string product_name(const Handle(StepBasic_ProductDefinition) & product) {
  if (product->Formation().IsNull() || product->Formation()->OfProduct().IsNull()) return "";
  const Handle(StepBasic_Product) named = product->Formation()->OfProduct();
  for (const Handle(TCollection_HAsciiString) & name : {named->Name(), named->Id()}) {
    if (!name.IsNull() && !name->IsEmpty()) return name->ToCString();
  }
  return "";
}

FoundFile find_reference(const SourceFile& file, const SourceFile& top,
                         const std::vector<std::string>& names, const std::string& where) {
  const fs::path own_folder = fs::path(file.path).parent_path();
  const fs::path top_folder = fs::path(top.path).parent_path();
  const std::string what = "the shape of this node is in the file " + in_quotes(names.front());
  for (const fs::path& path : paths_of(names)) {
    for (const fs::path& folder : {own_folder, top_folder}) {
      const fs::path candidate = folder / path;
      std::error_code ignored;
      if (!path.has_filename() || !fs::is_regular_file(candidate, ignored)) continue;
      if (!file.options.allow_outside && !lies_under(candidate, top_folder)) {
        fail_read(file, ErrorCode::kMeshUnsupported, where, what + ", which " + kOutsideWhat,
                  kOutsideMend);
      }
      return {candidate, candidate != own_folder / cleaned(names.front()).path};
    }
  }
  fail_read(file, ErrorCode::kFileNotFound, where, what + ", which is missing",
            "put the missing file beside the referring file, or leave out the node with --without");
}

}  // namespace forcelayer::mesh
