// What a picture shows, by name.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "formats/result.h"
#include "runtime/viewer/view_scene.h"

namespace forcelayer {

// What can be switched on and off.
enum class Shown : unsigned {
  kMeshes,
  kInterior,
  kForceLayer,
  kProximity,
  kPart,
  kShell,
  kContacts,
  kHandle,
};
inline constexpr std::array<std::string_view, 8> kShownNames = {
    "meshes", "interior", "force-layer", "proximity", "part", "shell", "contacts", "handle"};

class ShownSet {
 public:
  bool operator[](Shown what) const { return on_[static_cast<unsigned>(what)]; }
  void set(Shown what, bool on) { on_[static_cast<unsigned>(what)] = on; }
  void toggle(Shown what) { set(what, !(*this)[what]); }

 private:
  std::array<bool, kShownNames.size()> on_{};
};

// What is shown unless the user says otherwise: voxels' interior only where there is no mesh of the
// scene, shell points only where there is no mesh of the part; never proximity.
ShownSet default_shown(const ViewScene& scene);

// The same without what belongs to a moment: part, shell, contacts and handle.
ShownSet without_moment(ShownSet shown);

// Reads a list as "meshes,force-layer". Error: kUsage with the name that is unknown.
Result<ShownSet> parse_shown(std::string_view list);

}  // namespace forcelayer
