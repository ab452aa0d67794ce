#include "voxelize/bake.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <mutex>
#include <thread>

#include "voxelize/limits/directory_limit.h"
#include "voxelize/limits/memory_limit.h"
#include "voxelize/limits/region.h"
#include "voxelize/object_bake.h"
#include "voxelize/tree/tree_box.h"
#include "voxelize/tree/tree_builder.h"

namespace forcelayer::voxelize {
namespace {

using Objects = std::span<const SceneObject>;

// Fractions of a bake's time at which its stages end, as sample_data/bay.json has them at 1 and 0.5
// mm: the objects, the distances of nodes, equal ones shared, the values of nodes. Equal ones are
// shared to the end.
struct StageEnds {
  double objects, distances, shared, values;
};
StageEnds stage_ends(const BakeOptions& options) {
  if (!grows_surface(options)) return {0.37, 0.37, 0.37, 0.76};
  if (!stores_distances(options)) return {0.6, 0.6, 0.6, 0.8};
  if (grows_objects(options)) return {0.4, 0.84, 0.9, 0.94};
  return {0.11, 0.75, 0.85, 0.91};
}

void show_progress(const BakeOptions& options, const char* stage, double fraction_done) {
  if (options.progress) options.progress(stage, fraction_done);
}

// Calls step(i) for every object, in parallel. The first error by the order of the objects.
template <class Step>
Status for_each_object(std::size_t count, Step&& step) {
  std::vector<Status> results(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { results[i] = step(i); });
  const auto failed =
      std::find_if(results.begin(), results.end(), [](const Status& status) { return !status; });
  return failed == results.end() ? Status{} : *failed;
}

// Whether the triangles are too many for memory.
bool spills(Objects objects, const BakeOptions& options) {
  // Two triangles share a vertex, about.
  constexpr std::size_t kBytes = sizeof(mesh::Triangle) + sizeof(lattice::LatticePoint) / 2;
  std::size_t triangles = 0;
  for (const SceneObject& object : objects) {
    triangles += object.mesh != nullptr ? object.mesh->triangles.size() : object.triangle_count;
  }
  return triangles > options.max_triangle_bytes / kBytes;
}

// Every object with its facts: found in the cache, or snapped.
Result<std::vector<ObjectBake>> snap_objects(Objects objects, const BakeOptions& options,
                                             MeshAccess& meshes) {
  std::vector<ObjectBake> bakes(objects.size());
  tbb::parallel_for(std::size_t{0}, objects.size(),
                    [&](std::size_t i) { find_in_cache(objects[i], options, bakes[i]); });
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Status snapped = snap_unless_cached(objects[i], options, meshes, bakes[i]);
    if (!snapped) return snapped.error();
  }
  return bakes;
}

// The voxels of the scene that a bake keeps.
struct SceneRegion {
  limits::Region region;
  limits::Directory directory;  // empty where the region can hold nothing
  std::vector<char> skipped;    // [objects] cannot touch the region
};

distance::CodeScale scale_of(const BakeOptions& options) {
  const double layer = force_layer_voxels(options);
  const double range = options.range_m > 0 ? options.range_m / options.voxel_size_m
                                           : distance::kUsualRangeVoxels + layer - 1;
  return distance::code_scale(interior_radius_units(options), range, layer);
}

// How many layers of voxels lie around what the layers are counted from: the interior's, and those
// of the force layer.
unsigned counted_layers(const BakeOptions& options) {
  return grows_surface(options) ? 1 : options.layers;
}
unsigned force_layers_of(const BakeOptions& options) {
  return force_layers(force_layer_voxels(options));
}

// How many voxels around the geometry may have a value or a distance of their own. Without stored
// distances it is the same, so that the values' tree is.
int reach_of(const BakeOptions& options) {
  const auto force = static_cast<int>(force_layers_of(options));
  if (!grows_surface(options)) return static_cast<int>(options.layers) + force;
  const auto interior = static_cast<int>(interior_radius_units(options) / lattice::kSnapUnits) + 1;
  return std::max(interior + force + 1, distance::DistanceCodes::reach(scale_of(options)));
}

Result<SceneRegion> choose_region(const std::vector<ObjectBake>& bakes,
                                  const BakeOptions& options) {
  const bool empty = std::all_of(bakes.begin(), bakes.end(),
                                 [](const ObjectBake& bake) { return bake.facts.triangles == 0; });
  if (empty) return Error{ErrorCode::kMeshEmpty, "", "", "the scene has no triangles", ""};
  SceneRegion result;
  masks::VoxelBox scene;
  for (const ObjectBake& bake : bakes) scene.include(bake.facts.box);
  result.region =
      limits::region_of(scene.grown(reach_of(options)), options.roi_m, options.voxel_size_m);
  const bool cropped = result.region.cropped_sides != 0;
  const masks::VoxelBox within_reach = result.region.box.grown(reach_of(options) + 1);
  bool any = false;
  for (const ObjectBake& bake : bakes) {
    const masks::VoxelBox& box = bake.facts.box;
    result.skipped.push_back(cropped && !box.overlaps(within_reach));
    if (result.skipped.back() || box.empty()) continue;
    any = true;
    if (!cropped) continue;
    // The object is filled from all of its triangles, so all of its voxels must be addressable.
    const auto fits = limits::fit_directory(box.joined(within_reach), options.voxel_size_m);
    if (!fits) return fits.error();
  }
  if (!any) return result;
  const auto directory = limits::fit_directory(result.region.box, options.voxel_size_m);
  if (!directory) return directory.error();
  result.directory = *directory;
  return result;
}

// Bytes of memory at the peak that a node takes at least: measured with one thread on axis-parallel
// lines of 2000 and 8000 nodes in the middle and on an edge of nodes, less a twentieth.
limits::NodeBytes node_bytes(const BakeOptions& options) {
  if (stores_distances(options)) return {17e3, 11.4e3};
  if (grows_surface(options)) return {5.7e3, 11.4e3};
  return {9.5e3, 6.6e3};
}

// Whether the machine can hold the voxels of the objects; `skipped` [objects] are not baked. Those
// that wait in the cache are left out: another bake held them.
Status fit_machine(Objects objects, const std::vector<ObjectBake>& bakes,
                   const std::vector<char>& skipped, bool cropped, const BakeOptions& options) {
  const double available = limits::available_bytes();
  std::vector<limits::NamedObject> baked;
  for (std::size_t i = 0; i < bakes.size(); ++i) {
    if (skipped[i] != 0) continue;
    const Status fits =
        limits::fit_memory(bakes[i].snapped, objects[i].name, options.voxel_size_m, available);
    if (!fits) return fits;
    baked.push_back({&bakes[i].snapped, objects[i].name});
  }
  limits::NodeBytes bytes = node_bytes(options);
  if (cropped) bytes.reached = 0;
  return limits::fit_nodes(baked, std::min(reach_of(options), 63), bytes, options.voxel_size_m,
                           available);
}

// The union of the objects' voxels, counted from the directory's origin.
struct SceneVoxels {
  masks::MaskTree geometry, interior, grown;

