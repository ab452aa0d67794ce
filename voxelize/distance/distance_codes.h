// Stored distances, node by node: codes of signed distances from the surface, and the objects to
// which these distances are.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "voxelize/distance/code_scale.h"
#include "voxelize/distance/euclidean_growth.h"
#include "voxelize/distance/nearest_objects.h"
#include "voxelize/distance/triangle_search.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/masks/node_rows.h"

namespace forcelayer::distance {

// The codes of one 64^3 node.
struct NodeDistances {
  masks::NodeRows solid;  // the interior's voxels
  lattice::BrickMask
      measured;  // bricks with codes of their own; the others are deep inside or far outside
  std::vector<std::uint8_t> codes =
      std::vector<std::uint8_t>(512 * kBrickVoxels);  // [bricks][voxels]; undefined elsewhere
  masks::NodeRows grown;                              // of CenterGrowth, outside the solid
  const NodeObjects* objects = nullptr;               // null where the map has no objects

  const std::uint8_t* brick(unsigned n) const { return codes.data() + n * kBrickVoxels; }
  // Eight voxels along z of brick n, row = x*8 + y, as bits: the solid ones.
  unsigned solid_row(unsigned n, unsigned row) const {
    const unsigned x = (n >> 6) * 8 + (row >> 3), y = (n >> 3 & 7) * 8 + (row & 7);
    return static_cast<unsigned>(solid[x * 64 + y] >> (8 * (n & 7)) & 0xff);
  }
};

// The trees and objects must outlive this; codes() may run on many threads. Distances are from the
// surfaces of `objects`. They are negative in voxels of `interior`, and in voxels of `geometry`
// whose center is inside of a closed surface or on the interior's side of an open one.
class DistanceCodes {
 public:
  // Voxels outside `kept` have the highest code. The surface grows by `growth_units`
  // (CenterGrowth); 0: it does not grow. `numbers` are the objects' numbers in the file, ascending,
  // from 1 on; without them the map has no objects.
  DistanceCodes(std::vector<const scan::SnappedObject*> objects,
                const lattice::VoxelIndex& scene_origin, const masks::MaskTree& geometry,
                const masks::MaskTree& interior, const CodeScale& scale, const masks::KeptBox& kept,
                std::int64_t growth_units, std::vector<std::uint16_t> numbers = {},
                scan::SpillFile* spill = nullptr);
  ~DistanceCodes();

  // How many voxels around the geometry may have a code of their own.
  static int reach(const CodeScale& scale);

  const CodeScale& scale() const { return scale_; }
  bool tells_objects() const { return !numbers_.empty(); }
  bool grows_surface() const { return growth_.has_value(); }
  const masks::MaskTree& geometry() const { return geometry_; }
  const masks::MaskTree& interior() const { return interior_; }

  // The node at `origin`, counted from the scene's, by its place in the world.
  scan::NodeIndex node_at(const masks::Coord& origin) const;
  // The objects that come within reach of it, ascending, and their numbers; no numbers where
  // objects are not told apart.
  std::vector<std::uint32_t> objects_near(const masks::Coord& origin) const;
  std::vector<std::uint32_t> numbers_near(const masks::Coord& origin) const;

  // The node at `origin`, counted from the scene's; valid until this thread's next call.
  const NodeDistances& codes(const masks::Coord& origin) const;

 private:
  class Scratch;

  lattice::VoxelIndex scene_origin_;
  const masks::MaskTree& geometry_;
  const masks::MaskTree& interior_;
  CodeScale scale_;
  masks::KeptBox kept_;
  SceneTriangles triangles_;
  std::optional<CenterGrowth> growth_;
  std::vector<std::uint16_t> numbers_;  // [objects]
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace forcelayer::distance
