#include "voxelize/sweep/inner_triangles.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "voxelize/fill/flood.h"
#include "voxelize/limits/directory_limit.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/masks/voxel_box.h"
#include "voxelize/scan/scan_conversion.h"
#include "voxelize/scan/snap.h"

namespace forcelayer::sweep {
namespace {

constexpr int kNear = 2;              // voxels
constexpr int kWide = 8 + 2 * kNear;  // voxels of a brick and around it
using Around = std::array<bool, kWide * kWide * kWide>;

std::size_t place(int x, int y, int z) {
  return static_cast<std::size_t>((x * kWide + y) * kWide + z);
}

// Sets what is within kNear voxels along one axis of what is set.
void spread(Around& around, int axis) {
  const Around before = around;
  const int step = axis == 0 ? kWide * kWide : axis == 1 ? kWide : 1;
  for (int x = 0; x < kWide; ++x) {
    for (int y = 0; y < kWide; ++y) {
      for (int z = 0; z < kWide; ++z) {
        const int along = axis == 0 ? x : axis == 1 ? y : z;
        if (!before[place(x, y, z)]) continue;
        for (int n = std::max(-kNear, -along); n <= std::min(kNear, kWide - 1 - along); ++n) {
          around[static_cast<std::size_t>(static_cast<int>(place(x, y, z)) + n * step)] = true;
        }
      }
    }
  }
}

// Voxels of the surface that are near the outside.
class NearOutside {
 public:
  NearOutside(const masks::MaskTree& geometry, const masks::MaskTree& interior) {
    for (auto upper = geometry.cbeginChildOn(); upper; ++upper) {
      for (auto lower = upper->cbeginChildOn(); lower; ++lower) {
        for (auto leaf = lower->cbeginChildOn(); leaf; ++leaf) add(*leaf, geometry, interior);
      }
    }
  }

  bool holds(const lattice::VoxelIndex& voxel) const {
    const auto found = bricks_.find(brick_of(voxel));
    return found != bricks_.end() && found->second.test(static_cast<unsigned>(voxel[0] & 7),
                                                        static_cast<unsigned>(voxel[1] & 7),
                                                        static_cast<unsigned>(voxel[2] & 7));
  }

 private:
  static lattice::VoxelIndex brick_of(const lattice::VoxelIndex& voxel) {
    return {voxel[0] >> 3, voxel[1] >> 3, voxel[2] >> 3};
  }

  void add(const masks::MaskLeaf& leaf, const masks::MaskTree& geometry,
           const masks::MaskTree& interior) {
    const masks::Coord low = leaf.origin();
    Around outside;
    for (int x = 0; x < kWide; ++x) {
      for (int y = 0; y < kWide; ++y) {
        for (int z = 0; z < kWide; ++z) {
          const masks::Coord voxel = low.offsetBy(x - kNear, y - kNear, z - kNear);
          outside[place(x, y, z)] = !geometry.isValueOn(voxel) && !interior.isValueOn(voxel);
        }
      }
    }
    for (const int axis : {0, 1, 2}) spread(outside, axis);
    lattice::BrickMask near;
    lattice::for_each_cell(masks::brick_of(leaf), [&](unsigned x, unsigned y, unsigned z) {
      const auto at = [](unsigned n) { return static_cast<int>(n) + kNear; };
      if (outside[place(at(x), at(y), at(z))]) near.words[x] |= std::uint64_t{1} << (y * 8 + z);
    });
    bricks_.emplace(brick_of({low[0], low[1], low[2]}), near);
  }

  std::unordered_map<lattice::VoxelIndex, lattice::BrickMask, masks::IndexHash> bricks_;
};

// Whether a voxel of the box around the triangle is near the outside. A box of many voxels is not
// looked through.
bool may_be_near(const lattice::LatticeTriangle& triangle, const lattice::VoxelIndex& origin,
                 const NearOutside& near) {
  lattice::VoxelIndex low, high;
  double voxels = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto [least, largest] = std::minmax({triangle[0][d], triangle[1][d], triangle[2][d]});
    low[d] = (least >> lattice::kSnapBits) - origin[d];
    high[d] = (largest >> lattice::kSnapBits) - origin[d];
    voxels *= static_cast<double>(high[d] - low[d] + 1);
  }
  constexpr double kMany = 4096;
  if (voxels > kMany) return true;
  for (std::int64_t x = low[0]; x <= high[0]; ++x) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        if (near.holds({x, y, z})) return true;
      }
    }
  }
  return false;
}

}  // namespace

Status drop_inner_triangles(mesh::Mesh& mesh, double voxel_size_m, const std::string& name) {
  const auto snapped = scan::snap_object(mesh, {}, voxel_size_m, name);
  if (!snapped) return snapped.error();
  if (snapped->box.empty()) return {};
  const auto directory = limits::fit_directory(snapped->box, voxel_size_m);
  if (!directory) return directory.error();
  const auto geometry = scan::scan_convert(*snapped, directory->origin);
  const auto interior = fill::flood_interior(*geometry, {});
  const NearOutside near(*geometry, *interior);
  std::vector<mesh::Triangle> kept;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (may_be_near(snapped->triangle(t), directory->origin, near)) {
      kept.push_back(mesh.triangles[t]);
    }
  }
  mesh.triangles = std::move(kept);
  return {};
}

}  // namespace forcelayer::sweep
