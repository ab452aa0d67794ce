// The document of a STEP or IGES file, as OpenCASCADE reads it.
#pragma once

#include <TDF_Label.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <map>
#include <string>
#include <vector>

#include "formats/mesh/reader.h"
#include "formats/mesh/step/entities/lost_pieces.h"

namespace forcelayer::mesh {

struct StepDocument {
  Handle(TDocStd_Document) document;
  // Products whose shapes are in other files, by entry_of() their label: what this file calls each
  // of those files, the likeliest name first. No file is opened.
  std::map<std::string, std::vector<std::vector<std::string>>> references;
  FileLosses losses;
  std::vector<std::string> warnings;
  std::vector<TopoDS_Shape> open_bodies;  // should close, and do not
  bool is_iges = false;
};

// Reads the whole file; OpenCASCADE turns all units into millimeters. Throws where the file cannot
// be parsed, or where nothing of it became a shape.
StepDocument read_step_document(const SourceFile& file);

}  // namespace forcelayer::mesh
