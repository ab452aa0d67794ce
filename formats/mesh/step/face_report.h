// The lines about the faces of a STEP or IGES file that were not tessellated as they are.
#pragma once

#include <string>
#include <vector>

#include "formats/mesh/reader.h"
#include "formats/mesh/step/tessellator.h"

namespace forcelayer::mesh {

// Appends what was dropped, mended or tessellated otherwise at the node of this path.
void add_face_warnings(const Tessellation& tessellation, const std::string& path,
                       std::vector<std::string>& warnings);

// Warns of every missing face of `assembly`, whose unit is the millimeter. Throws kMeshIncomplete,
// with node and place of the first ones, where they are more than the options accept.
// `unknown_nodes`: the names of ReadOptions::without that no node has.
void check_missing_faces(const SourceFile& file, const std::vector<std::string>& unknown_nodes,
                         Assembly& assembly);

}  // namespace forcelayer::mesh
