#include "voxelize/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "formats/guard.h"
#include "voxelize/stopwatch.h"

namespace forcelayer::voxelize {
namespace {

// Voxels across the scene in the finer of the two bakes. It takes a fraction of a second, and
// surfaces outweigh the fixed part of the file.
constexpr double kProbeVoxels = 512;
constexpr int kProbeBakes = 3;  // of each size

// Points per s^2 of surface of a shell with the default covering radius of sqrt(3)/2 s: 1.15 times
// the planar bound of 2 / (3 sqrt(3) rho^2).
constexpr double kShellPointsPerVoxelFace = 0.59;

struct Probe {
  double voxel_size_m = 0, file_bytes = 0, bake_s = 0;
};

double longest_side_m(std::span<const SceneObject> objects) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  mesh::Vec3d low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
  for (const SceneObject& object : objects) {
    for (const mesh::Vec3d& vertex : object.mesh->vertices) {
      const mesh::Vec3d world = mesh::apply(object.world_from_mesh, vertex);
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], world[d]);
        high[d] = std::max(high[d], world[d]);
      }
    }
  }
  double longest = 0;
  for (std::size_t d = 0; d < 3; ++d) longest = std::max(longest, high[d] - low[d]);
  return longest;
}

// Bakes without free seeds: one may lie in geometry at the coarse size, and seeds change file size
// and time little.
Result<Probe> probe(std::span<const SceneObject> objects, BakeOptions options,
                    double voxel_size_m) {
  std::vector<SceneObject> unseeded(objects.begin(), objects.end());
  for (SceneObject& object : unseeded) object.free_seeds_m.clear();
  options.free_seeds_m.clear();
  options.progress = nullptr;
  const double ratio = voxel_size_m / options.voxel_size_m;
  options.range_m *= ratio;  // as many voxels
  options.standoff_m *= ratio;
  options.voxel_size_m = voxel_size_m;
  if (options.standoff_m > 0) {  // a compliance keeps its depth, whatever the voxel size
    options.standoff_m = std::clamp(
        options.standoff_m, (force_layer_voxels(options) + kMinInteriorVoxels) * voxel_size_m,
        kMaxStandoffVoxels * voxel_size_m);
  }
  Probe result;
  result.voxel_size_m = voxel_size_m;
  result.bake_s = std::numeric_limits<double>::infinity();
  // The minimum of some bakes. The first one also starts threads and takes memory. And a scene of
  // many small triangles takes hardly longer at the finer size, so a little noise would make the
  // time fall with finer voxels.
  for (int n = 0; n < kProbeBakes; ++n) {
    const Stopwatch watch;
    const auto baked = bake(unseeded, options);
    if (!baked) return baked.error();
    result.file_bytes = static_cast<double>(voxmap_bytes(baked->content({})).size());
    result.bake_s = std::min(result.bake_s, watch.total_s());
  }
  return result;
}

// The curve a x^p + b x^q, a and b not negative, through two points.
struct Curve {
  double x0, y0, x1, y1, p, q;
  double at(double x) const {
    const double xp0 = std::pow(x0, p), xq0 = std::pow(x0, q), xp1 = std::pow(x1, p),
                 xq1 = std::pow(x1, q);
    const double a = (y1 * xq0 - y0 * xq1) / (xp1 * xq0 - xp0 * xq1);
    const double b = (y0 - a * xp0) / xq0;
    if (a < 0) return y1 / xq1 * std::pow(x, q);
    if (b < 0) return y1 / xp1 * std::pow(x, p);
    return a * std::pow(x, p) + b * std::pow(x, q);
  }
};

// Where the force begins; with Chebyshev layers along an axis, where it begins lowest.
double standoff_voxels(const BakeOptions& options) {
  if (stores_distances(options)) {
    return interior_radius_voxels(options) + force_layer_voxels(options);
  }
  if (!grows_surface(options)) return options.layers;
  return interior_radius_voxels(options) + std::sqrt(3.0) / 2;
}

double narrowest_gap_voxels(const BakeOptions& options) {
  // Wherever the walls lie on the lattice, some voxel's center is up to half a voxel from the
  // middle and still where the force begins. In a lean file three voxels lie between the two walls'
  // interiors, and in the middle of the middle one phi is 1/2 (runtime/field/level_field.h).
  if (grows_surface(options)) {
    return 2 * (interior_radius_voxels(options) + force_layer_voxels(options)) + 1;
  }
  return 2 * standoff_voxels(options) + 2;
}

std::string length_text(double length_m) {
  if (!(length_m > 0)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.4g mm", length_m * 1e3);
  return text;
}

}  // namespace

