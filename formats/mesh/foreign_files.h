// Names the kind of a file that no reader here takes.
#pragma once

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// Throws kMeshUnsupported with the name of the format and a way out where the first bytes are those
// of UTF-16 text, of an archive, of another format, or where the extension is that of another
// program's files.
void refuse_foreign_content(const SourceFile& file);
[[noreturn]] void refuse_extension(const SourceFile& file);

}  // namespace forcelayer::mesh
