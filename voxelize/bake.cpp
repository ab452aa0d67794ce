#include "voxelize/bake.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

#include "voxelize/cache/node_memory.h"
#include "voxelize/cache/part_cache.h"
#include "voxelize/directory_limit.h"
#include "voxelize/distance/near_voxels.h"
#include "voxelize/distance/offset.h"
#include "voxelize/fill/cavities.h"
#include "voxelize/fill/flood.h"
#include "voxelize/memory_limit.h"
#include "voxelize/region.h"
#include "voxelize/scan/scan_conversion.h"
#include "voxelize/scan/snap.h"
#include "voxelize/tree/tree_builder.h"

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

// A soft covering and the range that must hold it.
Status check_covering(const BakeOptions& options) {
  const auto wrong = [](const char* what, std::string why, const char* mend) {
    return Error{ErrorCode::kUsage, "", what, std::move(why), mend};
  };
  if (options.compliance.empty()) return {};
  if (options.bits == 2) return wrong("compliance", "needs stored distances", "add --bits 8");
  if (Status checked = check_compliance(options.compliance); !checked) return checked;
  const double layer = force_layer_voxels(options);
  if (!(layer + 1 <= kMostRangeVoxels && options.layers + layer <= kMaxBakedLayers + 1)) {
    return wrong("compliance", "is too deep: layers and covering take more than 31 voxels",
                 "use larger voxels");
  }
  if (options.range_m > 0 && options.range_m / options.voxel_size_m < layer + 1) {
    return wrong("range", "ends less than a voxel below the covering", "leave it out");
  }
  return {};
}

// Metric, bits and range.
Status check_kind(const BakeOptions& options) {
  const auto wrong = [](const char* what, std::string why, const char* mend) {
    return Error{ErrorCode::kUsage, "", what, std::move(why), mend};
  };
  if (options.bits != 2 && options.bits != 4 && options.bits != 8) {
    return wrong("bits", "are not 2, 4 or 8", "");
  }
  if (options.metric != Metric::kEuclidean && options.bits != 2) {
    return wrong("bits", "of more than 2 store Euclidean distances", "add --metric euclidean");
  }
  if (options.metric == Metric::kEuclidean && options.layers == 0) {
    return wrong("layers", "are none: there is nothing for the metric to measure",
                 "use --layers 1 or more");
  }
  if (Status covering = check_covering(options); !covering) return covering;
  if (options.range_m == 0) return {};
  if (options.bits == 2) return wrong("range", "has no meaning at 2 bits", "leave it out");
  const double voxels = options.range_m / options.voxel_size_m;
  if (!(voxels >= kLeastRangeVoxels && voxels <= kMostRangeVoxels)) {
    return wrong("range", "is not between 2 and 32 voxels", "");
  }
  return {};
}

Status check(const BakeOptions& options) {
  if (!(options.voxel_size_m >= kMinVoxelSizeM && options.voxel_size_m <= kMaxVoxelSizeM)) {
    return Error{ErrorCode::kUsage, "", "voxel size", "is not between 1e-9 and 1e6 metres", ""};
  }
  if (options.layers > kMaxBakedLayers) {
    return Error{ErrorCode::kUsage, "", "layers",
                 "are more than " + std::to_string(kMaxBakedLayers), ""};
  }
  if (Status kind = check_kind(options); !kind) return kind;
  if (!(options.mesh_deviation_m >= 0 && std::isfinite(options.mesh_deviation_m))) {
    return Error{ErrorCode::kUsage, "", "mesh deviation", "is not a length of zero or more", ""};
  }
  return {};
}

// The free seeds that matter to one object.
class ObjectSeeds {
 public:
  ObjectSeeds(const SceneObject& object, const BakeOptions& options, const VoxelBox& box)
      : object_(object), voxel_size_m_(options.voxel_size_m) {
    for (const auto* seeds_m : {&options.free_seeds_m, &object.free_seeds_m}) {
      for (const Vec3d& seed_m : *seeds_m) add(seed_m, box);
    }
  }

