#include "voxelize/cache/object_cache.h"

#include "voxelize/cache/byte_pack.h"
#include "voxelize/cache/mask_pack.h"
#include "voxelize/distance/euclidean_growth.h"

namespace forcelayer::cache {
namespace {

constexpr const char* kKind = "part";

struct CavityRecord {
  std::uint64_t voxels;
  lattice::VoxelIndex seed_voxel;
  std::uint64_t opens_at_half_size;
};

}  // namespace

std::optional<CachedObject> CachedObject::find(const CacheFolder& cache, const Digest& key) {
  auto entry = cache.find(kKind, key);
  if (!entry) return std::nullopt;
  try {
    ByteUnpacker unpacker(entry->bytes());
    CachedObject object(std::move(*entry));
    object.facts_ = unpacker.value<ObjectFacts>();
    const auto cavities = unpacker.list<CavityRecord>();
    for (const CavityRecord& c : cavities) {
      object.cavities_.push_back({c.voxels, c.seed_voxel, c.opens_at_half_size != 0});
    }
    return object;
  } catch (const BadPack&) {
    return std::nullopt;
  }
}

std::optional<ObjectVoxels> CachedObject::voxels(const lattice::VoxelIndex& scene_origin) const {
  try {
    ByteUnpacker unpacker(entry_.bytes());
    unpacker.value<ObjectFacts>();
    unpacker.list<CavityRecord>();
    ObjectVoxels voxels;
    voxels.geometry = unpack(unpacker, scene_origin, facts_.box);
    voxels.interior = unpack(unpacker, scene_origin, facts_.box);
    if (unpacker.value<std::uint64_t>() != 0) {
      // It reaches beyond the box of the mesh.
      voxels.grown = unpack(unpacker, scene_origin, facts_.box.grown(distance::kMaxBakedLayers));
    }
    unpacker.expect_end();
    return voxels;
  } catch (const BadPack&) {
    return std::nullopt;
  }
}

void keep_object(const CacheFolder& cache, const Digest& key, const ObjectFacts& facts,
                 const std::vector<fill::Cavity>& cavities, const ObjectVoxels& voxels,
                 const lattice::VoxelIndex& scene_origin) {
  std::vector<CavityRecord> records;
  for (const fill::Cavity& c : cavities) {
    records.push_back({c.voxels, c.seed_voxel, c.opens_at_half_size});
  }
  BytePacker packer;
  packer.value(facts);
  packer.list(records);
  pack(*voxels.geometry, scene_origin, packer);
  pack(*voxels.interior, scene_origin, packer);
  packer.value(std::uint64_t{voxels.grown != nullptr});
  if (voxels.grown) pack(*voxels.grown, scene_origin, packer);
  cache.keep(kKind, key, packer.bytes());
}

}  // namespace forcelayer::cache
