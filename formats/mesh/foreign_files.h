// Names the kind of a file that no reader here takes.
#pragma once

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// Both throw kMeshUnsupported with the name of the format and a way out.

// Where the first bytes are those of UTF-16 text, of an archive or of another format.
void refuse_foreign_content(const SourceFile& file);

// Where the content is that of another format that is read here than the extension says, for a file
// that its reader refused.
void refuse_wrong_extension(const SourceFile& file);

// A file whose extension no reader has: named by its extension, else by its first bytes.
[[noreturn]] void refuse_extension(const SourceFile& file);

}  // namespace forcelayer::mesh
