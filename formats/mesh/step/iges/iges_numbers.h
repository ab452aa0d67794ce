// Facts in the text of an IGES file that OpenCASCADE does not keep.
#pragma once

#include <map>
#include <set>
#include <string_view>

namespace forcelayer::mesh {

// The entries in the directory (1, 3, 5, ...) of curves, surfaces and placings with a parameter
// that is neither empty nor a number: OpenCASCADE takes it for 0 without an error. `text` is the
// whole file; one that is binary or compressed has none.
std::set<int> iges_entries_without_numbers(std::string_view text);

// The transformation matrices that entries of the directory name (field 7), by entry: OpenCASCADE
// forgets one that is not there.
std::map<int, int> iges_matrix_entries(std::string_view text);

}  // namespace forcelayer::mesh