  // The voxels that layers are counted from.
  const masks::MaskTree& counted(const BakeOptions& options) const {
    return grows_surface(options) ? grown : geometry;
  }
};

// Bakes the objects side by side; each is united as soon as it is done.
Status unite_objects(Objects objects, const BakeOptions& options, const SceneRegion& region,
                     MeshAccess& meshes, std::vector<ObjectBake>& bakes, SceneVoxels& scene) {
  std::mutex uniting;
  double all_work = 0, done = 0;
  const auto work_of = [](const SceneObject& object) { return 1 + object.work; };
  for (const SceneObject& object : objects) all_work += work_of(object);
  return for_each_object(objects.size(), [&](std::size_t i) -> Status {
    if (region.skipped[i]) return {};
    auto voxels = object_voxels(objects[i], options, region.directory.origin, meshes, bakes[i]);
    if (!voxels) return voxels.error();
    const std::lock_guard lock(uniting);
    Stopwatch watch;
    if (stores_distances(options) || !grows_surface(options)) {
      masks::unite(scene.geometry, std::move(*voxels->geometry));
    }
    if (voxels->grown) masks::unite(scene.grown, std::move(*voxels->grown));
    masks::unite(scene.interior, std::move(*voxels->interior));
    bakes[i].seconds.unite = watch.lap_s();
    done += work_of(objects[i]);
    show_progress(options, "voxels", stage_ends(options).objects * done / all_work);
    return {};
  });
}

// The kept voxels, counted from the directory's origin.
masks::KeptBox kept_box(const SceneRegion& region) {
  const masks::VoxelBox& box = region.region.box;
  masks::Coord low, high;
  for (std::size_t d = 0; d < 3; ++d) {
    low[static_cast<int>(d)] = static_cast<int>(box.low[d] - region.directory.origin[d]);
    high[static_cast<int>(d)] = static_cast<int>(box.high[d] - region.directory.origin[d]);
  }
  return {{low, high}, region.region.cropped_sides};
}

bool remembers_nodes(const BakeOptions& options, const masks::KeptBox& kept) {
  return options.cache != nullptr && !options.scene_name.empty() && !kept.cropped();
}

// The values: layers around the geometry. In a grown surface the interior's are in it already.
tree::VoxelTree build_layers(const SceneVoxels& scene, const SceneRegion& region,
                             const BakeOptions& options, distance::ValueCounts& counts,
                             Bake& bake) {
  const masks::KeptBox kept = kept_box(region);
  const distance::LayerOffset offset(scene.counted(options), scene.interior,
                                     counted_layers(options), force_layers_of(options), kept);
  const auto progress = [&, ends = stage_ends(options)](double fraction) {
    show_progress(options, "force layer", ends.shared + (ends.values - ends.shared) * fraction);
  };
  if (!remembers_nodes(options, kept)) {
    return tree::build_tree(offset, region.directory.dims, nullptr, counts, progress);
  }
  const tree::NodeMemory memory(*options.cache, options.scene_name, options.voxel_size_m);
  tree::VoxelTree tree = tree::build_tree(offset, region.directory.dims, &memory, counts, progress);
  bake.nodes = memory.asked();
  bake.reused_nodes = memory.found();
  return tree;
}

// Distances from the snapped meshes, and the nearest objects.
tree::DistanceTrees build_distances(const SceneVoxels& scene, const SceneRegion& region,
                                    const std::vector<ObjectBake>& bakes,
                                    const BakeOptions& options, MeshAccess& meshes, Bake& bake) {
  std::vector<const scan::SnappedObject*> objects;
  std::vector<cache::Digest> keys;
  std::vector<std::uint16_t> numbers;
  for (std::size_t i = 0; i < bakes.size(); ++i) {
    if (region.skipped[i]) continue;
    objects.push_back(&bakes[i].snapped);
    if (bakes[i].key) keys.push_back(*bakes[i].key);
    if (stores_objects(options, bakes.size())) {
      numbers.push_back(static_cast<std::uint16_t>(i + 1));
    }
  }
  const masks::KeptBox kept = kept_box(region);
  const auto reach = static_cast<unsigned>(distance::DistanceCodes::reach(scale_of(options)));
  const distance::LayerOffset around(scene.geometry, scene.interior, reach - 1, 1, kept);
  const bool has_memory = remembers_nodes(options, kept) && keys.size() == objects.size();
  const distance::DistanceCodes distances(
      std::move(objects), region.directory.origin, scene.geometry, scene.interior,
      scale_of(options), kept, grows_objects(options) ? 0 : interior_radius_units(options),
      std::move(numbers), meshes.spill_file());
  const auto progress = [&, ends = stage_ends(options)](double fraction) {
    show_progress(options, "distances", ends.objects + (ends.distances - ends.objects) * fraction);
  };
  if (!has_memory) {
    return tree::build_distance_trees(around, distances, region.directory.dims, nullptr, progress);
  }
  const tree::DistanceMemory memory(*options.cache, options.scene_name, options.voxel_size_m,
                                    std::move(keys));
  tree::DistanceTrees trees =
      tree::build_distance_trees(around, distances, region.directory.dims, &memory, progress);
  bake.distance_nodes = memory.asked();
  bake.reused_distance_nodes = memory.found();
  return trees;
}

// The box of all voxels that are not free.
masks::VoxelBox tight_box_of(const tree::VoxelTree& tree, const SceneRegion& region,
                             const BakeOptions& options) {
  // Where nothing is cropped, Chebyshev layers end where the region does.
  if (region.region.cropped_sides == 0 && options.metric == Metric::kChebyshev) {
    return region.region.box;
  }
  return tree::tight_box(tree, region.directory.dims).shifted(region.directory.origin);
}

}  // namespace

