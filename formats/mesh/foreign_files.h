// Names the kind of a file that no reader here takes.
#pragma once

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// Both throw kMeshUnsupported with the name of the format and a way out.

// Where the first bytes are those of UTF-16 text, of an archive or of another format.
void refuse_foreign_content(const SourceFile& file);

// A file whose extension no reader has: named by its extension, else by its first bytes.
[[noreturn]] void refuse_extension(const SourceFile& file);

}  // namespace forcelayer::mesh
