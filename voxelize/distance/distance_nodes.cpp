#include "voxelize/distance/distance_nodes.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "voxelize/distance/cell_search.h"
#include "voxelize/masks/brick_bits.h"
#include "voxelize/masks/node_rows.h"

namespace forcelayer {
namespace {

constexpr std::size_t kBrickVoxels = 512;

// Of voxels outside the solid the largest distance that matters, and of those inside.
float outer_reach(const DistanceScale& scale) { return static_cast<float>(scale.proximity_below); }
float inner_reach(const DistanceScale& scale) {
  return static_cast<float>(std::max(0.0, scale.range - scale.zero + scale.quantum));
}

}  // namespace

// One 64^3 node at a time.
class NodeDistances {
 public:
  BuiltNode run(const SceneTriangles& triangles, const VoxelIndex& scene_origin,
                const MaskTree& geometry, const MaskTree& interior, const DistanceScale& scale,
                const KeptBox& kept, const Coord& origin, ValueCounts& counts) {
    scale_ = &scale;
    interior_ = &interior;
    origin_ = origin;
    node_rows(interior, origin, solid_);
    node_rows(geometry, origin, surface_);
    touched_ = {};
    NodeIndex node;
    for (std::size_t d = 0; d < 3; ++d) {
      node[d] = (origin[static_cast<int>(d)] + scene_origin[d]) >> 6;
    }
    triangles.gather(node, near_);
    const float outer = std::max(outer_reach(scale), inner_reach(scale));
    const float inner = inner_reach(scale);
    search_.run(
        near_,
        [&](const std::array<int, 3>& low, int edge) {
          return !all_set(solid_, low, edge) ? outer : inner > 0 ? inner : kNothingMatters;
        },
        [&](const std::array<int, 3>& low, NearList list) { measure(low, list, outer, inner); });
    if (kept.cropped()) crop(kept);
    return cut(counts);
  }

 private:
  std::uint8_t* codes_of(int brick) { return codes_.data() + brick * int{kBrickVoxels}; }

  // The codes of a brick in which something is measured; as if no surface were near at first.
  std::uint8_t* touched(unsigned n) {
    std::uint8_t* codes = codes_of(static_cast<int>(n));
    if (test(touched_, n)) return codes;
    set(touched_, n);
    const auto free = static_cast<std::uint8_t>(scale_->free_code);
    for (unsigned row = 0; row < 64; ++row, codes += 8) {
      const unsigned bits = solid_row(n, row);
      for (unsigned z = 0; z < 8; ++z) codes[z] = (bits >> z & 1) != 0 ? 0 : free;
    }
    return codes_of(static_cast<int>(n));
  }

  // Eight voxels along z of brick n, row = x*8 + y, as bits: those of the solid.
  unsigned solid_row(unsigned n, unsigned row) const {
    const unsigned x = (n >> 6) * 8 + (row >> 3), y = (n >> 3 & 7) * 8 + (row & 7);
    return static_cast<unsigned>(solid_[x * 64 + y] >> (8 * (n & 7)) & 0xff);
  }

  // Two cells of 4^3 voxels, the second behind the first along z.
  void measure(const std::array<int, 3>& low, NearList list, float outer, float inner) {
    std::array<float, 2 * kEighths> reach;
    for (std::size_t cell = 0; cell < 2; ++cell) {
      const std::uint64_t solid =
          cell_bits(solid_, {low[0], low[1], low[2] + 4 * static_cast<int>(cell)});
      for (unsigned n = 0; n < kEighths; ++n) {
        const bool all_solid = (solid & eighth(n)) == eighth(n);
        reach[cell * kEighths + n] = (!all_solid  ? outer
                                      : inner > 0 ? inner
                                                  : kNothingMatters) *
                                     static_cast<float>(kSnapUnits);
      }
    }
    nearest_.find(list, CellSearch::centers(low, 1), reach);
    for (std::size_t cell = 0; cell < 2; ++cell) {
      encode({low[0], low[1], low[2] + 4 * static_cast<int>(cell)}, cell, list);
    }
  }