  // The seeds as voxels counted from `origin`; kSceneInvalid where one lies in the surface.
  Result<std::vector<Coord>> voxels(const MaskTree& geometry, const VoxelIndex& origin) const {
    std::vector<Coord> result;
    for (const Seed& seed : seeds_) {
      const Coord voxel(static_cast<int>(seed.voxel[0] - origin[0]),
                        static_cast<int>(seed.voxel[1] - origin[1]),
                        static_cast<int>(seed.voxel[2] - origin[2]));
      if (geometry.isValueOn(voxel)) return in_surface(seed.seed_m);
      result.push_back(voxel);
    }
    return result;
  }

 private:
  struct Seed {
    Vec3d seed_m;
    VoxelIndex voxel;
  };

  // A seed outside the object's box is free anyway.
  void add(const Vec3d& seed_m, const VoxelBox& box) {
    Seed seed{seed_m, {}};
    for (std::size_t d = 0; d < 3; ++d) {
      const double at = std::floor(seed_m[d] / voxel_size_m_);
      if (!(at >= static_cast<double>(box.low[d]) && at <= static_cast<double>(box.high[d]))) {
        return;
      }
      seed.voxel[d] = static_cast<std::int64_t>(at);
    }
    seeds_.push_back(seed);
  }

  Error in_surface(const Vec3d& seed_m) const {
    char where[120];
    std::snprintf(where, sizeof where, "free seed %g,%g,%g", seed_m[0], seed_m[1], seed_m[2]);
    return {ErrorCode::kSceneInvalid, "", where,
            "lies in a voxel that the surface of " + object_.name + " passes through",
            "move it into the open, or use a smaller voxel size"};
  }

  const SceneObject& object_;
  double voxel_size_m_;
  std::vector<Seed> seeds_;
};

// One bake, from objects to the tree.
class Pipeline {
 public:
  Pipeline(std::span<const SceneObject> objects, const BakeOptions& options)
      : objects_(objects), options_(options), parts_(objects.size()) {}

  Result<Bake> run();
  Result<Bake> run_parts_only();

 private:
  // An object on its way into the scene: found in the cache, or snapped.
  struct Part {
    PartFacts facts;
    std::optional<Digest> key;
    std::vector<Cavity> cavities;
    std::optional<CachedPart> cached;
    const Mesh* mesh = nullptr;  // where it is not cached
    SnappedObject snapped;
  };

  Status prepare();
  void look_up();
  bool knows_enough(const PartFacts& facts) const;
  void find_cavities(std::size_t index, const MaskTree& interior);
  void find_narrow_passages(std::size_t index);
  template <class AddObject>
  Status for_each_object(AddObject&& add_object);
  Status snap(std::size_t index);
  Status choose_region();
  Result<PartVoxels> part_voxels(std::size_t index);
  Result<PartVoxels> bake_part(std::size_t index);
  Status add_object(std::size_t index);
  void report_object(std::size_t index);
  Coord in_scene(const VoxelIndex& voxel) const {
    return Coord(static_cast<int>(voxel[0] - directory_.origin[0]),
                 static_cast<int>(voxel[1] - directory_.origin[1]),
                 static_cast<int>(voxel[2] - directory_.origin[2]));
  }
  void build();
  bool is_wide() const { return options_.bits != 2; }
  DistanceScale scale() const;
  int reach() const;
  VoxelTree distance_tree(const KeptBox& kept, ValueCounts& counts);
  void fill_header(const VoxelBox& tight, const ValueCounts& counts);
  void progress(const char* stage, double share) const {
    if (options_.progress) options_.progress(stage, share);
  }

  std::span<const SceneObject> objects_;
  const BakeOptions& options_;
  std::vector<Part> parts_;  // [objects]
  Region region_;
  Directory directory_;  // of the region; empty where nothing can be in it
  double deviation_m_ = 0;
  Bake bake_;

  std::mutex mutex_;  // guards what follows and bake_.seconds while objects are added
  MaskTree geometry_, interior_;
  std::size_t objects_done_ = 0;

  std::mutex reading_;  // SceneObject::read_mesh is called under it
};

