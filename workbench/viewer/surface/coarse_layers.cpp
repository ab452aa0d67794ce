#include "workbench/viewer/surface/coarse_layers.h"

#include <algorithm>
#include <vector>

#include "workbench/viewer/surface/layer_surface.h"

namespace forcelayer::viewer {
namespace {

constexpr int kBlockEdge = 8;  // cells

std::uint64_t key_of(const RelativeVoxel& block) {
  std::uint64_t key = 0;
  for (const std::int32_t at : block) key = key << 21 | (static_cast<std::uint32_t>(at) & 0x1fffff);
  return key;
}

// Cells of a block, in the order of a brick's voxels.
std::size_t place_in_block(const RelativeVoxel& cell) {
  return static_cast<std::size_t>((cell[0] & 7) << 6 | (cell[1] & 7) << 3 | (cell[2] & 7));
}

RelativeVoxel shifted_right(RelativeVoxel v, int bits) {
  for (std::int32_t& at : v) at >>= bits;
  return v;
}

// A cell with several values takes the one of the greatest weight.
constexpr int weight_of(VoxelValue value) {
  constexpr std::array<int, 4> kWeight = {0, 2, 3, 1};  // free, interior, surface, proximity
  return kWeight[static_cast<unsigned>(value)];
}

}  // namespace

struct CoarseLayers::Layer {
  const CoarseLayers& layers;
  VoxelValue layer;

  bool contains(const RelativeVoxel& cell) const { return layers.value(cell) == layer; }
  bool borders(const RelativeVoxel& cell) const {
    return lies_further_out(layers.value(cell), layer);
  }
};

CoarseLayers::CoarseLayers(const Voxmap& voxmap, int edge_voxels)
    : voxmap_(voxmap), edge_(edge_voxels) {
  walk_tree(
      voxmap.view(),
      [&](const RelativeVoxel& low, std::int32_t edge, std::uint32_t code) {
        const bool filled = static_cast<VoxelValue>(code) != VoxelValue::kFree;
        if (filled && edge < kBlockEdge * edge_) add_block(low);
      },
      [&](const RelativeVoxel& low) { add_block(low); });
}

// The block around a voxel, where it is not there yet.
void CoarseLayers::add_block(const RelativeVoxel& low_voxel) {
  RelativeVoxel block = low_voxel;
  for (std::int32_t& at : block) at /= kBlockEdge * edge_;
  const auto [found, fresh] = blocks_.try_emplace(key_of(block));
  if (!fresh) return;
  for (std::size_t n = 0; n < found->second.size(); ++n) {
    const auto at = static_cast<std::int32_t>(n);
    found->second[n] =
        value_of_voxels({kBlockEdge * block[0] + (at >> 6), kBlockEdge * block[1] + (at >> 3 & 7),
                         kBlockEdge * block[2] + (at & 7)});
  }
}

VoxelValue CoarseLayers::value_of_voxels(const RelativeVoxel& cell) const {
  VoxelValue value = VoxelValue::kFree;
  for (std::int32_t x = 0; x < edge_; ++x) {
    for (std::int32_t y = 0; y < edge_; ++y) {
      for (std::int32_t z = 0; z < edge_; ++z) {
        const VoxelValue one = relative_value(
            voxmap_, {edge_ * cell[0] + x, edge_ * cell[1] + y, edge_ * cell[2] + z});
        if (weight_of(one) > weight_of(value)) value = one;
      }
    }
  }
  return value;
}

VoxelValue CoarseLayers::value(const RelativeVoxel& cell) const {
  const auto block = blocks_.find(key_of(shifted_right(cell, 3)));
  if (block != blocks_.end()) return block->second[place_in_block(cell)];
  // Uniform boxes alone, none smaller than a cell.
  return relative_value(voxmap_, {edge_ * cell[0], edge_ * cell[1], edge_ * cell[2]});
}

QuadSurface CoarseLayers::surface(VoxelValue layer, const glm::dvec3& origin_m) const {
  const VoxmapView& view = voxmap_.view();
  std::array<std::int64_t, 3> origin = view.directory_origin;  // whole blocks of 512 voxels
  for (std::int64_t& at : origin) at /= edge_;
  QuadWriter writer(origin, edge_ * voxmap_.voxel_size_m(), origin_m, Faces::kMerged);
  const Layer set{*this, layer};
  FaceFinder<Layer> finder(set, writer);
  walk_tree(
      view,
      [&](const RelativeVoxel& low, std::int32_t edge, std::uint32_t code) {
        if (static_cast<VoxelValue>(code) != layer || edge < kBlockEdge * edge_) return;
        finder.uniform_box({low[0] / edge_, low[1] / edge_, low[2] / edge_}, edge / edge_);
      },
      [](const RelativeVoxel&) {});
  std::vector<std::uint64_t> keys;  // the same picture whatever the table's order
  for (const auto& [key, block] : blocks_) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  for (const std::uint64_t key : keys) {
    const auto at = [&](int shift) {
      return kBlockEdge * static_cast<std::int32_t>(key >> shift & 0x1fffff);
    };
    finder.brick({at(42), at(21), at(0)});
  }
  return writer.take();
}

}  // namespace forcelayer::viewer