  void encode(const std::array<int, 3>& low, std::size_t cell, NearList list) {
    const std::uint64_t solid = cell_bits(solid_, low);
    std::uint64_t negative = solid;
    for (std::uint64_t left = cell_bits(surface_, low) & ~solid; left != 0; left &= left - 1) {
      const int n = std::countr_zero(left);
      const NearTriangle& nearest = *list[nearest_.which(cell, static_cast<std::size_t>(n))];
      negative |= std::uint64_t{lies_inside(nearest, low, n)} << n;
    }
    std::array<std::uint8_t, kCubePoints> codes;
    codes_of_distances(nearest_.least(cell), negative, *scale_, codes.data());
    const auto brick = static_cast<unsigned>((low[0] >> 3) << 6 | (low[1] >> 3) << 3 | low[2] >> 3);
    std::uint8_t* out = touched(brick) + (low[0] & 7) * 64 + (low[1] & 7) * 8 + (low[2] & 7);
    for (int n = 0; n < 16; ++n) {
      std::memcpy(out + (n >> 2) * 64 + (n & 3) * 8, codes.data() + 4 * n, 4);
    }
  }

  // A voxel that the surface passes through is neither inside nor outside. Its centre lies on the
  // side to which the way from the surface's nearest point leads, a voxel and a quarter further on:
  // beyond the voxels that the same piece of surface passes through.
  bool lies_inside(const NearTriangle& nearest, const std::array<int, 3>& low, int n) const {
    constexpr double kOnwards = 1.25;
    const std::array<int, 3> voxel{low[0] + (n >> 4), low[1] + (n >> 2 & 3), low[2] + (n & 3)};
    std::array<double, 3> center;
    for (std::size_t d = 0; d < 3; ++d) center[d] = (voxel[d] + 0.5) * double{kSnapUnits};
    const std::array<double, 3> away = way_from(nearest, center);
    const double length = std::sqrt(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]);
    if (!(length > 0)) return false;
    // From the centre to the next voxel or the one before: by half a voxel.
    const double half = 0.5 / kOnwards * length;
    std::array<int, 3> onwards;
    bool in_node = true;
    for (std::size_t d = 0; d < 3; ++d) {
      onwards[d] = voxel[d] + (away[d] >= half) - (away[d] < -half);
      in_node = in_node && (onwards[d] & ~63) == 0;
    }
    if (in_node) {
      const auto row = static_cast<std::size_t>(onwards[0] * 64 + onwards[1]);
      return (solid_[row] >> onwards[2] & 1) != 0;
    }
    return interior_->isValueOn(origin_ + Coord(onwards[0], onwards[1], onwards[2]));
  }

  void crop(const KeptBox& kept) {
    const auto free = static_cast<std::uint8_t>(scale_->free_code);
    for (unsigned n = 0; n < kNodeEntries; ++n) {
      const Coord brick = entry_origin(origin_, n, 8);
      if (kept.box.isInside(openvdb::CoordBBox::createCube(brick, 8))) continue;
      std::uint8_t* codes = touched(n);
      for (unsigned v = 0; v < kBrickVoxels; ++v) {
        if (!kept.box.isInside(entry_origin(brick, v, 1))) codes[v] = free;
      }
    }
  }

  struct CodeRange {
    unsigned least, most;
  };
  CodeRange range_of(unsigned n) {
    // A brick in which nothing was measured holds no surface: it is solid or free throughout.
    if (!test(touched_, n)) {
      const unsigned code = solid_row(n, 0) != 0 ? 0 : scale_->free_code;
      return {code, code};
    }
    const std::uint8_t* codes = codes_of(static_cast<int>(n));
    // As bytes, so that vectors hold sixteen.
    std::uint8_t least = 255, most = 0;
    for (unsigned v = 0; v < kBrickVoxels; ++v) {
      least = std::min(least, codes[v]);
      most = std::max(most, codes[v]);
    }
    return {least, most};
  }

