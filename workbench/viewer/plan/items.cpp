#include "workbench/viewer/plan/items.h"

#include <algorithm>

namespace forcelayer::viewer {

ItemSet default_items(const ViewScene& scene) {
  ItemSet shown;
  shown.set(Item::kMeshes, true);
  shown.set(Item::kInterior, scene.meshes.empty() && !scene.before);
  shown.set(Item::kForceLayer, true);
  shown.set(Item::kPart, true);
  shown.set(Item::kShell, !scene.part);
  shown.set(Item::kContacts, true);
  shown.set(Item::kHandle, true);
  return shown;
}

ItemSet without_moment(ItemSet shown) {
  for (const Item what : {Item::kPart, Item::kShell, Item::kContacts, Item::kHandle}) {
    shown.set(what, false);
  }
  return shown;
}

Result<ItemSet> parse_items(std::string_view list) {
  ItemSet shown;
  while (true) {
    const std::size_t comma = list.find(',');
    const std::string_view name = list.substr(0, comma);
    const auto found = std::find(kItemNames.begin(), kItemNames.end(), name);
    if (found == kItemNames.end()) {
      std::string names;
      for (const std::string_view known : kItemNames) {
        names += (names.empty() ? "" : ", ") + std::string(known);
      }
      return Error{ErrorCode::kUsage, "", "--show", "'" + std::string(name) + "' is not known",
                   "choose from " + names};
    }
    shown.set(static_cast<Item>(found - kItemNames.begin()), true);
    if (comma == std::string_view::npos) return shown;
    list.remove_prefix(comma + 1);
  }
}

}  // namespace forcelayer::viewer
