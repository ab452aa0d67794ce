#include "workbench/viewer/plan/arrows.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::viewer {
namespace {

// The largest of 1, 2 and 5 times a power of ten that is not more.
double round_down(double largest) {
  const double power = std::pow(10, std::floor(std::log10(largest)));
  return (largest / power >= 5 ? 5 : largest / power >= 2 ? 2 : 1) * power;
}

}  // namespace

Arrows arrows_of(const ViewScene& scene, const ContactView& contacts) {
  Arrows arrows;
  const std::vector<ViewPoint>& points = contacts.points;
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (points[n].depth_m > 0 && points[n].value != VoxelValue::kInterior) {
      arrows.points.push_back(n);
    }
  }
  std::stable_sort(arrows.points.begin(), arrows.points.end(), [&](std::size_t a, std::size_t b) {
    return points[a].depth_m > points[b].depth_m;
  });
  const std::size_t drawn = std::min(arrows.points.size(), kMaxArrows);
  arrows.left_out = arrows.points.size() - drawn;
  arrows.points.resize(drawn);
  if (!scene.voxmap || !scene.shell) return arrows;
  const VoxmapHeader& header = scene.voxmap->header();
  const double radius_m = scene.shell->header().bounding_radius_m;
  const double depth_m = header.force_depth_m > 0 ? header.force_depth_m : header.voxel_size_m;
  arrows.per_depth = round_down(0.5 * radius_m / (0.1 * depth_m));
  if (drawn == 0) return arrows;
  const double deepest_m = points[arrows.points.front()].depth_m;
  arrows.per_depth = std::min(arrows.per_depth, round_down(radius_m / deepest_m));
  return arrows;
}

}  // namespace forcelayer::viewer