  BuiltNode cut(ValueCounts& counts) {
    BuiltNode node;
    const unsigned parts = scale_->bits / 2;
    std::array<CodeRange, kNodeEntries> ranges;
    std::size_t bricks = 0;
    for (unsigned n = 0; n < kNodeEntries; ++n) {
      ranges[n] = range_of(n);
      bricks += ranges[n].least != scale_->free_code && ranges[n].most != 0;
    }
    node.bricks.reserve(bricks * parts);
    node.nearness.reserve(bricks);
    for (unsigned n = 0; n < kNodeEntries; ++n) {
      const std::uint8_t* codes = codes_of(static_cast<int>(n));
      if (ranges[n].least == scale_->free_code) {
        node.entries[n] = kFreeEntry;
        continue;
      }
      set(node.held, n);
      if (ranges[n].most == 0) {
        node.entries[n] = kInteriorEntry;
        counts.interior += kBrickVoxels;
        continue;
      }
      count(codes, counts);
      node.entries[n] = static_cast<std::uint32_t>(node.bricks.size() / parts);
      pack(codes, node.bricks);
      node.nearness.emplace_back(other_than(codes, static_cast<std::uint8_t>(scale_->free_code)));
    }
    return node;
  }

  void count(const std::uint8_t* codes, ValueCounts& counts) const {
    std::uint32_t interior = 0, surface = 0, proximity = 0;  // at most, by threshold
    for (unsigned v = 0; v < kBrickVoxels; ++v) {
      interior += codes[v] < scale_->surface_code;
      surface += codes[v] < scale_->proximity_code;
      proximity += codes[v] < scale_->free_code;
    }
    counts += {interior, surface - interior, proximity - surface};
  }

  // The voxels with another code, eight at a time.
  static BrickMask other_than(const std::uint8_t* codes, std::uint8_t code) {
    BrickMask mask;
    for (unsigned row = 0; row < 64; ++row) {
      std::uint64_t bytes;
      std::memcpy(&bytes, codes + 8 * row, 8);
      bytes ^= code * 0x0101010101010101u;
      // The high bit of each byte that is not zero, and those together.
      constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7fu;
      const std::uint64_t other = (((bytes & kLow) + kLow) | bytes) & ~kLow;
      mask.words[row >> 3] |= (other >> 7) * 0x0102040810204080u >> 56 << (8 * (row & 7));
    }
    return mask;
  }

  void pack(const std::uint8_t* codes, std::vector<Brick>& bricks) const {
    std::array<std::uint8_t, kBrickVoxels> bytes;
    std::size_t count = kBrickVoxels;
    if (scale_->bits == 8) {
      std::memcpy(bytes.data(), codes, count);
    } else {
      count /= 2;
      for (std::size_t i = 0; i < count; ++i) {
        bytes[i] = static_cast<std::uint8_t>(codes[2 * i] | codes[2 * i + 1] << 4);
      }
    }
    for (std::size_t at = 0; at < count; at += sizeof(Brick)) {
      std::memcpy(bricks.emplace_back().data(), bytes.data() + at, sizeof(Brick));
    }
  }

  const DistanceScale* scale_ = nullptr;
  const MaskTree* interior_ = nullptr;
  Coord origin_;
  NodeRows solid_, surface_;
  BrickMask touched_;  // bricks whose codes are meant
  std::vector<NearTriangle> near_;
  CellSearch search_;
  NearestTriangles nearest_;
  std::vector<std::uint8_t> codes_ = std::vector<std::uint8_t>(512 * kBrickVoxels);
};

class DistanceScratch {
 public:
  tbb::enumerable_thread_specific<NodeDistances> nodes;
};

int DistanceNodes::reach(const DistanceScale& scale) {
  // A surface point lies within half a voxel of its voxel's centre along every axis.
  return static_cast<int>(std::ceil(std::max(outer_reach(scale), inner_reach(scale)) + 0.5f));
}

DistanceNodes::DistanceNodes(std::vector<const SnappedObject*> objects,
                             const VoxelIndex& scene_origin, const MaskTree& geometry,
                             const MaskTree& interior, const DistanceScale& scale,
                             const KeptBox& kept)
    : scene_origin_(scene_origin),
      geometry_(geometry),
      interior_(interior),
      scale_(scale),
      kept_(kept),
      triangles_(std::move(objects), reach(scale)),
      scratch_(std::make_unique<DistanceScratch>()) {}

DistanceNodes::~DistanceNodes() = default;

BuiltNode DistanceNodes::node(const Coord& origin, ValueCounts& counts) const {
  return scratch_->nodes.local().run(triangles_, scene_origin_, geometry_, interior_, scale_, kept_,
                                     origin, counts);
}

}  // namespace forcelayer
