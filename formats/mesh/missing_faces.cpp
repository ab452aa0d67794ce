#include "formats/mesh/missing_faces.h"

#include <nlohmann/json.hpp>

namespace forcelayer::mesh {

nlohmann::ordered_json json_of(std::span<const MissingFace> faces) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const MissingFace& face : faces) {
    const auto center = face.size > 0 ? nlohmann::ordered_json(face.center) : nullptr;
    json.push_back({{"node", face.node}, {"center_m", center}, {"size_m", face.size}});
  }
  return json;
}

}  // namespace forcelayer::mesh
