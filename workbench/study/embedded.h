// Text files that are part of the program: CMake writes the function (view/embed.cmake).
#pragma once

#include <string>
#include <string_view>

namespace forcelayer::study {

// The content of a file of view/ by its name, such as "view.js"; "three.js" is the library and its
// additions. Empty for a file that was not there when this was built.
std::string embedded(std::string_view name);

}  // namespace forcelayer::study
