// Numbers of an IGES file that are none.
#pragma once

#include <set>
#include <string_view>

namespace forcelayer::mesh {

// The entries in the directory (1, 3, 5, ...) of curves, surfaces and placings with a parameter
// that is neither empty nor a number: OpenCASCADE takes it for 0 without an error. `text` is the
// whole file; one that is binary or compressed has none.
std::set<int> iges_entries_without_numbers(std::string_view text);

}  // namespace forcelayer::mesh
