#include "runtime/viewer/shown.h"

#include <algorithm>

namespace forcelayer {

ShownSet default_shown(const ViewScene& scene) {
  ShownSet shown;
  shown.set(Shown::kMeshes, true);
  shown.set(Shown::kInterior, scene.meshes.empty() && !scene.before);
  shown.set(Shown::kForceLayer, true);
  shown.set(Shown::kPart, true);
  shown.set(Shown::kShell, !scene.part);
  shown.set(Shown::kContacts, true);
  shown.set(Shown::kHandle, true);
  return shown;
}

ShownSet without_moment(ShownSet shown) {
  for (const Shown what : {Shown::kPart, Shown::kShell, Shown::kContacts, Shown::kHandle}) {
    shown.set(what, false);
  }
  return shown;
}

Result<ShownSet> parse_shown(std::string_view list) {
  ShownSet shown;
  while (true) {
    const std::size_t comma = list.find(',');
    const std::string_view name = list.substr(0, comma);
    const auto found = std::find(kShownNames.begin(), kShownNames.end(), name);
    if (found == kShownNames.end()) {
      std::string names;
      for (const std::string_view known : kShownNames) {
        names += (names.empty() ? "" : ", ") + std::string(known);
      }
      return Error{ErrorCode::kUsage, "", "--show", "'" + std::string(name) + "' is not known",
                   "choose from " + names};
    }
    shown.set(static_cast<Shown>(found - kShownNames.begin()), true);
    if (comma == std::string_view::npos) return shown;
    list.remove_prefix(comma + 1);
  }
}

}  // namespace forcelayer
