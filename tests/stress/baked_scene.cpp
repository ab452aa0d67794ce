#include <stdexcept>

#include "formats/voxmap_writer.h"
#include "tests/stress/baked.h"
#include "voxelize/bake.h"

namespace forcelayer::stress {

namespace {

// Three voxels of soft foam over a firmer layer, whose foot holds a device's 15 N at one point.
voxelize::Compliance covering(double voxel_size_m) {
  return {{1.5 * voxel_size_m, 1}, {2.5 * voxel_size_m, 6}, {3 * voxel_size_m, 20}};
}

}  // namespace

void bake_scene_file(const mesh::Mesh& scene, double voxel_size_m, test::VoxelKind kind,
                     const std::filesystem::path& path, double standoff_m) {
  voxelize::SceneObject object;
  object.name = "scene";
  object.mesh = &scene;
  voxelize::BakeOptions options;
  options.voxel_size_m = voxel_size_m;
  if (kind == test::VoxelKind::kChebyshev) options.metric = Metric::kChebyshev;
  options.distances = test::stores_distances(kind);
  if (kind == test::VoxelKind::kCovered) options.compliance = covering(voxel_size_m);
  if (kind == test::VoxelKind::kNear) standoff_m = test::kNearStandoffVoxels * voxel_size_m;
  if (standoff_m > 0) {
    options.standoff_m = standoff_m;
    options.layers = 0;
  }
  options.threads = 1;
  const auto baked = voxelize::bake(std::span(&object, 1), options);
  if (!baked) throw std::runtime_error(to_line(baked.error()));
  const auto written = write_voxmap(path, baked.value().content(""));
  if (!written) throw std::runtime_error(to_line(written.error()));
}

}  // namespace forcelayer::stress
