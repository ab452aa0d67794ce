// Stands in for read_step.cpp in a build without OpenCASCADE.
#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

Assembly read_step(const SourceFile& file) {
  fail_read(file, ErrorCode::kMeshUnsupported, "", "built without STEP and IGES",
            "export the assembly as glTF (.glb), or configure with -DFORCELAYER_STEP=ON");
}

}  // namespace forcelayer::mesh
