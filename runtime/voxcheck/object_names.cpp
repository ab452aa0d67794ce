#include "runtime/voxcheck/object_names.h"

#include <set>

#include "formats/command/spelling/spelling.h"
#include "formats/command/text.h"
#include "formats/command/verdict/verdict.h"

namespace forcelayer::voxcheck {
namespace {

// The whole of `text`. A star is tried shortest first; what was given up for an earlier star is not
// tried again for a later one, as in any glob.
bool fits_whole(std::string_view text, std::string_view pattern) {
  std::size_t t = 0, p = 0, star = std::string_view::npos, from = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      from = t;
    } else if (p < pattern.size() &&
               (pattern[p] == text[t] || (pattern[p] == '?' && text[t] != '/'))) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos && text[from] != '/') {
      p = star + 1;
      t = ++from;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

// As the file has it.
std::string stored_name(const Voxmap& scene, std::uint32_t object) {
  const std::string_view name = scene.object_name(object);
  return name.empty() ? "object " + std::to_string(object) : std::string(name);
}

}  // namespace

std::string object_name(const Voxmap& scene, std::uint32_t object) {
  if (object == 0) return "";
  std::string name = stored_name(scene, object);
  const std::string second = name + "[2]";
  for (std::uint32_t n = 1; n <= scene.header().object_count; ++n) {
    if (scene.object_name(n) == second) return name + "[1]";
  }
  return name;
}

std::vector<std::string> object_names(const Voxmap& scene) {
  std::vector<std::string> names;
  std::set<std::string_view> stored;
  for (std::uint32_t n = 1; n <= scene.header().object_count; ++n) {
    names.push_back(stored_name(scene, n));
    stored.insert(scene.object_name(n));
  }
  for (std::string& name : names) {
    if (stored.contains(name + "[2]")) name += "[1]";
  }
  return names;
}

std::string shown_name(const Voxmap& scene, std::uint32_t object) {
  return escaped(command::short_name(object_name(scene, object), object_names(scene)));
}

bool fits(std::string_view name, std::string_view pattern) {
  if (name == pattern) return true;
  while (true) {
    if (fits_whole(name, pattern)) return true;
    const std::size_t slash = name.find('/');
    if (slash == std::string_view::npos) return false;
    name.remove_prefix(slash + 1);
  }
}

Result<clearance::LeftOut> named_objects(const Voxmap& scene,
                                         std::span<const std::string> patterns) {
  const std::uint32_t objects = scene.header().object_count;
  clearance::LeftOut chosen(objects + 1, 0);
  const auto choose = [&](const std::string& pattern) {
    bool any = false;
    for (std::uint32_t object = 1; object <= objects; ++object) {
      if (!fits(stored_name(scene, object), pattern)) continue;
      chosen[object] = 1;
      any = true;
    }
    return any;
  };
  for (const std::string& pattern : patterns) {
    const auto meanings = command::meanings_of(pattern);
    if (std::any_of(meanings.begin(), meanings.end(), choose)) continue;
    command::NearestNames nearest(pattern);
    for (std::uint32_t object = 1; object <= objects; ++object) {
      nearest.add(object_name(scene, object));
    }
    return Error{ErrorCode::kUsage, "", "--allow",
                 "'" + pattern + "' is not an object of the scene",
                 nearest.text("voxinfo SCENE.vox --objects lists all")};
  }
  return chosen;
}

}  // namespace forcelayer::voxcheck
