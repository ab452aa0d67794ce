#include "workbench/exact/map/clearance_map.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "formats/command/progress_line.h"
#include "formats/command/text.h"
#include "runtime/voxcheck/path_source.h"
#include "workbench/exact/exact_check.h"
#include "workbench/exact/map/color_scale.h"
#include "workbench/exact/map/split.h"
#include "workbench/exact/map/vertex_clearance.h"
#include "workbench/exact/mesh_distance.h"
#include "workbench/exact/watch.h"

namespace forcelayer::exact {
namespace {

using Place = std::array<float, 3>;

constexpr double kReach = 4;          // required clearances
constexpr double kReachVoxels = 8;    // where no clearance is required
constexpr double kWithin = 1.0 / 16;  // of the reach: about half a step of the color scale
constexpr double kEdge = 1.0 / 4;     // of the reach: colors change little along an edge
// Vertices as 32-bit floats may be farther from the centroid than those of the mesh.
constexpr double kRadiusOfFloats = 1 + 1e-6;
// A file of some megabytes, which a page can show.
constexpr std::size_t kMaxMore = 60'000;

glm::dvec3 dvec3_of(const Place& p) { return {p[0], p[1], p[2]}; }

// The largest float that is no more.
float rounded_down(double x) {
  const auto nearest = static_cast<float>(x);
  return nearest <= x ? nearest : std::nextafter(nearest, 0.0f);
}

std::string hex(const Rgb& c) { return command::text("#%02x%02x%02x", c[0], c[1], c[2]); }

// The meaning of numbers and colors, for asset.extras.
std::string legend(const MapScale& scale) {
  using Json = nlohmann::ordered_json;
  Json colors = Json::array();
  const std::vector<Rgb>& all = scale_colors();
  for (std::size_t n = 0; n < all.size(); ++n) {
    const double fraction = static_cast<double>(n) / static_cast<double>(all.size() - 1);
    colors.push_back({{"clearance_m", fraction * scale.reach_m}, {"srgb", hex(all[n])}});
  }
  const auto mm = [](double m) { return command::text("%.4g mm", 1e3 * m); };
  return Json{{"clearance_map",
               {{"legend",
                 "_CLEARANCE_M is a lower bound, in meters, of the least distance between this "
                 "vertex and the other body along the whole path. It holds at the vertices, and is "
                 "at most " +
                     mm(scale.within_m + scale.margin_m) + " below that distance. Gray: " +
                     mm(scale.reach_m) + " or more, or objects that do not count."},
                {"required_m", scale.required_m},
                {"reach_m", scale.reach_m},
                {"within_m", scale.within_m},
                {"deviations_and_rounding_m", scale.margin_m},
                {"longest_edge_m", scale.edge_m},
                {"colors", colors},
                {"beyond", hex(kBeyondScale)}}}}
      .dump();
}

}  // namespace

MapScale scale_of(double required_m, double voxel_m, double margin_m) {
  MapScale scale;
  scale.required_m = required_m;
  scale.margin_m = margin_m;
  scale.reach_m = required_m > 0 ? kReach * required_m : kReachVoxels * voxel_m;
  scale.within_m = std::min(voxel_m / 2, kWithin * scale.reach_m);
  scale.edge_m = kEdge * scale.reach_m;
  return scale;
}

void color_by_clearance(MovingScene& moving, const Surface& scene, const Surface& part,
                        const clearance::CenterPath& path, MapScale& scale, std::size_t max_more,
                        const std::function<void(double)>& progress) {
  VertexClearance clearance(path, scene, part);
  // So far that a vertex beyond the scale is not shown as just within it.
  const double reach_m = scale.reach_m + scale.within_m + scale.margin_m;
  const std::set<std::uint32_t> counted(scene.object.begin(), scene.object.end());
  const auto counts = [&](std::size_t n) { return n == 0 || counted.contains(moving.objects[n]); };
  const auto least_m = [&](std::size_t node, const Place& place, double far_m, double within_m) {
    return node == 0 ? clearance.of_part_m(dvec3_of(place), far_m, within_m)
                     : clearance.of_scene_m(dvec3_of(place), far_m, within_m);
  };

  std::vector<std::size_t> near;  // nodes of which some point may be near enough
  std::vector<SplitMesh> meshes;
  double edge_m = 0;
  for (std::size_t n = 0; n < moving.nodes.size(); ++n) {
    if (!counts(n) || moving.away_m[n] > reach_m) continue;
    near.push_back(n);
    meshes.emplace_back(moving.nodes[n]);
    edge_m = std::max(edge_m, longest_edge_m(moving.nodes[n]));
  }
  const auto triangles = [](const std::vector<SplitMesh>& all) {
    std::size_t sum = 0;
    for (const SplitMesh& mesh : all) sum += mesh.node.triangles.size();
    return sum;
  };
  const std::size_t max_triangles = triangles(meshes) + max_more;
  const double smallest_m = std::exchange(scale.edge_m, edge_m);
  while (scale.edge_m > smallest_m) {
    edge_m = std::max(smallest_m, scale.edge_m / 2);
    std::vector<SplitMesh> finer = meshes;
    for (std::size_t n = 0; n < finer.size(); ++n) {
      split_edges(finer[n], edge_m, [&](const Place& center, double radius_m) {
        return least_m(near[n], center, reach_m + radius_m, radius_m / 2) < reach_m + radius_m;
      });
    }
    if (triangles(finer) > max_triangles) break;
    meshes = std::move(finer);
    scale.edge_m = edge_m;
  }

  std::size_t all = 0, done = 0;
  for (const SplitMesh& mesh : meshes) all += mesh.node.vertices_m.size();
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    mesh::GlbNode& node = meshes[m].node;
    for (const Place& place : node.vertices_m) {
      const double least = least_m(near[m], place, reach_m, scale.within_m) - scale.margin_m;
      node.clearance_m.push_back(rounded_down(std::clamp(least, 0.0, scale.reach_m)));
      node.colors.push_back(linear_rgba(color_at(least / scale.reach_m)));
      progress(static_cast<double>(++done) / static_cast<double>(all));
    }
  }

