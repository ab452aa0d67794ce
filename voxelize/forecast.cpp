#include "voxelize/forecast.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "formats/mesh/units.h"
#include "voxelize/size_text.h"

namespace forcelayer::voxelize {
namespace {

// Bytes at the peak, and seconds of one thread, per face of a voxel on the surface: from bakes of
// sample_data/gearbox.glb at 0.1 and 0.05 mm and of an engine at 0.5 and 0.25 mm, which took 8 to
// 15 bytes for the values and 22 to 28 with distances. The least is less than half of the smallest
// of these.
struct Cost {
  double min_bytes, bytes, thread_s;
};

Cost cost_of(const BakeOptions& options) {
  if (stores_distances(options)) return {6, 32, 2e-6};
  if (options.metric == Metric::kEuclidean) return {3, 12, 8e-7};
  return {3, 10, 5e-7};
}

// Per triangle, from bakes of an aircraft bay of 0.15 to 10.5 million.
constexpr double kBytesPerTriangle = 30, kThreadSecondsPerTriangle = 5e-7;

bool touches(const mesh::Box& box, const std::optional<std::array<double, 6>>& roi_m) {
  if (!roi_m) return true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (box.high[axis] < (*roi_m)[axis] || box.low[axis] > (*roi_m)[axis + 3]) return false;
  }
  return true;
}

// "the scene is 745 m across"
std::string across_text(const char* what, const mesh::Box& box_m) {
  char text[80];
  std::snprintf(text, sizeof text, "%s is %.4g m across", what, longest_side(box_m));
  return text;
}

// `voxel_size_m` would do.
std::string mend_of(const Forecast& forecast, double voxel_size_m) {
  char text[160];
  std::snprintf(text, sizeof text, "use --voxel-size %.2gm or more, or --roi", voxel_size_m);
  const auto question = unit_question("the scene", forecast.box_m, forecast.largest_unit_m);
  return question ? *question + "; otherwise " + text
                  : across_text("the scene", forecast.box_m) + "; " + text;
}

}  // namespace

std::optional<std::string> unit_question(const char* what, const mesh::Box& box_m,
                                         double largest_unit_m) {
  constexpr double kLongestMadeThing = 50, kMeter = 0.9;
  if (!(longest_side(box_m) >= kLongestMadeThing && largest_unit_m >= kMeter)) return std::nullopt;
  return across_text(what, box_m) + "; if the unit of the files is the millimeter, add --units mm";
}

Forecast forecast_of(const mesh::Scene& scene, std::span<const cache::MeshOutline> meshes,
                     const BakeOptions& options) {
  Forecast forecast;
  forecast.box_m = mesh::empty_box();
  double area_m2 = 0, min_area_m2 = 0, triangles = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const mesh::MeshObject& object = scene.objects[i];
    mesh::extend(forecast.box_m, object.box_m);
    const double stretch_m = mesh::largest_stretch(object.world_from_mesh);
    forecast.largest_unit_m = std::max(forecast.largest_unit_m, stretch_m);
    if (!touches(object.box_m, options.roi_m)) continue;
    const mesh::AreaFactors factors = mesh::area_factors(object.world_from_mesh);
    area_m2 += meshes[i].area * factors.mean;
    min_area_m2 += meshes[i].area * factors.smallest;
    triangles += static_cast<double>(meshes[i].triangle_count);
  }
  forecast.surface_voxels = area_m2 / (options.voxel_size_m * options.voxel_size_m);
  const Cost cost = cost_of(options);
  forecast.min_memory_bytes =
      cost.min_bytes * min_area_m2 / (options.voxel_size_m * options.voxel_size_m);
  forecast.memory_bytes = cost.bytes * forecast.surface_voxels + kBytesPerTriangle * triangles;
  forecast.bake_s =
      (cost.thread_s * forecast.surface_voxels + kThreadSecondsPerTriangle * triangles) /
      std::max(1, options.threads);
  return forecast;
}

Status check_forecast(const Forecast& forecast, const BakeOptions& options,
                      double available_bytes) {
  if (forecast.min_memory_bytes <= available_bytes) return {};
  char what[160];
  std::snprintf(
      what, sizeof what,
      "at %g mm the scene takes at least %.3g GB of memory, but this process can have %.3g GB",
      options.voxel_size_m * 1e3, forecast.min_memory_bytes * 1e-9, available_bytes * 1e-9);
  const double larger = std::sqrt(forecast.memory_bytes / available_bytes);
  return Error{ErrorCode::kBakeTooLarge, "", "", what,
               mend_of(forecast, larger * options.voxel_size_m)};
}

std::optional<std::string> forecast_warning(const Forecast& forecast, const BakeOptions& options) {
  constexpr double kLongS = 60, kLargeBytes = 1e9;
  const double over = std::max(forecast.bake_s / kLongS, forecast.memory_bytes / kLargeBytes);
  if (!(over > 1)) return std::nullopt;
  char text[160];
  std::snprintf(text, sizeof text,
                "this bake may take %.2g min and %.2g GB of memory%s: ", forecast.bake_s / 60,
                forecast.memory_bytes * 1e-9,
                options.cache == nullptr ? "" : " for the objects that are not in the cache");
  return text + mend_of(forecast, std::sqrt(over) * options.voxel_size_m);
}

}  // namespace forcelayer::voxelize
