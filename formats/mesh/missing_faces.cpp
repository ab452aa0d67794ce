#include "formats/mesh/missing_faces.h"

#include <nlohmann/json.hpp>

namespace forcelayer::mesh {

nlohmann::ordered_json json_of(std::span<const MissingFace> faces) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const MissingFace& face : faces) {
    json.push_back({{"node", face.node}, {"center_m", face.center}, {"size_m", face.size}});
  }
  return json;
}

}  // namespace forcelayer::mesh
