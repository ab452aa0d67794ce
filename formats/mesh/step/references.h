// The files that a STEP file names for the shapes of its products (external references).
#pragma once

#include <StepBasic_ProductDefinition.hxx>
#include <XSControl_WorkSession.hxx>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// A file that a product's shape is in.
struct StepReference {
  Handle(StepBasic_ProductDefinition) product;
  std::vector<std::string> names;  // what the file calls it, the likeliest first; never empty
};

// All references of a file that was read and not yet transferred. Takes their names out of the
// model: OpenCASCADE would follow them on its own, past --allow-outside, skip those of a format it
// does not know, and take two files of one name in different folders for one.
std::vector<StepReference> take_references(const Handle(XSControl_WorkSession) & session);

std::string product_name(const Handle(StepBasic_ProductDefinition) & product);

struct FoundFile {
  std::filesystem::path path;
  bool is_elsewhere = false;  // than where its likeliest name says
};

// The file that `file` calls by one of `names`: relative to its own folder, then to that of `top`,
// the file that the user named; then by its name alone in these folders. Throws with `where` where
// there is none (kFileNotFound), or where it lies outside the folder of `top` (kMeshUnsupported)
// and that is not allowed.
FoundFile find_reference(const SourceFile& file, const SourceFile& top,
                         const std::vector<std::string>& names, const std::string& where);

}  // namespace forcelayer::mesh
