// The document of a STEP or IGES file, as OpenCASCADE reads it.
#pragma once

#include <TDocStd_Document.hxx>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// Reads the whole file; OpenCASCADE turns all units into millimeters. Throws where the
// file cannot be parsed, or where a face of it did not become a shape.
Handle(TDocStd_Document) read_step_document(const SourceFile& file);

}  // namespace forcelayer::mesh
