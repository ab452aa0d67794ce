// The items of a picture, by name.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "formats/result.h"
#include "workbench/viewer/plan/view_scene.h"

namespace forcelayer::viewer {

// Items that can be switched on and off.
enum class Item : unsigned {
  kMeshes,
  kInterior,
  kForceLayer,
  kProximity,
  kPart,
  kShell,
  kContacts,
  kHandle,
};
inline constexpr std::array<std::string_view, 8> kItemNames = {
    "meshes", "interior", "force-layer", "proximity", "part", "shell", "contacts", "handle"};

class ItemSet {
 public:
  bool operator[](Item what) const { return on_[static_cast<unsigned>(what)]; }
  void set(Item what, bool on) { on_[static_cast<unsigned>(what)] = on; }
  void toggle(Item what) { set(what, !(*this)[what]); }

 private:
  std::array<bool, kItemNames.size()> on_{};
};

// The items that are shown by default. Interior voxels only without a mesh of the scene, shell
// points only without a mesh of the part, proximity never.
ItemSet default_items(const ViewScene& scene);

// `shown` without the items of a moment: part, shell, contacts and handle.
ItemSet without_moment(ItemSet shown);

// Reads a list as "meshes,force-layer". Error: kUsage with the name that is unknown.
Result<ItemSet> parse_items(std::string_view list);

}  // namespace forcelayer::viewer