void Pipeline::look_up() {
  if (options_.cache == nullptr) return;
  tbb::parallel_for(std::size_t{0}, objects_.size(), [&](std::size_t i) {
    Part& part = parts_[i];
    part.key = part_key(objects_[i], options_);
    if (part.key) part.cached = CachedPart::find(*options_.cache, *part.key);
    if (!part.cached) return;
    if (!knows_enough(part.cached->facts())) {
      part.cached.reset();
      return;
    }
    part.facts = part.cached->facts();
    part.cavities = part.cached->cavities();
  });
}

bool Pipeline::knows_enough(const PartFacts& facts) const {
  return (!options_.find_cavities || (facts.knows & PartFacts::kCavities) != 0) &&
         (!options_.find_narrow_passages || (facts.knows & PartFacts::kNarrowPassages) != 0);
}

Status Pipeline::snap(std::size_t index) {
  const SceneObject& object = objects_[index];
  const Mesh* mesh = object.mesh;
  if (mesh == nullptr) {
    const std::lock_guard lock(reading_);
    const auto read = object.read_mesh();
    if (!read) return read.error();
    mesh = *read;
  }
  Part& part = parts_[index];
  auto snapped = snap_object(*mesh, object.world_from_mesh, options_.voxel_size_m, object.name);
  if (!snapped) return snapped.error();
  part.mesh = mesh;
  part.snapped = std::move(*snapped);
  part.facts = {};
  part.cavities.clear();
  part.facts.triangles = mesh->triangles.size();
  part.facts.degenerate_triangles = degenerate_triangles(part.snapped);
  part.facts.box = part.snapped.box;
  part.facts.snap_error_m = part.snapped.snap_error_m;
  return {};
}

// Every object's box and facts: from the cache, or by snapping it.
Status Pipeline::prepare() {
  look_up();
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    bake_.objects.emplace_back().name = objects_[i].name;
    if (!parts_[i].cached) {
      if (Status snapped = snap(i); !snapped) return snapped;
    }
    deviation_m_ = std::max(deviation_m_, parts_[i].facts.snap_error_m + objects_[i].deviation_m);
  }
  return {};
}

// What of the scene is kept. Objects that cannot touch it are left out; the others are filled from
// all of their triangles.
Status Pipeline::choose_region() {
  VoxelBox scene;
  const bool empty = std::all_of(parts_.begin(), parts_.end(),
                                 [](const Part& part) { return part.facts.triangles == 0; });
  if (empty) return Error{ErrorCode::kMeshEmpty, "", "", "the scene has no triangles", ""};
  for (const Part& part : parts_) scene.include(part.facts.box);
  region_ = region_of(scene.grown(this->reach()), options_.roi_m, options_.voxel_size_m);
  const VoxelBox reach = region_.box.grown(this->reach() + 1);
  bool any = false;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const VoxelBox& box = parts_[i].facts.box;
    ObjectReport& report = bake_.objects[i];
    report.skipped = region_.cropped_sides != 0 && !box.overlaps(reach);
    if (report.skipped || box.empty()) continue;
    any = true;
    // The whole object is flooded, and counted from the region's directory.
    if (region_.cropped_sides == 0) continue;
    const auto fits = fit_directory(box.joined(reach), options_.voxel_size_m);
    if (!fits) return fits.error();
  }
  if (!any) return {};
  const auto directory = fit_directory(region_.box, options_.voxel_size_m);
  if (!directory) return directory.error();
  directory_ = *directory;
  return {};
}

