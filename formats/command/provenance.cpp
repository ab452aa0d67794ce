#include "formats/command/provenance.h"

#include <nlohmann/json.hpp>

namespace forcelayer::command {

std::uint64_t missing_faces_in(std::string_view provenance) {
  constexpr int kMaxDepth = 32;
  const auto limit_depth = [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    return depth <= kMaxDepth;
  };
  const nlohmann::json json = nlohmann::json::parse(provenance, limit_depth, false);
  if (!json.is_object()) return 0;
  const auto faces = json.find("missing_faces");
  return faces != json.end() && faces->is_array() ? faces->size() : 0;
}

std::string missing_faces_text(std::string_view provenance) {
  const std::uint64_t count = missing_faces_in(provenance);
  if (count == 0) return "";
  return std::to_string(count) + (count == 1 ? " face is" : " faces are") +
         " missing from it, and no guarantee covers " + (count == 1 ? "it" : "them");
}

}  // namespace forcelayer::command