Result<Plan> plan_bakes(std::span<const SceneObject> objects, const BakeOptions& options) {
  if (Status checked = check_options(options); !checked) return checked.error();
  Plan plan;
  const double fine =
      std::clamp(longest_side_m(objects) / kProbeVoxels, kMinVoxelSizeM, kMaxVoxelSizeM / 2);
  plan.probe_sizes_m = {2 * fine, fine};
  const auto coarse = probe(objects, options, plan.probe_sizes_m[0]);
  if (!coarse) return coarse.error();
  const auto finer = probe(objects, options, plan.probe_sizes_m[1]);
  if (!finer) return finer.error();

  // In 1/s: surfaces grow with its square, edges and rods with itself, triangles not at all.
  const double x0 = 1 / coarse->voxel_size_m, x1 = 1 / finer->voxel_size_m;
  const Curve bytes{x0, coarse->file_bytes, x1, finer->file_bytes, 2, 1};
  const Curve seconds{x0, coarse->bake_s, x1, finer->bake_s, 2, 0};
  for (std::size_t i = 0; i < plan.sizes.size(); ++i) {
    PlannedSize& size = plan.sizes[i];
    const double s = options.voxel_size_m / static_cast<double>(1u << i);
    size.voxel_size_m = s;
    BakeOptions sized = options;
    sized.voxel_size_m = s;
    size.possible = static_cast<bool>(check_options(sized));
    if (size.possible) {
      size.standoff_m = standoff_voxels(sized) * s;
      size.narrowest_gap_m = narrowest_gap_voxels(sized) * s;
      const VoxmapHeader lengths = header_lengths(sized);
      size.passed_gap_m = passed_gap_m(lengths);
      size.guaranteed_separation_m = usual_separation_m(lengths);
    }
    size.shell_points_per_m2 = kShellPointsPerVoxelFace / (s * s);
    size.file_bytes = bytes.at(1 / s);
    size.bake_s = seconds.at(1 / s);
    if (Status fits = check_size(objects, sized); !fits && size.possible) {
      size.fits = false;
      if (plan.too_large.empty()) plan.too_large = to_line(fits.error());
    }
  }
  return plan;
}

std::string table_of(const Plan& plan) {
  char line[200];
  std::snprintf(line, sizeof line, "%10s %10s %10s %10s %10s %18s %10s %10s\n", "voxel", "standoff",
                "gap", "passed", "proven", "shell points/dm2", "file", "bake");
  std::string table = line;
  for (const PlannedSize& size : plan.sizes) {
    const std::string proven =
        size.guaranteed_separation_m > 0 ? length_text(size.guaranteed_separation_m) : "none";
    std::snprintf(line, sizeof line, "%10s %10s %10s %10s %10s %18.0f %7.3g MB %8.2g s%s%s\n",
                  length_text(size.voxel_size_m).c_str(), length_text(size.standoff_m).c_str(),
                  length_text(size.narrowest_gap_m).c_str(), length_text(size.passed_gap_m).c_str(),
                  size.possible ? proven.c_str() : "-", size.shell_points_per_m2 * 1e-2,
                  size.file_bytes * 1e-6, size.bake_s,
                  size.possible ? "" : "  the standoff is above 30 voxels",
                  size.fits ? "" : "  too large");
    table += line;
  }
  std::snprintf(line, sizeof line,
                "file, bake: extrapolated from bakes with voxels of %.4g and %.4g mm\n",
                plan.probe_sizes_m[0] * 1e3, plan.probe_sizes_m[1] * 1e3);
  if (!plan.too_large.empty()) table += "too large: " + plan.too_large + "\n";
  return table +
         "standoff: distance from the mesh at which a part rests in contact, on each side\n"
         "gap: how much wider than a thin part a gap must be, so that the part passes without "
         "contact\n"
         "passed: how much wider than a thick part (2 voxels or more) a gap must be, so that the "
         "part passes in contact on both sides\n"
         "proven: guaranteed distance from the scene in such a gap, for the default covering "
         "radius; subtract the deviations of the meshes\n" +
         line;
}

nlohmann::ordered_json report_of(const Plan& plan) {
  using Json = nlohmann::ordered_json;
  const auto or_null = [](double length_m) {
    return length_m > 0 ? Json(length_m) : Json(nullptr);
  };
  Json sizes = Json::array();
  for (const PlannedSize& size : plan.sizes) {
    sizes.push_back({{"voxel_size_m", size.voxel_size_m},
                     {"standoff_m", or_null(size.standoff_m)},
                     {"narrowest_gap_m", or_null(size.narrowest_gap_m)},
                     {"passed_gap_m", size.possible ? Json(size.passed_gap_m) : Json(nullptr)},
                     {"guaranteed_separation_m", or_null(size.guaranteed_separation_m)},
                     {"shell_points_per_m2", size.shell_points_per_m2},
                     {"file_bytes", std::round(size.file_bytes)},
                     {"bake_s", size.bake_s},
                     {"fits", size.fits}});
  }
  return {{"plan", sizes}, {"probe_sizes_m", plan.probe_sizes_m}};
}

}  // namespace forcelayer::voxelize
