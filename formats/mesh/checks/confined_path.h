// Confining the files that a file names to its own folder.
#pragma once

#include <filesystem>

namespace forcelayer::mesh {

// Whether `file` lies in `folder` or below, after following "..", absolute paths and symbolic
// links. A file that does not exist lies where its path says.
bool lies_under(const std::filesystem::path& file, const std::filesystem::path& folder);

inline constexpr const char* kOutsideWhat = "lies outside the folder of the referring file";
inline constexpr const char* kOutsideMend =
    "move the named file into that folder, or add --allow-outside if you trust the referring file";

}  // namespace forcelayer::mesh
