#include "voxelize/scan/scan_conversion.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

#include "formats/lattice/brick_bits.h"
#include "voxelize/scan/large_triangle.h"
#include "voxelize/scan/node_bins.h"
#include "voxelize/scan/node_canvas.h"
#include "voxelize/scan/small_triangles.h"

namespace forcelayer::scan {
namespace {

// Draws the triangles of one 64^3-voxel node at a time.
class NodeDrawing {
 public:
  // Starts with an empty node whose lowest voxel is `origin` (world index).
  void begin(const lattice::VoxelIndex& origin) {
    origin_ = origin;
    canvas_.clear();
  }

  void draw(const lattice::LatticeTriangle& triangle) {
    lattice::LatticeTriangle corners;  // from the node's lowest corner
    std::array<int, 3> low_voxel, high_voxel;
    std::int64_t max_voxels = 0, extent = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k][d] = triangle[k][d] - (origin_[d] << lattice::kSnapBits);
      }
      const std::int64_t low = std::min({corners[0][d], corners[1][d], corners[2][d]});
      const std::int64_t high = std::max({corners[0][d], corners[1][d], corners[2][d]});
      low_voxel[d] = static_cast<int>(low >> lattice::kSnapBits);
      high_voxel[d] = static_cast<int>(high >> lattice::kSnapBits);
      max_voxels =
          std::max(max_voxels, (high >> lattice::kSnapBits) - (low >> lattice::kSnapBits) + 1);
      extent = std::max(extent, high - low);
    }
    if (max_voxels <= SmallTriangles::kMaxVoxels) {
      small_.draw(corners, low_voxel, high_voxel, canvas_);
    } else if (extent <= kLargeTriangleUnits) {
      draw_large_triangle(corners, canvas_);
    } else {
      draw_huge(lattice::TriangleOverlap(triangle));
    }
  }

  // The drawing, as a node at `origin` (voxels of the scene).
  std::unique_ptr<masks::LowerMaskNode> finish(const masks::Coord& origin) {
    small_.finish(canvas_);
    auto node = std::make_unique<masks::LowerMaskNode>(origin, false, false);
    lattice::for_each_set(canvas_.touched, [&](unsigned n) {
      auto leaf = std::make_unique<masks::MaskLeaf>(masks::entry_origin(origin, n, 8), false);
      masks::assign(*leaf, canvas_.bricks[n]);
      node->addLeaf(leaf.release());
    });
    return node;
  }

 private:
  // For a triangle of any extent: the bricks of the node that it hits, then brick by brick.
  void draw_huge(const lattice::TriangleOverlap& triangle) {
    lattice::for_each_cell(triangle.cells(origin_, 3), [&](unsigned x, unsigned y, unsigned z) {
      const lattice::BrickMask mask =
          triangle.cells({origin_[0] + 8 * x, origin_[1] + 8 * y, origin_[2] + 8 * z});
      if (!mask.any()) return;
      lattice::BrickMask& target = canvas_.brick(x, y, z);
      target = target | mask;
    });
  }

  lattice::VoxelIndex origin_{};
  NodeCanvas canvas_;
  SmallTriangles small_;
};

}  // namespace

std::unique_ptr<masks::MaskTree> scan_convert(const SnappedObject& object,
                                              const lattice::VoxelIndex& scene_origin) {
  const NodeBins bins = bin_triangles(object);
  std::vector<std::unique_ptr<masks::LowerMaskNode>> nodes(bins.nodes.size());
  tbb::enumerable_thread_specific<NodeDrawing> drawings;
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    NodeDrawing& drawing = drawings.local();
    const lattice::VoxelIndex& node = bins.nodes[i];
    const lattice::VoxelIndex origin = {node[0] * 64, node[1] * 64, node[2] * 64};
    drawing.begin(origin);
    for (std::size_t t = bins.first[i]; t < bins.first[i + 1]; ++t) {
      drawing.draw(object.triangle(bins.triangles[t]));
    }
    nodes[i] = drawing.finish(masks::Coord(static_cast<int>(origin[0] - scene_origin[0]),
                                           static_cast<int>(origin[1] - scene_origin[1]),
                                           static_cast<int>(origin[2] - scene_origin[2])));
  });

  auto tree = std::make_unique<masks::MaskTree>();
  for (auto& node : nodes) {
    if (node->getChildMask().isOff()) continue;
    masks::add_node(*tree, std::move(node));
  }
  return tree;
}

}  // namespace forcelayer::scan
