#include <stdexcept>

#include "formats/voxmap_writer.h"
#include "tests/stress/baked.h"
#include "voxelize/bake.h"

namespace forcelayer::stress {

namespace {

// Three voxels of soft foam over a firmer layer. Its foot holds a device's 15 N on four square
// voxels, and 15 N push a peg of hundreds of them into a hole that is lined with it.
voxelize::Compliance covering(double voxel_size_m) {
  const double per_n = 1 / (voxel_size_m * voxel_size_m);
  return {{1.5 * voxel_size_m, 0.2 * per_n},
          {2.5 * voxel_size_m, 1.2 * per_n},
          {3 * voxel_size_m, 4 * per_n}};
}

void set_standoff(voxelize::BakeOptions& options, double standoff_m) {
  if (standoff_m <= 0) return;
  options.standoff_m = standoff_m;
  options.layers = 0;
}

void bake_to(std::span<const voxelize::SceneObject> objects, voxelize::BakeOptions options,
             const std::filesystem::path& path) {
  options.threads = 1;
  const auto baked = voxelize::bake(objects, options);
  if (!baked) throw std::runtime_error(to_line(baked.error()));
  const auto written = write_voxmap(path, baked.value().content(""));
  if (!written) throw std::runtime_error(to_line(written.error()));
}

}  // namespace

void bake_scene_file(const mesh::Mesh& scene, double voxel_size_m, test::VoxelKind kind,
                     const std::filesystem::path& path, double standoff_m,
                     const std::optional<std::array<double, 6>>& roi_m) {
  voxelize::SceneObject object;
  object.name = "scene";
  object.mesh = &scene;
  voxelize::BakeOptions options;
  options.voxel_size_m = voxel_size_m;
  if (kind == test::VoxelKind::kChebyshev) options.metric = Metric::kChebyshev;
  options.distances = test::stores_distances(kind);
  options.roi_m = roi_m;
  if (kind == test::VoxelKind::kCovered) options.compliance = covering(voxel_size_m);
  if (kind == test::VoxelKind::kNear) standoff_m = test::kNearStandoffVoxels * voxel_size_m;
  set_standoff(options, standoff_m);
  bake_to({&object, 1}, options, path);
}

void bake_objects_file(std::span<const mesh::Mesh> objects, double voxel_size_m,
                       const std::filesystem::path& path, double standoff_m,
                       const std::optional<std::array<double, 6>>& roi_m) {
  std::vector<voxelize::SceneObject> named;
  for (const mesh::Mesh& object : objects) {
    named.emplace_back().mesh = &object;
    named.back().name = "object " + std::to_string(named.size());
  }
  voxelize::BakeOptions options;
  options.voxel_size_m = voxel_size_m;
  options.roi_m = roi_m;
  set_standoff(options, standoff_m);
  bake_to(named, options, path);
}

}  // namespace forcelayer::stress
