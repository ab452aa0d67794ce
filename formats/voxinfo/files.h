// The file that voxinfo was given: a scene or a part.
#pragma once

#include <string>
#include <variant>

#include "formats/pshell.h"
#include "formats/voxmap.h"

namespace forcelayer::voxinfo {

using BakedFile = std::variant<Voxmap, Pshell>;

// Opens `path` as the format of its first bytes or, where they are of neither format, of its name.
Result<BakedFile> open_baked_file(const std::string& path, Verify verify);

}  // namespace forcelayer::voxinfo
