// Reads the provenance of a baked file for its user. It is text from the file: no promise.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace forcelayer::command {

// How many faces the bake was told to do without (--missing-faces); 0 where the text, the JSON that
// voxelize and pointshell write, does not say.
std::uint64_t missing_faces_in(std::string_view provenance);

// "2 faces are missing from it, and no guarantee covers them"; empty where none is missing.
std::string missing_faces_text(std::string_view provenance);

}  // namespace forcelayer::command
