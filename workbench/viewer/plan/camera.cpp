#include "workbench/viewer/plan/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

namespace forcelayer::viewer {
namespace {

constexpr double kMargin = 1.08;  // width of the picture over its contents

glm::dvec3 direction_of(double azimuth_deg, double elevation_deg) {
  const double a = glm::radians(azimuth_deg), e = glm::radians(elevation_deg);
  return {std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)};
}

VoxelValue value_at(const Voxmap& voxmap, const glm::dvec3& point_m) {
  const double s = voxmap.voxel_size_m();
  return voxmap.value(static_cast<std::int64_t>(std::floor(point_m.x / s)),
                      static_cast<std::int64_t>(std::floor(point_m.y / s)),
                      static_cast<std::int64_t>(std::floor(point_m.z / s)));
}

bool sees(const Voxmap& voxmap, const glm::dvec3& point_m, const glm::dvec3& direction,
          double reach_m) {
  const double step_m = voxmap.voxel_size_m();
  for (double along_m = step_m; along_m < reach_m; along_m += step_m) {
    if (value_at(voxmap, point_m + along_m * direction) == VoxelValue::kInterior) return false;
  }
  return true;
}

}  // namespace

glm::dvec3 default_direction() { return direction_of(-60, 28); }

CameraView camera_along(const glm::dvec3& direction) {
  CameraView view;
  view.to_eye = glm::normalize(direction);
  const glm::dvec3 sky =
      std::abs(view.to_eye.z) > 0.999 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
  view.up = glm::normalize(sky - glm::dot(sky, view.to_eye) * view.to_eye);
  return view;
}

Orbit turned(const Orbit& orbit, double about_z_rad, double rise_rad) {
  // To the right in the picture: level. Straight above or below, up tells which way that is.
  const glm::dvec3 right = glm::cross(orbit.up, orbit.to_eye);
  const double azimuth = std::atan2(right.y, right.x) + about_z_rad;
  const double height = std::asin(std::clamp(orbit.to_eye.z, -1.0, 1.0));
  const double rise =
      std::clamp(height + rise_rad, -0.5 * std::numbers::pi, 0.5 * std::numbers::pi);
  const glm::dvec3 level(std::cos(azimuth), std::sin(azimuth), 0), out(level.y, -level.x, 0);
  const glm::dvec3 to_eye = std::cos(rise) * out + glm::dvec3(0, 0, std::sin(rise));
  return {to_eye, glm::cross(to_eye, level)};
}

CameraView frame_box(const WorldBox& box, const glm::dvec3& direction, double aspect) {
  CameraView view = camera_along(direction);
  view.target_m = box.middle_m();
  const glm::dvec3 half = 0.5 * (box.high_m - box.low_m);
  const glm::dvec3 right = glm::cross(view.up, view.to_eye);
  const auto reach = [&](const glm::dvec3& axis) { return glm::dot(glm::abs(axis), half); };
  view.half_height_m = kMargin * std::max({reach(view.up), reach(right) / aspect, 1e-6});
  return view;
}

glm::dvec3 clearest_direction(const Voxmap& voxmap, const std::vector<glm::dvec3>& points_m,
                              const glm::dvec3& forces, double reach_m) {
  // Weights of the usual direction, of a view across the forces and of the usual height, in units
  // of the fraction of points seen.
  constexpr double kHabit = 0.25, kAcross = 0.3, kSteep = 0.2;
  const double length = glm::length(forces);
  const glm::dvec3 force = length > 0 ? forces / length : glm::dvec3(0);
  glm::dvec3 best = default_direction();
  double best_score = -1;
  for (const double elevation_deg : {28.0, 50.0, 12.0, 75.0, -15.0, -40.0}) {
    for (double azimuth_deg = -180; azimuth_deg < 180; azimuth_deg += 15) {
      const glm::dvec3 direction = direction_of(azimuth_deg, elevation_deg);
      const auto seen = std::count_if(
          points_m.begin(), points_m.end(),
          [&](const glm::dvec3& point) { return sees(voxmap, point, direction, reach_m); });
      const double fraction =
          points_m.empty() ? 0 : static_cast<double>(seen) / static_cast<double>(points_m.size());
      const double score = fraction +
                           kHabit * 0.5 * (1 + glm::dot(direction, default_direction())) -
                           kAcross * std::abs(glm::dot(direction, force)) -
                           kSteep * std::abs(direction.z - default_direction().z);
      if (score > best_score) {
        best_score = score;
        best = direction;
      }
    }
  }
  return best;
}

}  // namespace forcelayer::viewer