VoxmapHeader header_lengths(const BakeOptions& options) {
  VoxmapHeader header{};
  header.voxel_size_m = options.voxel_size_m;
  header.offset_layers = options.layers;
  header.metric = static_cast<std::uint32_t>(options.metric);
  if (!grows_surface(options)) return header;
  const distance::CodeScale scale = scale_of(options);
  header.zero_force_m = scale.zero_force * options.voxel_size_m;
  header.force_depth_m = scale.force_depth * options.voxel_size_m;
  if (!stores_distances(options)) return header;
  header.distance_quantum_m = scale.quantum * options.voxel_size_m;
  header.distance_zero_code = scale.zero_code;
  return header;
}

namespace {

VoxmapHeader header_of(const SceneRegion& region, const masks::VoxelBox& tight,
                       const distance::ValueCounts& counts, const BakeOptions& options) {
  VoxmapHeader header = header_lengths(options);
  header.valid_min_voxel = region.region.box.low;
  header.cropped_sides = region.region.cropped_sides;
  for (std::size_t d = 0; d < 3; ++d) {
    header.valid_max_voxel[d] = region.region.box.high[d] + 1;
    if (tight.empty()) continue;
    header.origin_voxel[d] = tight.low[d];
    header.dims_voxels[d] = static_cast<std::uint64_t>(tight.high[d] - tight.low[d] + 1);
  }
  header.directory_origin = region.directory.origin;
  header.directory_dims = region.directory.dims;
  header.interior_voxels = counts.interior;
  header.surface_voxels = counts.surface;
  header.proximity_voxels = counts.proximity;
  return header;
}

// The trees of the scene and the header.
void build_map(SceneVoxels& scene, const SceneRegion& region, const std::vector<ObjectBake>& bakes,
               const BakeOptions& options, MeshAccess& meshes, Bake& bake) {
  distance::ValueCounts counts;
  masks::VoxelBox tight;
  if (!region.directory.empty()) {
    if (stores_distances(options)) {
      tree::DistanceTrees trees = build_distances(scene, region, bakes, options, meshes, bake);
      bake.distances = std::move(trees.distances);
      bake.nearest_objects = std::move(trees.objects);
      if (trees.grown) masks::unite(scene.grown, std::move(*trees.grown));
    }
    bake.values = build_layers(scene, region, options, counts, bake);
    tight = tight_box_of(bake.values, region, options);
  }
  bake.header = header_of(region, tight, counts, options);
  if (stores_distances(options)) {
    bake.compliance = compliance_table(options.compliance, bake.header.distance_quantum_m);
  }
}

// Names the objects that the map distinguishes.
void add_names(Objects objects, const BakeOptions& options, Bake& bake) {
  if (!stores_objects(options, objects.size())) return;
  bake.header.object_count = static_cast<std::uint32_t>(objects.size());
  for (const SceneObject& object : objects) add_object_name(object.name, bake.object_names);
}

// Moves the objects' reports and times into the bake.
void add_reports(Objects objects, std::vector<ObjectBake>& bakes, const std::vector<char>& skipped,
                 Bake& bake) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const cache::ObjectFacts& facts = bakes[i].facts;
    bake.objects.push_back({objects[i].name, facts.triangles, facts.degenerate_triangles,
                            facts.geometry_voxels, facts.interior_voxels, facts.cavity_count,
                            std::move(bakes[i].cavities), bakes[i].from_cache, skipped[i] != 0});
    const StageSeconds& seconds = bakes[i].seconds;
    bake.seconds.scan += seconds.scan;
    bake.seconds.flood += seconds.flood;
    bake.seconds.near += seconds.near;
    bake.seconds.cavities += seconds.cavities;
    bake.seconds.cache += seconds.cache;
    bake.seconds.unite += seconds.unite;
  }
}

