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
// - Codes are possible beside the values (13.2) and beside each other (13.5), and zero_force_m is
//   possible beside the layers. Without distances the interior is wide enough for the layers
//   (13.6).
// - No brick names an object above object_count.
// Memory is proportional to the file, and time is bounded by its size (effort.h): a file whose
// proof takes far more than that of a bake is refused: kEntryInvalid. `name` is the file's, for
// errors.
Status audit_voxmap(const Voxmap& map, std::string_view name);

}  // namespace forcelayer
