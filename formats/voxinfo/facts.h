// The facts that a baked file states about itself, for people and for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "formats/voxinfo/files.h"

namespace forcelayer::voxinfo {

// The facts under the names of the other commands' reports.
nlohmann::ordered_json report_of(const BakedFile& file);

// The same in a few lines of text.
std::string summary_of(const BakedFile& file, const std::string& path);

}  // namespace forcelayer::voxinfo