// How far the objects' snapped meshes may lie from the truth.
double static_deviation_m(Objects objects, const std::vector<ObjectBake>& bakes,
                          const BakeOptions& options) {
  double max_m = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    max_m = std::max(max_m, bakes[i].facts.snap_error_m + objects[i].deviation_m);
  }
  return max_m + options.mesh_deviation_m;
}

Result<Bake> bake_scene(Objects objects, const BakeOptions& options) {
  Bake bake;
  Stopwatch watch;
  MeshAccess meshes;
  if (spills(objects, options)) meshes.spill.emplace();
  show_progress(options, "reading vertices", 0);
  auto bakes = snap_objects(objects, options, meshes);
  if (!bakes) return bakes.error();
  const auto region = choose_region(*bakes, options);
  if (!region) return region.error();
  const Status fits =
      fit_machine(objects, *bakes, region->skipped, region->region.cropped_sides != 0, options);
  if (!fits) return fits.error();
  bake.seconds.snap = watch.lap_s();

  SceneVoxels scene;
  const Status united = unite_objects(objects, options, *region, meshes, *bakes, scene);
  if (!united) return united.error();

  watch.lap_s();
  show_progress(options, stores_distances(options) ? "distances" : "force layer",
                stage_ends(options).objects);
  build_map(scene, *region, *bakes, options, meshes, bake);
  add_names(objects, options, bake);
  for (const ObjectBake& object : *bakes) bake.header.triangles += object.facts.triangles;
  bake.header.static_deviation_m = static_deviation_m(objects, *bakes, options);
  if (meshes.spill) bake.bytes_on_disk = meshes.spill->bytes_on_disk();
  bake.seconds.tree = watch.lap_s();
  add_reports(objects, *bakes, region->skipped, bake);
  show_progress(options, "force layer", 1);
  return bake;
}

