// Opening a scene and a part for a loop.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"

namespace forcelayer {

// Reads a file into memory and checks everything there, section checksums too: what a disk or a
// network turned over must not be felt. The run uses the bytes that were checked and never looks at
// the file again. A file that is cut short or written to while it is read is an error here, before
// a motor has a force; later it does nothing to the run.
//
// The facts that the step trusts are proven too (formats/audit/voxmap_audit.h): a false clearance
// under right checksums would let the part through a wall. Where `expected` has digests
// (formats/digest/file_digest.h), a file with another is not looked into.
Result<Voxmap> open_scene(const std::filesystem::path& path,
                          std::span<const std::string> expected = {});
Result<Pshell> open_part(const std::filesystem::path& path,
                         std::span<const std::string> expected = {});

}  // namespace forcelayer
