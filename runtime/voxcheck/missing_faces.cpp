#include "runtime/voxcheck/missing_faces.h"

#include <string_view>

#include "formats/command/provenance.h"
#include "formats/command/report.h"

namespace forcelayer::voxcheck {

std::uint64_t missing_faces(const Voxmap& scene, const Pshell& part) {
  return command::missing_faces_in(scene.provenance()) +
         command::missing_faces_in(part.provenance());
}

void warn_of_missing_faces(const std::string& scene_path, const Voxmap& scene,
                           const std::string& part_path, const Pshell& part, bool quiet) {
  const auto warn_of = [&](const std::string& path, std::string_view provenance) {
    const std::string text = command::missing_faces_text(provenance);
    if (!text.empty()) command::warn(path + ": " + text, quiet);
  };
  warn_of(scene_path, scene.provenance());
  warn_of(part_path, part.provenance());
}

}  // namespace forcelayer::voxcheck
