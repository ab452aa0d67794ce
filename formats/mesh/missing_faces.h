// Missing faces as JSON: in the reports of the bakes and in the provenance of the baked files.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "formats/mesh/mesh.h"

namespace forcelayer::mesh {

// An array of {"node", "center_m", "size_m"}. The faces are in meters, in a frame of the caller's.
nlohmann::ordered_json json_of(std::span<const MissingFace> faces);

}  // namespace forcelayer::mesh