Result<PartVoxels> Pipeline::bake_part(std::size_t index) {
  Part& part = parts_[index];
  const Status fits =
      fit_memory(part.snapped, objects_[index].name, options_.voxel_size_m, available_bytes());
  if (!fits) return fits.error();
  Stopwatch watch;
  PartVoxels voxels;
  voxels.geometry = scan_convert(part.snapped, directory_.origin);
  const double scan_s = watch.lap();
  const auto seeds = ObjectSeeds(objects_[index], options_, part.facts.box)
                         .voxels(*voxels.geometry, directory_.origin);
  if (!seeds) return seeds.error();
  voxels.interior = flood_interior(*voxels.geometry, *seeds);
  part.facts.geometry_voxels = voxel_count(*voxels.geometry);
  part.facts.interior_voxels = voxel_count(*voxels.interior);
  const double flood_s = watch.lap();
  if (grows_surface(options_)) {
    voxels.geometry = near_voxels(part.snapped, *voxels.interior, static_cast<int>(options_.layers),
                                  directory_.origin);
  }
  const double near_s = watch.lap();
  if (!is_wide()) part.snapped = {};
  if (options_.find_cavities || options_.find_narrow_passages) {
    find_cavities(index, *voxels.interior);
  }
  if (options_.find_narrow_passages) find_narrow_passages(index);
  const double cavities_s = watch.lap();
  if (part.key) {
    keep_part(*options_.cache, *part.key, part.facts, part.cavities, voxels, directory_.origin);
  }
  const std::lock_guard lock(mutex_);
  bake_.seconds.scan += scan_s;
  bake_.seconds.near += near_s;
  bake_.seconds.flood += flood_s;
  bake_.seconds.cavities += cavities_s;
  bake_.seconds.cache += watch.lap();
  return voxels;
}

void Pipeline::find_cavities(std::size_t index, const MaskTree& interior) {
  Part& part = parts_[index];
  const std::vector<InteriorPiece> pieces = interior_pieces(interior);
  part.facts.knows |= PartFacts::kCavities;
  part.facts.cavity_count = pieces.size();
  for (const InteriorPiece& piece : pieces) {
    if (part.cavities.size() == kMaxReportedCavities) break;
    Cavity& cavity = part.cavities.emplace_back();
    cavity.voxels = piece.voxels;
    for (std::size_t d = 0; d < 3; ++d) {
      cavity.seed_voxel[d] = piece.seed[static_cast<int>(d)] + directory_.origin[d];
    }
  }
}

// Floods the object again at half the voxel size. A piece of the interior touches no surface, so
// all of it is reached there as soon as one voxel is.
void Pipeline::find_narrow_passages(std::size_t index) {
  Part& part = parts_[index];
  part.facts.knows |= PartFacts::kNarrowPassages;
  if (part.cavities.empty()) return;
  BakeOptions halved = options_;
  halved.voxel_size_m /= 2;
  const SceneObject& object = objects_[index];
  const auto snapped =
      snap_object(*part.mesh, object.world_from_mesh, halved.voxel_size_m, object.name);
  if (!snapped) return;
  const auto directory = fit_directory(snapped->box, halved.voxel_size_m);
  if (!directory) return;
  const auto geometry = scan_convert(*snapped, directory->origin);
  const auto seeds = ObjectSeeds(object, halved, snapped->box).voxels(*geometry, directory->origin);
  if (!seeds) return;
  const auto interior = flood_interior(*geometry, *seeds);
  for (Cavity& cavity : part.cavities) {
    Coord voxel;  // at the middle of the cavity's seed voxel
    for (std::size_t d = 0; d < 3; ++d) {
      voxel[static_cast<int>(d)] =
          static_cast<int>(2 * cavity.seed_voxel[d] + 1 - directory->origin[d]);
    }
    cavity.opens_at_half_size = !interior->isValueOn(voxel) && !geometry->isValueOn(voxel);
  }
}

Result<PartVoxels> Pipeline::part_voxels(std::size_t index) {
  Part& part = parts_[index];
  if (part.cached) {
    Stopwatch watch;
    auto voxels = part.cached->voxels(directory_.origin);
    part.cached.reset();
    if (voxels && is_wide()) {
      const PartFacts facts = part.facts;
      if (Status snapped = snap(index); !snapped) return snapped.error();
      part.facts = facts;
    }
    if (voxels) {
      bake_.objects[index].from_cache = true;
      const std::lock_guard lock(mutex_);
      bake_.seconds.cache += watch.lap();
      return std::move(*voxels);
    }
    if (Status snapped = snap(index); !snapped) return snapped.error();
  }
  return bake_part(index);
}