// Stops where bake_scene() begins to take memory for voxels.
Result<Bake> try_scene(Objects objects, const BakeOptions& options) {
  MeshAccess meshes;
  if (spills(objects, options)) meshes.spill.emplace();
  const auto bakes = snap_objects(objects, options, meshes);
  if (!bakes) return bakes.error();
  const auto region = choose_region(*bakes, options);
  if (!region) return region.error();
  const Status fits =
      fit_machine(objects, *bakes, region->skipped, region->region.cropped_sides != 0, options);
  if (!fits) return fits.error();
  return Bake{};
}

Result<Bake> bake_objects(Objects objects, const BakeOptions& options) {
  Bake bake;
  Stopwatch watch;
  MeshAccess meshes;
  if (spills(objects, options)) meshes.spill.emplace();
  auto bakes = snap_objects(objects, options, meshes);
  if (!bakes) return bakes.error();
  const std::vector<char> skipped(objects.size());
  const Status fits = fit_machine(objects, *bakes, skipped, /*cropped=*/true, options);
  if (!fits) return fits.error();
  bake.seconds.snap = watch.lap_s();
  bake.header.voxel_size_m = options.voxel_size_m;

  masks::VoxelBox scene;
  for (const ObjectBake& object : *bakes) scene.include(object.facts.box);
  if (!scene.empty()) {
    const auto directory = limits::fit_directory(scene, options.voxel_size_m);
    if (!directory) return directory.error();
    std::mutex counting;
    std::size_t done = 0;
    const Status baked = for_each_object(objects.size(), [&](std::size_t i) -> Status {
      ObjectBake& object = (*bakes)[i];
      object.from_cache = object.cached.has_value();
      if (!object.from_cache) {
        const auto voxels = bake_voxels(objects[i], options, directory->origin, meshes, object);
        if (!voxels) return voxels.error();
      }
      const std::lock_guard lock(counting);
      show_progress(options, "voxels",
                    static_cast<double>(++done) / static_cast<double>(objects.size()));
      return {};
    });
    if (!baked) return baked.error();
  }
  add_reports(objects, *bakes, skipped, bake);
  return bake;
}

// Runs a bake on as many threads as the options say.
Result<Bake> run_on_threads(Objects objects, const BakeOptions& options,
                            Result<Bake> (*run)(Objects, const BakeOptions&)) {
  if (Status checked = check_options(options); !checked) return checked.error();
  const int threads = options.threads > 0
                          ? options.threads
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  return tbb::task_arena(threads).execute([&] { return run(objects, options); });
}

}  // namespace

Result<Bake> bake(std::span<const SceneObject> objects, const BakeOptions& options) {
  return run_on_threads(objects, options, bake_scene);
}

Status check_size(std::span<const SceneObject> objects, const BakeOptions& options) {
  const auto tried = run_on_threads(objects, options, try_scene);
  return tried ? Status() : tried.error();
}

Result<Bake> bake_shard(std::span<const SceneObject> objects, const BakeOptions& options) {
  return run_on_threads(objects, options, bake_objects);
}

}  // namespace forcelayer::voxelize
