// Whether what a .vox says about its voxels is true: beyond what a reader trusts blindly for
// safety, what the runtime trusts for the guarantee.
#pragma once

#include <string_view>

#include "formats/voxmap.h"

namespace forcelayer {

// Proves from the voxels alone that the numbers of interior, surface and proximity voxels, the
// tight box, and every clearance (free and known as far as promised, voxmap_format.md 5) are true.
// Takes memory in proportion to the stored nodes and bricks; time grows with the number of free
// entries and, for scenes of very many directory entries, with how far their clearances reach.
// `name` is the file's, for errors.
Status audit_voxmap(const Voxmap& map, std::string_view name);

}  // namespace forcelayer
