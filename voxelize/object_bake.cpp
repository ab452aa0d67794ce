#include "voxelize/object_bake.h"

#include <cmath>

#include "voxelize/cache/cache_versions.h"
#include "voxelize/distance/euclidean_growth.h"
#include "voxelize/fill/cavities.h"
#include "voxelize/fill/flood.h"
#include "voxelize/limits/directory_limit.h"
#include "voxelize/limits/memory_limit.h"
#include "voxelize/scan/scan_conversion.h"

namespace forcelayer::voxelize {
namespace {

// The digest of everything that an object's voxels depend on; nothing where the object does not say
// what its mesh is. The scene, its region of interest and its layers (unless they grow its surface)
// are not in it.
std::optional<cache::Digest> object_key(const SceneObject& object, const BakeOptions& options) {
  if (!object.mesh_digest) return std::nullopt;
  cache::DigestBuilder digest;
  digest.text("part").value(cache::kObjectCacheVersion).value(*object.mesh_digest);
  for (const double x : object.world_from_mesh.linear) digest.value(x);
  for (const double x : object.world_from_mesh.translation) digest.value(x);
  digest.value(options.voxel_size_m);
  digest.bytes(std::as_bytes(std::span(options.free_seeds_m)));
  digest.bytes(std::as_bytes(std::span(object.free_seeds_m)));
  if (grows_objects(options)) {
    digest.value(interior_radius_units(options)).value(cache::kGrowthCacheVersion);
  }
  return digest.finish();
}

bool knows_enough(const cache::ObjectFacts& facts, const BakeOptions& options) {
  return (!options.find_cavities || (facts.knows & cache::ObjectFacts::kCavities) != 0) &&
         (!options.find_narrow_passages ||
          (facts.knows & cache::ObjectFacts::kNarrowPassages) != 0);
}

Result<std::shared_ptr<const mesh::Mesh>> mesh_of(const SceneObject& object, MeshAccess& meshes) {
  if (object.mesh != nullptr) {
    return std::shared_ptr<const mesh::Mesh>(std::shared_ptr<const mesh::Mesh>(), object.mesh);
  }
  const std::lock_guard lock(meshes.reading);
  return object.read_mesh();
}

Status snap(const SceneObject& object, const BakeOptions& options, MeshAccess& meshes,
            ObjectBake& bake) {
  const auto mesh = mesh_of(object, meshes);
  if (!mesh) return mesh.error();
  auto snapped = scan::snap_object(**mesh, object.world_from_mesh, options.voxel_size_m,
                                   object.name, meshes.spill_file());
  if (!snapped) return snapped.error();
  if (!meshes.spill) bake.mesh = *mesh;
  bake.snapped = std::move(*snapped);
  return {};
}

cache::ObjectFacts facts_of(const scan::SnappedObject& snapped) {
  cache::ObjectFacts facts;
  facts.triangles = snapped.triangles.size();
  facts.degenerate_triangles = scan::degenerate_triangles(snapped);
  facts.box = snapped.box;
  facts.snap_error_m = snapped.snap_error_m;
  return facts;
}

Error seed_in_surface(const mesh::Vec3d& seed_m, const std::string& object) {
  char where[120];
  std::snprintf(where, sizeof where, "free seed %g,%g,%g", seed_m[0], seed_m[1], seed_m[2]);
  return {ErrorCode::kSceneInvalid, "", where,
          "lies in a voxel that the surface of " + object + " crosses",
          "move the seed away from the surface, or use a smaller voxel size"};
}

// The free seeds in an object's box (outside it everything is free), as voxels counted from
// `origin`. An error (kSceneInvalid) where one lies in `geometry`.
Result<std::vector<masks::Coord>> seed_voxels(const SceneObject& object, const BakeOptions& options,
                                              const masks::VoxelBox& box,
                                              const masks::MaskTree& geometry,
                                              const lattice::VoxelIndex& origin) {
  std::vector<masks::Coord> voxels;
  for (const auto* seeds_m : {&options.free_seeds_m, &object.free_seeds_m}) {
    for (const mesh::Vec3d& seed_m : *seeds_m) {
      masks::Coord voxel;
      bool inside = true;
      for (std::size_t d = 0; d < 3 && inside; ++d) {
        const double at = std::floor(seed_m[d] / options.voxel_size_m);
        inside = at >= static_cast<double>(box.low[d]) && at <= static_cast<double>(box.high[d]);
        if (inside) {
          voxel[static_cast<int>(d)] = static_cast<int>(static_cast<std::int64_t>(at) - origin[d]);
        }
      }
      if (!inside) continue;
      if (geometry.isValueOn(voxel)) return seed_in_surface(seed_m, object.name);
      voxels.push_back(voxel);
    }
  }
  return voxels;
}

// The largest of an interior's pieces; `count` becomes the number of all.
std::vector<fill::Cavity> cavities_of(const masks::MaskTree& interior,
                                      const lattice::VoxelIndex& scene_origin,
                                      std::uint64_t& count) {
  std::vector<fill::Cavity> cavities;
  const std::vector<fill::InteriorPiece> pieces = fill::interior_pieces(interior);
  count = pieces.size();
  for (const fill::InteriorPiece& piece : pieces) {
    if (cavities.size() == fill::kMaxReportedCavities) break;
    fill::Cavity& cavity = cavities.emplace_back();
    cavity.voxels = piece.voxels;
    for (std::size_t d = 0; d < 3; ++d) {
      cavity.seed_voxel[d] = piece.seed[static_cast<int>(d)] + scene_origin[d];
    }
  }
  return cavities;
}

// Sets Cavity::opens_at_half_size: floods the object again at half the voxel size. A piece of the
// interior touches no surface, so the flood reaches all of it or none.
Status find_narrow_passages(const SceneObject& object, const BakeOptions& options,
                            const mesh::Mesh& mesh, std::vector<fill::Cavity>& cavities) {
  if (cavities.empty()) return {};
  BakeOptions halved = options;
  halved.voxel_size_m /= 2;
  const auto snapped =
      scan::snap_object(mesh, object.world_from_mesh, halved.voxel_size_m, object.name);
  if (!snapped) return snapped.error();
  const auto directory = limits::fit_directory(snapped->box, halved.voxel_size_m);
  Status fits = directory ? limits::fit_memory(*snapped, object.name, halved.voxel_size_m,
                                               limits::available_bytes())
                          : directory.error();
  if (!fits) {
    Error error = fits.error();
    error.mend = "leave out --narrow-passages, which bakes at half the voxel size";
    return error;
  }
  const auto geometry = scan::scan_convert(*snapped, directory->origin);
  const auto seeds = seed_voxels(object, halved, snapped->box, *geometry, directory->origin);
  if (!seeds) return {};
  const auto interior = fill::flood_interior(*geometry, *seeds);
  for (fill::Cavity& cavity : cavities) {
    masks::Coord voxel;  // at the middle of the cavity's seed voxel
    for (std::size_t d = 0; d < 3; ++d) {
      voxel[static_cast<int>(d)] =
          static_cast<int>(2 * cavity.seed_voxel[d] + 1 - directory->origin[d]);
    }
    cavity.opens_at_half_size = !interior->isValueOn(voxel) && !geometry->isValueOn(voxel);
  }
  return {};
}

}  // namespace

void find_in_cache(const SceneObject& object, const BakeOptions& options, ObjectBake& bake) {
  if (options.cache == nullptr) return;
  bake.key = object_key(object, options);
  if (bake.key) bake.cached = cache::CachedObject::find(*options.cache, *bake.key);
  if (bake.cached && !knows_enough(bake.cached->facts(), options)) bake.cached.reset();
  if (!bake.cached) return;
  bake.facts = bake.cached->facts();
  bake.cavities = bake.cached->cavities();
}

Status snap_unless_cached(const SceneObject& object, const BakeOptions& options, MeshAccess& meshes,
                          ObjectBake& bake) {
  if (bake.cached) return {};
  if (Status snapped = snap(object, options, meshes, bake); !snapped) return snapped;
  bake.facts = facts_of(bake.snapped);
  return {};
}

Result<cache::ObjectVoxels> object_voxels(const SceneObject& object, const BakeOptions& options,
                                          const lattice::VoxelIndex& scene_origin,
                                          MeshAccess& meshes, ObjectBake& bake) {
  if (!bake.cached) return bake_voxels(object, options, scene_origin, meshes, bake);
  Stopwatch watch;
  auto voxels = bake.cached->voxels(scene_origin);
  bake.cached.reset();
  if (!voxels || stores_distances(options)) {
    if (Status snapped = snap(object, options, meshes, bake); !snapped) return snapped.error();
  }
  if (!voxels) {
    bake.facts = facts_of(bake.snapped);
    bake.cavities.clear();
    return bake_voxels(object, options, scene_origin, meshes, bake);
  }
  bake.from_cache = true;
  bake.seconds.cache += watch.lap_s();
  return std::move(*voxels);
}

Result<cache::ObjectVoxels> bake_voxels(const SceneObject& object, const BakeOptions& options,
                                        const lattice::VoxelIndex& scene_origin, MeshAccess& meshes,
                                        ObjectBake& bake) {
  Stopwatch watch;
  cache::ObjectVoxels voxels;
  voxels.geometry = scan::scan_convert(bake.snapped, scene_origin);
  if (meshes.spill) meshes.spill->touched(bake.snapped.bytes());
  bake.seconds.scan = watch.lap_s();
  const auto seeds = seed_voxels(object, options, bake.facts.box, *voxels.geometry, scene_origin);
  if (!seeds) return seeds.error();
  voxels.interior = fill::flood_interior(*voxels.geometry, *seeds);
  bake.facts.geometry_voxels = masks::voxel_count(*voxels.geometry);
  bake.facts.interior_voxels = masks::voxel_count(*voxels.interior);
  bake.seconds.flood = watch.lap_s();
  if (grows_objects(options)) {
    voxels.grown = distance::grow_surface(bake.snapped, *voxels.interior,
                                          interior_radius_units(options), scene_origin);
  }
  bake.seconds.near = watch.lap_s();
  if (!stores_distances(options)) bake.snapped = {}, bake.mesh.reset();
  if (options.find_cavities || options.find_narrow_passages) {
    bake.cavities = cavities_of(*voxels.interior, scene_origin, bake.facts.cavity_count);
    bake.facts.knows |= cache::ObjectFacts::kCavities;
  }
  if (options.find_narrow_passages) {
    const auto mesh = mesh_of(object, meshes);
    if (!mesh) return mesh.error();
    const Status found = find_narrow_passages(object, options, **mesh, bake.cavities);
    if (!found) return found.error();
    bake.facts.knows |= cache::ObjectFacts::kNarrowPassages;
  }
  bake.seconds.cavities = watch.lap_s();
  if (bake.key) {
    cache::keep_object(*options.cache, *bake.key, bake.facts, bake.cavities, voxels, scene_origin);
  }
  bake.seconds.cache += watch.lap_s();
  return voxels;
}

}  // namespace forcelayer::voxelize
