#include "voxelize/bake.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

#include "voxelize/directory_limit.h"
#include "voxelize/flood.h"
#include "voxelize/offset.h"
#include "voxelize/scan_conversion.h"
#include "voxelize/snap.h"
#include "voxelize/tree_builder.h"

namespace forcelayer {
namespace {

class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Status check(std::span<const SceneObject> objects, const BakeOptions& options) {
  if (!(options.voxel_size_m >= kMinVoxelSizeM && options.voxel_size_m <= kMaxVoxelSizeM)) {
    return Error{ErrorCode::kUsage, "", "voxel size", "is not between 1e-9 and 1e6 metres", ""};
  }
  if (options.layers > kMaxBakedLayers) {
    return Error{ErrorCode::kUsage, "", "layers",
                 "are more than " + std::to_string(kMaxBakedLayers), ""};
  }
  if (!(options.mesh_deviation_m >= 0 && std::isfinite(options.mesh_deviation_m))) {
    return Error{ErrorCode::kUsage, "", "mesh deviation", "is not a length of zero or more", ""};
  }
  const bool any = std::any_of(objects.begin(), objects.end(), [](const SceneObject& object) {
    return !object.mesh->triangles.empty();
  });
  if (!any) return Error{ErrorCode::kMeshEmpty, "", "", "the scene has no triangles", ""};
  return {};
}

// One bake, from objects to the tree.
class Pipeline {
 public:
  Pipeline(std::span<const SceneObject> objects, const BakeOptions& options)
      : objects_(objects), options_(options) {}

  Result<Bake> run();

 private:
  Status snap();
  Status add_object(std::size_t index);
  Status check_seeds(std::span<const Vec3d> seeds_m, const MaskTree& geometry,
                     const SceneObject& object, std::vector<Coord>& seeds) const;
  Coord in_scene(const VoxelIndex& voxel) const {
    return Coord(static_cast<int>(voxel[0] - directory_.origin[0]),
                 static_cast<int>(voxel[1] - directory_.origin[1]),
                 static_cast<int>(voxel[2] - directory_.origin[2]));
  }
  void fill_header(const ValueCounts& counts);
  void progress(const char* stage, double share) const {
    if (options_.progress) options_.progress(stage, share);
  }

  std::span<const SceneObject> objects_;
  const BakeOptions& options_;
  std::vector<SnappedObject> snapped_;
  VoxelBox box_;  // of all non-free voxels
  Directory directory_;
  double deviation_m_ = 0;
  Bake bake_;

