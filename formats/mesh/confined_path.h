// Keeping files that a file names under the folder of the file that names them.
#pragma once

#include <filesystem>

namespace forcelayer {

// Whether `file` lies in `folder` or below, with "..", absolute paths and symbolic links followed
// to where they really lead. A file that does not exist counts as lying where it is named.
bool lies_under(const std::filesystem::path& file, const std::filesystem::path& folder);

inline constexpr const char* kOutsideWhat = "leads outside the folder of the file that names it";
inline constexpr const char* kOutsideMend =
    "move the file there, or add --allow-outside if you trust who wrote this";

}  // namespace forcelayer
