#include "voxelize/cache/part_cache.h"

#include "voxelize/cache/byte_pack.h"
#include "voxelize/cache/cache_versions.h"
#include "voxelize/cache/mask_pack.h"
#include "voxelize/distance/near_voxels.h"

namespace forcelayer {
namespace {

constexpr const char* kKind = "part";

struct CavityRecord {
  std::uint64_t voxels;
  VoxelIndex seed_voxel;
  std::uint64_t opens_at_half_size;
};

void add_seeds(DigestBuilder& digest, const std::vector<Vec3d>& seeds_m) {
  digest.bytes(std::as_bytes(std::span(seeds_m)));
}

}  // namespace

std::optional<Digest> part_key(const SceneObject& object, const BakeOptions& options) {
  if (!object.mesh_digest) return std::nullopt;
  DigestBuilder digest;
  digest.text(kKind).value(kPartCacheVersion).value(*object.mesh_digest);
  for (const double x : object.world_from_mesh.linear) digest.value(x);
  for (const double x : object.world_from_mesh.translation) digest.value(x);
  digest.value(options.voxel_size_m);
  add_seeds(digest, options.free_seeds_m);
  add_seeds(digest, object.free_seeds_m);
  if (grows_surface(options)) {
    digest.value(interior_radius_units(options.layers)).value(kNearVoxelsCacheVersion);
  }
  return digest.finish();
}

std::optional<CachedPart> CachedPart::find(const CacheFolder& cache, const Digest& key) {
  auto entry = cache.find(kKind, key);
  if (!entry) return std::nullopt;
  try {
    ByteUnpacker unpacker(entry->bytes());
    CachedPart part(std::move(*entry));
    part.facts_ = unpacker.value<PartFacts>();
    const auto cavities = unpacker.list<CavityRecord>();
    for (const CavityRecord& c : cavities) {
      part.cavities_.push_back({c.voxels, c.seed_voxel, c.opens_at_half_size != 0});
    }
    return part;
  } catch (const BadPack&) {
    return std::nullopt;
  }
}

std::optional<PartVoxels> CachedPart::voxels(const VoxelIndex& scene_origin) const {
  try {
    ByteUnpacker unpacker(entry_.bytes());
    unpacker.value<PartFacts>();
    unpacker.list<CavityRecord>();
    PartVoxels voxels;
    // Grown by near_voxels() it reaches beyond the box of the mesh.
    voxels.geometry = unpack(unpacker, scene_origin, facts_.box.grown(kMaxBakedLayers));
    voxels.interior = unpack(unpacker, scene_origin, facts_.box);
    unpacker.expect_end();
    return voxels;
  } catch (const BadPack&) {
    return std::nullopt;
  }
}

void keep_part(const CacheFolder& cache, const Digest& key, const PartFacts& facts,
               const std::vector<Cavity>& cavities, const PartVoxels& voxels,
               const VoxelIndex& scene_origin) {
  std::vector<CavityRecord> records;
  for (const Cavity& c : cavities) {
    records.push_back({c.voxels, c.seed_voxel, c.opens_at_half_size});
  }
  BytePacker packer;
  packer.value(facts);
  packer.list(records);
  pack(*voxels.geometry, scene_origin, packer);
  pack(*voxels.interior, scene_origin, packer);
  cache.keep(kKind, key, packer.bytes());
}

}  // namespace forcelayer
