// Proof that the facts that a .vox states about its voxels are true. Opening a file checks what
// memory safety needs; the audit checks what the separation guarantee needs.
#pragma once

#include <string_view>

#include "formats/voxmap.h"

namespace forcelayer {

// Proves from the voxels alone that the numbers of interior, surface and proximity voxels, the
// tight box, and every clearance (voxmap_format.md, section 5) are true. Memory is proportional to
// the stored nodes and bricks. Time grows with the number of free entries and, in scenes of very
// many directory cells, with the reach of their clearances. `name` is the file's, for errors.
Status audit_voxmap(const Voxmap& map, std::string_view name);

}  // namespace forcelayer
