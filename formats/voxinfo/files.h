// A file that voxinfo was given: a scene or a part.
#pragma once

#include <string>
#include <variant>

#include "formats/pshell.h"
#include "formats/voxmap.h"

namespace forcelayer {

using BakedFile = std::variant<Voxmap, Pshell>;

// Opens `path` by what its first bytes say it is, and by its name where they say nothing.
Result<BakedFile> open_baked_file(const std::string& path, Verify verify);

}  // namespace forcelayer
