// Box dilation of one 64^3-voxel node by three radii at once, on rows of 64 voxels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace forcelayer::distance {

// The two-bit values of a 64^3 node as rows along z: value = low + 2 high, [x*64 + y], bit z.
struct alignas(64) NodeCodes {
  std::array<std::uint64_t, 4096> low, high;
};

// Voxels of a node by value.
struct ValueCounts {
  std::uint64_t interior = 0, surface = 0, proximity = 0;

  ValueCounts& operator+=(const ValueCounts& other) {
    interior += other.interior;
    surface += other.surface;
    proximity += other.proximity;
    return *this;
  }
};

// The set voxels of a node and of `halo` voxels around it, as planes of constant x of rows along z.
// A row has three words: the 64 voxels below the node, those of the node, and those above.
class NodeHalo {
 public:
  static constexpr int kMaxHalo = 31;

  // Empties the halo and sets the layers of offset_node(): k, and n of the force layer. Its depth
  // is k + n, at most kMaxHalo.
  void begin(int layers, int force_layers);

  int halo() const { return halo_; }
  // The radii of offset_node(), ascending: k - 1, k - 1 + n and k + n.
  int radius(int i) const {
    return i == 2 ? halo_ : i == 1 ? halo_ - 1 : halo_ - 1 - force_layers_;
  }
  int width() const { return width_; }  // planes, and rows of a plane
  bool empty() const { return planes_ == 0; }
  bool occupied(int plane) const { return occupied_[static_cast<std::size_t>(plane)] != 0; }

  // The rows of a plane (0 .. width-1) for writing: word 0 below, 1 in, 2 above the node. The plane
  // counts as occupied from then on.
  std::uint64_t* rows(int plane, int word);
  const std::uint64_t* rows(int plane, int word) const {
    return rows_.data() + static_cast<std::size_t>((plane * 3 + word) * stride());
  }

  // Words from one row array to the next; rows beyond the width may be read.
  int stride() const { return (width_ + 15) / 8 * 8; }

 private:
  int halo_ = 0, force_layers_ = 1, width_ = 0, planes_ = 0;
  std::vector<std::uint64_t> rows_;
  std::vector<std::uint8_t> occupied_;

  friend ValueCounts offset_node(NodeHalo& halo, NodeCodes& codes);
  std::vector<std::uint64_t> dilated_;  // [plane][radius][64] rows, dilated along z and y
};

// With D(r) the voxels within Chebyshev distance r of a set voxel and I codes.low on entry:
// interior where D(k-1) or I, surface where D(k-1+n) otherwise, proximity where D(k+n) but neither
// D(k-1+n) nor I (paper 4.2, where n is 1). D(-1) is empty.
ValueCounts offset_node(NodeHalo& halo, NodeCodes& codes);

}  // namespace forcelayer::distance