  // Nothing is changed before all is known.
  if (clearance.is_exact()) scale.within_m = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    moving.nodes[near[m]] = std::move(meshes[m].node);
  }
  for (std::size_t n = 0; n < moving.nodes.size(); ++n) {
    mesh::GlbNode& node = moving.nodes[n];
    node.color = {1, 1, 1};
    if (!node.colors.empty()) continue;
    if (counts(n)) node.clearance_m.assign(node.vertices_m.size(), rounded_down(scale.reach_m));
    node.colors.assign(node.vertices_m.size(), linear_rgba(kBeyondScale));
  }
}

Result<voxcheck::ExactAnswer> write_map(const voxcheck::ExactRequest& request) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begun = Clock::now();
  auto meshes = read_meshes(request, request.quiet);
  if (!meshes) return meshes.error();
  const auto& [voxmap, shell, scene, part, warnings] = *meshes;
  const auto rows = voxcheck::read_part_path(request, shell);
  if (!rows) return rows.error();
  voxcheck::ExactAnswer answer;
  answer.warnings = warnings;
  MovingScene moving = moving_scene(request, scene, voxmap, part, shell, *rows, answer.warnings);
  const auto& c = shell.header().center_m;
  const clearance::CenterPath path(*rows, {c[0], c[1], c[2]}, kRadiusOfFloats * radius_m(part));
  const double margin_m =
      kRounding * largest_m(scene, part, *rows) + scene.deviation_m + part.deviation_m;
  MapScale scale = scale_of(request.required_m, voxmap.voxel_size_m(), margin_m);
  const double wanted_m = scale.edge_m;
  command::ProgressLine line(request.quiet);
  std::string about;
  const Watch watch([&] {
    const std::chrono::duration<double> spent = Clock::now() - begun;
    return !request.max_s || spent.count() < *request.max_s;
  });
  try {
    color_by_clearance(
        moving, without(scene, request.allowed), part, path, scale, kMaxMore,
        [&](double fraction) { line.show("computing the clearance map", fraction); });
    about = legend(scale);
  } catch (const Stopped&) {
    answer.warnings.push_back(
        "--time ended before the clearance map was finished: it has no clearances");
  }
  if (!about.empty() && scale.edge_m > wanted_m) {
    answer.warnings.push_back(command::text(
        "edges of the clearance map are up to %.4g mm long instead of %.4g mm, so that it has at "
        "most %zu triangles more than the meshes",
        1e3 * scale.edge_m, 1e3 * wanted_m, kMaxMore));
  }
  const Status written =
      mesh::write_glb(request.map, moving.nodes, &moving.motion, moving.up, about);
  if (!written) return written.error();
  return answer;
}

}  // namespace forcelayer::exact