Status Pipeline::add_object(std::size_t index) {
  if (bake_.objects[index].skipped) {
    report_object(index);
    return {};
  }
  auto voxels = part_voxels(index);
  if (!voxels) return voxels.error();
  report_object(index);
  Stopwatch watch;
  const std::lock_guard lock(mutex_);
  watch.lap();
  unite(geometry_, std::move(*voxels->geometry));
  unite(interior_, std::move(*voxels->interior));
  bake_.seconds.unite += watch.lap();
  progress("voxels",
           0.7 * static_cast<double>(++objects_done_) / static_cast<double>(objects_.size()));
  return {};
}

void Pipeline::report_object(std::size_t index) {
  const PartFacts& facts = parts_[index].facts;
  ObjectReport& report = bake_.objects[index];
  report.triangles = facts.triangles;
  report.degenerate_triangles = facts.degenerate_triangles;
  report.geometry_voxels = facts.geometry_voxels;
  report.interior_voxels = facts.interior_voxels;
  report.cavity_count = facts.cavity_count;
  report.cavities = parts_[index].cavities;
}

void Pipeline::fill_header(const VoxelBox& tight, const ValueCounts& counts) {
  VoxmapHeader& header = bake_.header;
  header.voxel_size_m = options_.voxel_size_m;
  header.valid_min_voxel = region_.box.low;
  header.cropped_sides = region_.cropped_sides;
  for (std::size_t d = 0; d < 3; ++d) {
    header.valid_max_voxel[d] = region_.box.high[d] + 1;
    if (tight.empty()) continue;
    header.origin_voxel[d] = tight.low[d];
    header.dims_voxels[d] = static_cast<std::uint64_t>(tight.high[d] - tight.low[d] + 1);
  }
  header.offset_layers = options_.layers;
  header.metric = static_cast<std::uint32_t>(options_.metric);
  header.bits_per_voxel = options_.bits;
  if (is_wide()) {
    const DistanceScale scale = this->scale();
    header.range_m = scale.range * options_.voxel_size_m;
    header.quantum_m = scale.quantum * options_.voxel_size_m;
    header.zero_code = scale.zero_code;
    header.surface_code = scale.surface_code;
    header.proximity_code = scale.proximity_code;
    header.free_code = scale.free_code;
    bake_.compliance = compliance_table(options_.compliance, header.quantum_m);
  }
  header.directory_origin = directory_.origin;
  header.directory_dims = directory_.dims;
  header.interior_voxels = counts.interior;
  header.surface_voxels = counts.surface;
  header.proximity_voxels = counts.proximity;
  for (const ObjectReport& object : bake_.objects) header.triangles += object.triangles;
  header.static_deviation_m = deviation_m_ + options_.mesh_deviation_m;
}

// The first error by the order of the objects, whichever thread met it.
template <class AddObject>
Status Pipeline::for_each_object(AddObject&& add_object) {
  std::vector<Status> added(objects_.size());
  tbb::parallel_for(std::size_t{0}, objects_.size(),
                    [&](std::size_t i) { added[i] = add_object(i); });
  for (const Status& status : added) {
    if (!status) return status;
  }
  return {};
}

DistanceScale Pipeline::scale() const {
  const double layer = force_layer_voxels(options_);
  const double range = options_.range_m > 0 ? options_.range_m / options_.voxel_size_m
                                            : default_range_voxels(options_.bits) + layer - 1;
  return distance_scale(options_.layers, options_.bits, range, layer);
}

// How many voxels around the geometry may be anything but free.
int Pipeline::reach() const {
  if (is_wide()) return DistanceNodes::reach(scale());
  return static_cast<int>(options_.layers) + (grows_surface(options_) ? 2 : 1);
}

VoxelTree Pipeline::distance_tree(const KeptBox& kept, ValueCounts& counts) {
  std::vector<const SnappedObject*> objects;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (!bake_.objects[i].skipped) objects.push_back(&parts_[i].snapped);
  }
  const LayerOffset around(geometry_, interior_, static_cast<unsigned>(reach() - 1), kept);
  const DistanceNodes distances(std::move(objects), directory_.origin, geometry_, interior_,
                                scale(), kept);
  return build_distance_tree(around, distances, directory_.dims, counts);
}

