// Options that earlier versions had, and how each is written now.
#pragma once

#include <string_view>

namespace forcelayer::command {

// "--set mass_kg=VALUE" for "--mass" of voxrun; empty for what `command` never had.
std::string_view new_spelling(std::string_view command, std::string_view option);

}  // namespace forcelayer::command
