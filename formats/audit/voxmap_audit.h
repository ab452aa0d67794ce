// The audit: proves that the facts that a .vox states about its voxels are true. Opening a file
// checks what memory safety needs; the audit checks what the separation guarantee needs. `voxinfo
// verify` calls it, and so does opening for a run (runtime/run/baked_files.h).
#pragma once

#include <string_view>

#include "formats/voxmap.h"

namespace forcelayer {

// Proves from the file alone (sections of voxmap_format.md):
// - The numbers of interior, surface and proximity voxels and the tight box are true.
// - Every clearance is true (section 5).
// - Surface and proximity are the layers around the interior (section 10), so no wall has a hole.
// - Codes are possible beside the values and beside each other (section 13.2), and zero_force_m is
//   possible beside the layers.
// - No brick names an object above object_count.
// Memory and time are proportional to the file: to the stored nodes and bricks, and to the number
// of different neighborhoods of nodes and of different pairs of bricks. Neighborhoods and pairs
// that are far more than a bake of the file's size has (few nodes or bricks, strewn) are not looked
// at to the end, and the file is refused: kEntryInvalid. `name` is the file's, for errors.
Status audit_voxmap(const Voxmap& map, std::string_view name);

}  // namespace forcelayer
