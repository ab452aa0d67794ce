// Facts in the text of an IGES file that OpenCASCADE does not keep.
#pragma once

#include <map>
#include <string_view>

namespace forcelayer::mesh {

// The transformation matrices that entries of the directory name (field 7), by entry: OpenCASCADE
// forgets one that is not there.
std::map<int, int> iges_matrix_entries(std::string_view text);

}  // namespace forcelayer::mesh