  std::mutex mutex_;  // guards what follows and bake_.seconds while objects are added
  MaskTree geometry_, interior_;
  std::size_t objects_done_ = 0;
};

Status Pipeline::snap() {
  VoxelBox box;
  for (const SceneObject& object : objects_) {
    auto snapped =
        snap_object(*object.mesh, object.world_from_mesh, options_.voxel_size_m, object.name);
    if (!snapped) return snapped.error();
    box.include(snapped->box);
    deviation_m_ = std::max(deviation_m_, snapped->snap_error_m + object.deviation_m);
    ObjectReport& report = bake_.objects.emplace_back();
    report.name = object.name;
    report.triangles = object.mesh->triangles.size();
    report.degenerate_triangles = degenerate_triangles(*snapped);
    snapped_.push_back(std::move(*snapped));
  }
  box_ = box.grown(options_.layers + 1);
  const auto directory = fit_directory(box_, options_.voxel_size_m);
  if (!directory) return directory.error();
  directory_ = *directory;
  return {};
}

// The voxels of the scene in which the seeds lie.
Status Pipeline::check_seeds(std::span<const Vec3d> seeds_m, const MaskTree& geometry,
                             const SceneObject& object, std::vector<Coord>& seeds) const {
  for (const Vec3d& seed_m : seeds_m) {
    Coord voxel;
    bool inside = true;
    for (std::size_t d = 0; d < 3; ++d) {
      const double at =
          std::floor(seed_m[d] / options_.voxel_size_m) - static_cast<double>(directory_.origin[d]);
      inside &= at >= 0 && at < static_cast<double>(directory_.dims[d]) * kUpperNodeEdge;
      if (inside) voxel[static_cast<int>(d)] = static_cast<int>(at);
    }
    if (!inside) continue;  // free anyway
    if (geometry.isValueOn(voxel)) {
      char where[120];
      std::snprintf(where, sizeof where, "free seed %g,%g,%g", seed_m[0], seed_m[1], seed_m[2]);
      return Error{ErrorCode::kSceneInvalid, "", where,
                   "lies in a voxel that the surface of " + object.name + " passes through",
                   "move it into the open, or use a smaller voxel size"};
    }
    seeds.push_back(voxel);
  }
  return {};
}

Status Pipeline::add_object(std::size_t index) {
  const SceneObject& object = objects_[index];
  ObjectReport& report = bake_.objects[index];
  Stopwatch watch;
  auto geometry = scan_convert(snapped_[index], directory_.origin);
  snapped_[index] = {};
  const double scan_s = watch.lap();
  std::vector<Coord> seeds;
  for (const auto& seeds_m : {std::span<const Vec3d>(options_.free_seeds_m),
                              std::span<const Vec3d>(object.free_seeds_m)}) {
    if (Status checked = check_seeds(seeds_m, *geometry, object, seeds); !checked) return checked;
  }
  auto interior = flood_interior(*geometry, seeds);
  report.geometry_voxels = voxel_count(*geometry);
  report.interior_voxels = voxel_count(*interior);
  const double flood_s = watch.lap();

  const std::lock_guard lock(mutex_);
  unite(geometry_, std::move(*geometry));
  unite(interior_, std::move(*interior));
  bake_.seconds.scan += scan_s;
  bake_.seconds.flood += flood_s;
  bake_.seconds.unite += watch.lap();
  progress("voxels",
           0.7 * static_cast<double>(++objects_done_) / static_cast<double>(objects_.size()));
  return {};
}

void Pipeline::fill_header(const ValueCounts& counts) {
  VoxmapHeader& header = bake_.header;
  header.voxel_size_m = options_.voxel_size_m;
  header.origin_voxel = header.valid_min_voxel = box_.low;
  for (std::size_t d = 0; d < 3; ++d) {
    header.valid_max_voxel[d] = box_.high[d] + 1;
    header.dims_voxels[d] = static_cast<std::uint64_t>(box_.high[d] - box_.low[d] + 1);
  }
  header.offset_layers = options_.layers;
  header.metric = static_cast<std::uint32_t>(Metric::kChebyshev);
  header.bits_per_voxel = 2;
  header.directory_origin = directory_.origin;
  header.directory_dims = directory_.dims;
  header.interior_voxels = counts.interior;
  header.surface_voxels = counts.surface;
  header.proximity_voxels = counts.proximity;
  for (const ObjectReport& object : bake_.objects) header.triangles += object.triangles;
  header.static_deviation_m = deviation_m_ + options_.mesh_deviation_m;
}

Result<Bake> Pipeline::run() {
  Stopwatch watch;
  progress("reading vertices", 0);
  if (Status snapped = snap(); !snapped) return snapped.error();
  bake_.seconds.snap = watch.lap();

  std::vector<Status> added(objects_.size());
  tbb::parallel_for(std::size_t{0}, objects_.size(),
                    [&](std::size_t i) { added[i] = add_object(i); });
  for (const Status& status : added) {
    if (!status) return status.error();
  }
  watch.lap();
  progress("force layer", 0.7);
  const openvdb::CoordBBox box(in_scene(box_.low), in_scene(box_.high));
  ValueCounts counts;
  VoxelTree tree = build_tree(LayerOffset(geometry_, interior_, options_.layers, box), interior_,
                              directory_.dims, counts);
  bake_.seconds.tree = watch.lap();
  fill_header(counts);
  bake_.directory = std::move(tree.directory);
  bake_.upper_nodes = std::move(tree.upper_nodes);
  bake_.lower_nodes = std::move(tree.lower_nodes);
  bake_.bricks = std::move(tree.bricks);
  progress("force layer", 1);
  return std::move(bake_);
}

}  // namespace

Result<Bake> bake(std::span<const SceneObject> objects, const BakeOptions& options) {
  if (Status checked = check(objects, options); !checked) return checked.error();
  const int threads = options.threads > 0
                          ? options.threads
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  std::optional<Result<Bake>> result;
  arena.execute([&] { result.emplace(Pipeline(objects, options).run()); });
  return std::move(*result);
}

}  // namespace forcelayer
