#include "runtime/voxcheck/words.h"

#include <algorithm>
#include <cmath>

#include "formats/command/text.h"
#include "runtime/voxcheck/object_names.h"

namespace forcelayer::voxcheck {
namespace {

using command::text;

constexpr std::size_t kListed = 5;

}  // namespace

double ceil_mm(double length_m) { return std::ceil(length_m * 1e6) / 1e3; }

std::string to_object(const Voxmap& scene, std::uint32_t object) {
  return object == 0 ? "" : " to " + shown_name(scene, object);
}

std::string listed_names(const Voxmap& scene, std::span<const std::uint32_t> objects) {
  std::string line;
  for (std::size_t n = 0; n < objects.size(); ++n) {
    if (n == kListed) return line + text(" and %zu more", objects.size() - kListed);
    line += (n == 0 ? "" : ", ") + shown_name(scene, objects[n]);
  }
  return line;
}

bool is_never_near(const clearance::CheckResult& result, const Pshell& part,
                   std::span<const std::string> allow) {
  return result.clear() && result.at_least && result.seated.empty() && allow.empty() &&
         result.clearance_m > 2 * part.header().bounding_radius_m;
}

std::string never_near_text(const char* given) {
  return text("the part is never near the scene: check that part and %s belong to this scene",
              given);
}

double hidden_within_m(const Voxmap& scene, const clearance::CheckResult& result,
                       std::span<const std::string> allow) {
  constexpr double kHiddenVoxels = 3;
  const bool some_do_not_count = !allow.empty() || !result.seated.empty();
  const bool are_others = scene.header().object_count > 1;
  return some_do_not_count && are_others ? kHiddenVoxels * scene.voxel_size_m() : 0;
}

std::string hidden_text(double within_m) {
  return text(
      "not checked: hidden objects less than %.4g mm behind an object of the seat or of --allow",
      1e3 * within_m);
}

}  // namespace forcelayer::voxcheck
