// STEP and IGES.
#include "formats/mesh/reader.h"

namespace forcelayer {

Assembly read_step(const SourceFile& file) {
  fail_read(file, ErrorCode::kMeshUnsupported, "", "this build does not read STEP or IGES",
            "export the assembly as glTF (.glb)");
}

}  // namespace forcelayer