// The tree of the region, and the header.
void Pipeline::build() {
  ValueCounts counts;
  VoxelBox tight;
  if (!directory_.empty()) {
    const KeptBox kept{{in_scene(region_.box.low), in_scene(region_.box.high)},
                       region_.cropped_sides};
    std::optional<NodeMemory> memory;
    if (options_.cache != nullptr && !options_.scene_name.empty() && !kept.cropped() &&
        !is_wide()) {
      memory.emplace(*options_.cache, options_.scene_name, options_.voxel_size_m);
    }
    const NodeMemory* nodes = memory ? &*memory : nullptr;
    // Euclidean layers: the geometry has been grown already.
    const unsigned layers = grows_surface(options_) ? 1 : options_.layers;
    VoxelTree tree = is_wide() ? distance_tree(kept, counts)
                               : build_tree(LayerOffset(geometry_, interior_, layers, kept),
                                            directory_.dims, nodes, counts);
    if (memory) {
      bake_.nodes = memory->asked();
      bake_.reused_nodes = memory->found();
    }
    // Where nothing is cropped, Chebyshev layers end where the region does.
    if (!kept.cropped() && options_.metric == Metric::kChebyshev) {
      tight = region_.box;
    } else {
      const std::uint32_t free_code = is_wide() ? scale().free_code : 0;
      tight = tight_box(tree, directory_.dims, options_.bits, free_code).shifted(directory_.origin);
    }
    if (is_wide()) name_codes(tree, scale());
    bake_.directory = std::move(tree.directory);
    bake_.upper_nodes = std::move(tree.upper_nodes);
    bake_.lower_nodes = std::move(tree.lower_nodes);
    bake_.bricks = std::move(tree.bricks);
  }
  fill_header(tight, counts);
}

Result<Bake> Pipeline::run() {
  Stopwatch watch;
  progress("reading vertices", 0);
  if (Status prepared = prepare(); !prepared) return prepared.error();
  if (Status chosen = choose_region(); !chosen) return chosen.error();
  bake_.seconds.snap = watch.lap();
  const Status added = for_each_object([&](std::size_t i) { return add_object(i); });
  if (!added) return added.error();
  watch.lap();
  progress("force layer", 0.7);
  build();
  bake_.seconds.tree = watch.lap();
  progress("force layer", 1);
  return std::move(bake_);
}

Result<Bake> Pipeline::run_parts_only() {
  Stopwatch watch;
  if (Status prepared = prepare(); !prepared) return prepared.error();
  bake_.seconds.snap = watch.lap();
  bake_.header.voxel_size_m = options_.voxel_size_m;
  VoxelBox scene;
  for (const Part& part : parts_) scene.include(part.facts.box);
  if (scene.empty()) return std::move(bake_);
  const auto directory = fit_directory(scene, options_.voxel_size_m);
  if (!directory) return directory.error();
  directory_ = *directory;
  const Status added = for_each_object([&](std::size_t i) -> Status {
    if (parts_[i].cached) {
      bake_.objects[i].from_cache = true;
    } else if (auto voxels = bake_part(i); !voxels) {
      return voxels.error();
    }
    report_object(i);
    const std::lock_guard lock(mutex_);
    progress("voxels", static_cast<double>(++objects_done_) / static_cast<double>(objects_.size()));
    return {};
  });
  if (!added) return added.error();
  return std::move(bake_);
}

// Runs a bake on as many threads as the options say.
template <class Run>
Result<Bake> on_threads(std::span<const SceneObject> objects, const BakeOptions& options,
                        Run&& run) {
  if (Status checked = check(options); !checked) return checked.error();
  const int threads = options.threads > 0
                          ? options.threads
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  std::optional<Result<Bake>> result;
  arena.execute([&] {
    Pipeline pipeline(objects, options);
    result.emplace(run(pipeline));
  });
  return std::move(*result);
}

}  // namespace

Result<Bake> bake(std::span<const SceneObject> objects, const BakeOptions& options) {
  return on_threads(objects, options, [](Pipeline& pipeline) { return pipeline.run(); });
}

Result<Bake> bake_parts(std::span<const SceneObject> objects, const BakeOptions& options) {
  return on_threads(objects, options, [](Pipeline& pipeline) { return pipeline.run_parts_only(); });
}

}  // namespace forcelayer
