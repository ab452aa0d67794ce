#include "runtime/voxcheck/words.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/command/text.h"
#include "runtime/voxcheck/object_names.h"

namespace forcelayer::voxcheck {
namespace {

using clearance::CheckedMoment;
using command::text;
using Json = nlohmann::ordered_json;

constexpr std::size_t kListed = 5;

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace

double floor_mm(double length_m) { return std::floor(length_m * 1e6) / 1e3; }
double ceil_mm(double length_m) { return std::ceil(length_m * 1e6) / 1e3; }

std::string to_object(const Voxmap& scene, std::uint32_t object) {
  return object == 0 ? "" : " to " + escaped(object_name(scene, object));
}

std::string listed_names(const Voxmap& scene, std::span<const std::uint32_t> objects) {
  std::string line;
  for (std::size_t n = 0; n < objects.size(); ++n) {
    if (n == kListed) return line + text(" and %zu more", objects.size() - kListed);
    line += (n == 0 ? "" : ", ") + escaped(object_name(scene, objects[n]));
  }
  return line;
}

bool is_never_near(const clearance::CheckResult& result, const Pshell& part,
                   std::span<const std::string> allow) {
  return result.clear() && result.at_least && result.seated.empty() && allow.empty() &&
         result.clearance_m > 2 * part.header().bounding_radius_m;
}

std::string never_near_text(const char* given) {
  return text("the part is never near the scene: is it the part and the %s of this scene?", given);
}

std::string place_text(const CheckedMoment& moment) {
  // A coordinate that would be printed as -0 is printed as 0.
  const auto near_zero = [](double m) { return std::abs(m) < 5e-8 ? 0.0 : m; };
  return text("at %.3f s, at %.4g, %.4g, %.4g m", moment.time_s, near_zero(moment.point_m.x),
              near_zero(moment.point_m.y), near_zero(moment.point_m.z));
}

std::string max_text(const CheckedMoment& moment) {
  if (!std::isfinite(moment.max_m)) return "";
  return text(", at most %.3f mm", ceil_mm(moment.max_m));
}

std::string seat_way_text(const Voxmap& scene, const clearance::CheckResult& result,
                          std::size_t stretch, std::optional<double> exact_m) {
  const clearance::SeatedStretch& seated = result.seated[stretch];
  return text("  in its seat for %.1f mm of a path of %.1f mm: least clearance there ",
              1e3 * seated.way_m, 1e3 * result.way_m) +
         (exact_m
              ? text("%.3f mm exact", 1e3 * *exact_m)
              : text("%.3f mm proven", floor_mm(seated.clearance_m)) + max_text(seated.nearest)) +
         to_object(scene, seated.nearest.object) + text(", at %.3f s\n", seated.nearest.time_s);
}

double hidden_within_m(const Voxmap& scene, const clearance::CheckResult& result,
                       std::span<const std::string> allow) {
  constexpr double kHiddenVoxels = 3;
  const bool some_do_not_count = !allow.empty() || !result.seated.empty();
  const bool are_others = scene.header().object_count > 1;
  return some_do_not_count && are_others ? kHiddenVoxels * scene.voxel_size_m() : 0;
}

std::string hidden_text(double within_m) {
  if (within_m == 0) return "";
  return text(
      "  objects that do not count may hide others within %.4g mm of them; --exact sees these\n",
      1e3 * within_m);
}

Json moment_json(const Voxmap& scene, const CheckedMoment& moment, double clearance_m) {
  Json json;
  json["clearance_m"] = clearance_m;
  json["t_s"] = moment.time_s;
  json["object"] = moment.object == 0 ? Json(nullptr) : Json(object_name(scene, moment.object));
  json["point_m"] = {moment.point_m.x, moment.point_m.y, moment.point_m.z};
  json["at_most_m"] = finite(moment.max_m);
  json["slack_m"] = finite(std::max(0.0, moment.max_m - clearance_m));
  return json;
}

Json seated_json(const Voxmap& scene, const clearance::SeatedStretch& stretch) {
  Json json{{"from_s", stretch.from_s}, {"to_s", stretch.to_s}, {"way_m", stretch.way_m}};
  json.update(moment_json(scene, stretch.nearest, stretch.clearance_m));
  return json;
}

}  // namespace forcelayer::voxcheck
