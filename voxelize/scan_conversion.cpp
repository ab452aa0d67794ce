#include "voxelize/scan_conversion.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

#include "voxelize/node_bins.h"

namespace forcelayer {
namespace {

// Bits y*8 + z of `word` moved by (dy, dz), |dy|, |dz| < 8; what leaves the 8x8 square is lost.
std::uint64_t moved(std::uint64_t word, int dy, int dz) {
  constexpr std::uint64_t kColumns = 0x0101010101010101u;
  word = dz >= 0 ? (word << dz) & (kColumns * (0xffu << dz & 0xffu))
                 : (word >> -dz) & (kColumns * (0xffu >> -dz));
  return dy >= 0 ? word << (8 * dy) : word >> (-8 * dy);
}

// The bricks of one 64^3-voxel node while its triangles are drawn.
class NodeCanvas {
 public:
  // Clears the canvas and places it at the node whose lowest voxel is `origin` (world index).
  void begin(const VoxelIndex& origin) {
    origin_ = origin;
    touched_ = {};
  }

  void draw(const TriangleOverlap& triangle) {
    bool small = true;
    for (std::size_t d = 0; d < 3; ++d) {
      small &= triangle.max_voxel()[d] - triangle.min_voxel()[d] < 8;
    }
    small ? draw_small(triangle) : draw_large(triangle);
  }

  // The drawn bricks as a node at `origin`, voxels of the scene.
  std::unique_ptr<LowerMaskNode> finish(const Coord& origin) const {
    auto node = std::make_unique<LowerMaskNode>(origin, false, false);
    for_each_cell(touched_, [&](unsigned x, unsigned y, unsigned z) {
      const unsigned n = x << 6 | y << 3 | z;
      auto leaf = std::make_unique<MaskLeaf>(entry_origin(origin, n, 8), false);
      assign(*leaf, bricks_[n]);
      node->addLeaf(leaf.release());
    });
    return node;
  }

 private:
  BrickMask& brick(unsigned x, unsigned y, unsigned z) {
    const unsigned n = x << 6 | y << 3 | z;
    if (!touched_.test(x, y, z)) {
      touched_.words[x] |= std::uint64_t{1} << (y << 3 | z);
      bricks_[n] = {};
    }
    return bricks_[n];
  }

  // A triangle of at most 8 voxels a side: one test in a window that starts at its own lowest
  // voxel, and its bits moved into the up to eight bricks below the window.
  void draw_small(const TriangleOverlap& triangle) {
    const BrickMask window = triangle.cells(triangle.min_voxel());
    int low[3], shift[3];
    for (std::size_t d = 0; d < 3; ++d) {
      const std::int64_t offset = triangle.min_voxel()[d] - origin_[d];
      low[d] = static_cast<int>(offset >> 3);
      shift[d] = static_cast<int>(offset & 7);
    }
    for (int part = 0; part < 8; ++part) {
      const int bx = low[0] + (part & 1), by = low[1] + (part >> 1 & 1), bz = low[2] + (part >> 2);
      if ((bx | by | bz) < 0 || bx > 7 || by > 7 || bz > 7) continue;
      move_into(window, part, shift, bx, by, bz);
    }
  }

  void move_into(const BrickMask& window, int part, const int (&shift)[3], int bx, int by, int bz) {
    const int dy = shift[1] - 8 * (part >> 1 & 1), dz = shift[2] - 8 * (part >> 2);
    if (dy == -8 || dz == -8) return;
    const int dx = shift[0] - 8 * (part & 1);
    BrickMask part_mask;
    for (int x = std::max(0, -dx); x < std::min(8, 8 - dx); ++x) {
      part_mask.words[x + dx] = moved(window.words[x], dy, dz);
    }
    if (!part_mask.any()) return;
    BrickMask& target =
        brick(static_cast<unsigned>(bx), static_cast<unsigned>(by), static_cast<unsigned>(bz));
    for (int x = 0; x < 8; ++x) target.words[x] |= part_mask.words[x];
  }

  // Any other triangle: which bricks of the node it hits, then brick by brick.
  void draw_large(const TriangleOverlap& triangle) {
    for_each_cell(triangle.cells(origin_, 3), [&](unsigned x, unsigned y, unsigned z) {
      const BrickMask mask =
          triangle.cells({origin_[0] + 8 * x, origin_[1] + 8 * y, origin_[2] + 8 * z});
      BrickMask& target = brick(x, y, z);
      for (int i = 0; i < 8; ++i) target.words[i] |= mask.words[i];
    });
  }

  VoxelIndex origin_{};
  BrickMask touched_;
  std::array<BrickMask, 512> bricks_;
};

}  // namespace

std::unique_ptr<MaskTree> scan_convert(const SnappedObject& object,
                                       const VoxelIndex& scene_origin) {
  const NodeBins bins = bin_triangles(object);
  std::vector<std::unique_ptr<LowerMaskNode>> nodes(bins.nodes.size());
  tbb::enumerable_thread_specific<NodeCanvas> canvases;
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    NodeCanvas& canvas = canvases.local();
    const VoxelIndex& node = bins.nodes[i];
    const VoxelIndex origin = {node[0] * 64, node[1] * 64, node[2] * 64};
    canvas.begin(origin);
    for (std::size_t t = bins.first[i]; t < bins.first[i + 1]; ++t) {
      canvas.draw(TriangleOverlap(object.triangle(bins.triangles[t])));
    }
    nodes[i] = canvas.finish(Coord(static_cast<int>(origin[0] - scene_origin[0]),
                                   static_cast<int>(origin[1] - scene_origin[1]),
                                   static_cast<int>(origin[2] - scene_origin[2])));
  });

  auto tree = std::make_unique<MaskTree>();
  for (auto& node : nodes) {
    if (node->getChildMask().isOff()) continue;
    add_node(*tree, std::move(node));
  }
  return tree;
}

}  // namespace forcelayer
