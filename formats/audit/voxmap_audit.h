// Proof that the facts that a .vox states about its voxels are true. Opening a file checks what
// memory safety needs; the audit checks what the separation guarantee needs. `voxinfo verify` and
// opening for a run (runtime/run/baked_files.h) ask for it.
#pragma once

#include <string_view>

#include "formats/voxmap.h"

namespace forcelayer {

// Proves from the file alone that the numbers of interior, surface and proximity voxels, the tight
// box, and every clearance (voxmap_format.md, section 5) are true; that surface and proximity are
// the layers around the interior (section 10), so that no wall has a hole; that codes of distances
// are possible beside the values and beside each other (section 13.2), and zero_force_m beside the
// layers; and that no object is above object_count. Memory is proportional to the stored nodes and
// bricks. Time grows with the neighborhoods of nodes and the pairs of bricks that differ from each
// other; a clearance that its neighborhood does not show is looked at by itself. `name` is the
// file's, for errors.
Status audit_voxmap(const Voxmap& map, std::string_view name);

}  // namespace forcelayer
