// A dense array of voxel values as a valid .vox file: slow, small and obviously right.
//
//   DenseVoxels scene({-4, 0, 0}, {8, 8, 8}, 0.005);
//   scene.set(-4, 0, 0, VoxelValue::kSurface);
//   BuiltVoxmap built(scene);                // a Voxmap in memory: built.voxmap()
//   write_dense_voxmap("scene.vox", scene);  // the same on disk
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "formats/voxmap.h"
#include "formats/voxmap_writer.h"
#include "tests/support/aligned_bytes.h"

namespace forcelayer::testing {

using VoxelIndex = std::array<std::int64_t, 3>;

// A half-open box of voxels.
struct VoxelBox {
  VoxelIndex low{0, 0, 0};
  VoxelIndex high{0, 0, 0};

  bool empty() const { return low[0] >= high[0] || low[1] >= high[1] || low[2] >= high[2]; }
};

inline VoxelBox intersection(const VoxelBox& a, const VoxelBox& b) {
  VoxelBox both;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    both.low[axis] = std::max(a.low[axis], b.low[axis]);
    both.high[axis] = std::min(a.high[axis], b.high[axis]);
  }
  return both;
}

template <typename Function>
void for_each_voxel(const VoxelBox& box, Function function) {
  for (std::int64_t i = box.low[0]; i < box.high[0]; ++i) {
    for (std::int64_t j = box.low[1]; j < box.high[1]; ++j) {
      for (std::int64_t k = box.low[2]; k < box.high[2]; ++k) function(VoxelIndex{i, j, k});
    }
  }
}

// Chebyshev distance in voxels from a box to a voxel: 0 inside, 1 where they touch.
inline std::int64_t voxel_distance(const VoxelBox& box, const VoxelIndex& voxel) {
  std::int64_t distance = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    distance =
        std::max({distance, box.low[axis] - voxel[axis], voxel[axis] - (box.high[axis] - 1)});
  }
  return distance;
}

// Values of a box of voxels in world indices; everything outside it is free.
class DenseVoxels {
 public:
  DenseVoxels(VoxelIndex lowest, std::array<std::int64_t, 3> extent, double voxel_size_m)
      : box_{lowest, {lowest[0] + extent[0], lowest[1] + extent[1], lowest[2] + extent[2]}},
        voxel_size_m_(voxel_size_m),
        values_(static_cast<std::size_t>(extent[0] * extent[1] * extent[2]), VoxelValue::kFree) {}

  bool holds(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return voxel_distance(box_, {i, j, k}) == 0;
  }
  VoxelValue value(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return holds(i, j, k) ? values_[at(i, j, k)] : VoxelValue::kFree;
  }
  void set(std::int64_t i, std::int64_t j, std::int64_t k, VoxelValue value) {
    if (!holds(i, j, k)) throw std::out_of_range("voxel outside the dense box");
    values_[at(i, j, k)] = value;
  }
  // All voxels of [low, high) at once.
  void fill(const VoxelIndex& low, const VoxelIndex& high, VoxelValue value) {
    for_each_voxel({low, high}, [&](const VoxelIndex& v) { set(v[0], v[1], v[2], value); });
  }

  // An interior box with one layer of surface and one of proximity, where nothing stands yet.
  void add_solid(const VoxelIndex& low, const VoxelIndex& high) {
    fill(shifted(low, -2), shifted(high, 2), VoxelValue::kProximity);
    fill(shifted(low, -1), shifted(high, 1), VoxelValue::kSurface);
    fill(low, high, VoxelValue::kInterior);
  }

  const VoxelBox& box() const { return box_; }
  double voxel_size_m() const { return voxel_size_m_; }

 private:
  static VoxelIndex shifted(const VoxelIndex& voxel, std::int64_t by) {
    return {voxel[0] + by, voxel[1] + by, voxel[2] + by};
  }
  std::size_t at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const std::int64_t rows = box_.high[1] - box_.low[1], columns = box_.high[2] - box_.low[2];
    return static_cast<std::size_t>(((i - box_.low[0]) * rows + (j - box_.low[1])) * columns +
                                    (k - box_.low[2]));
  }

  VoxelBox box_;
  double voxel_size_m_;
  std::vector<VoxelValue> values_;
};

// The choices that the voxels leave open: the tree's shape, and header fields not about voxels.
struct DenseVoxmapOptions {
  bool share_equal_nodes = true;      // store equal bricks and nodes once
  bool collapse_uniform = true;       // uniform boxes as one entry, else bricks all the way down
  bool clearances = false;            // true clearances (slow), else 0: unknown
  std::uint32_t max_clearance = 600;  // clearances end here
  std::uint32_t offset_layers = 2;
  double static_deviation_m = 0;
  std::uint32_t cropped_sides = 0;  // CroppedSide bits
  VoxelBox valid_box{};             // world voxels; the tight box where this is empty
  std::string provenance = "{}";
};

// The tree's arrays, owned; content() is what the writer takes.
class DenseTree {
 public:
  DenseTree(const DenseVoxels& voxels, const DenseVoxmapOptions& options)
      : voxels_(voxels), options_(options) {
    for_each_voxel(voxels.box(), [&](const VoxelIndex& v) { count(v); });
    fill_header();
    for_each_voxel(directory_box(), [&](const VoxelIndex& block) {
      VoxelIndex low{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = header_.directory_origin[axis] + kUpperNodeEdge * block[axis];
      }
      directory_.push_back(entry_of(low, kUpperNodeEdge));
    });
  }

  // Valid while this lives.
  VoxmapContent content() const {
    VoxmapContent content;
    content.header = header_;
    content.values = {directory_, upper_.words, lower_.words, bricks_.words};
    content.provenance = options_.provenance;
    return content;
  }
  VoxmapHeader& header() { return header_; }

 private:
  // One level's section, and where each stored element is.
  struct Level {
    std::vector<std::uint32_t> words;
    std::map<std::vector<std::uint32_t>, std::uint32_t> known;
    std::uint32_t count = 0;
  };

  static std::int64_t block_of(std::int64_t i) { return i >= 0 ? i / 512 : -((511 - i) / 512); }

  VoxelBox directory_box() const {
    const auto& dims = header_.directory_dims;
    return {{0, 0, 0}, {dims[0], dims[1], dims[2]}};
  }

  void count(const VoxelIndex& v) {
    const VoxelValue value = voxels_.value(v[0], v[1], v[2]);
    if (value == VoxelValue::kFree) return;
    if (boundary_.empty()) tight_ = {v, v};
    if (has_free_neighbour(v)) boundary_.push_back(v);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      tight_.low[axis] = std::min(tight_.low[axis], v[axis]);
      tight_.high[axis] = std::max(tight_.high[axis], v[axis] + 1);
    }
    header_.interior_voxels += value == VoxelValue::kInterior;
    header_.surface_voxels += value == VoxelValue::kSurface;
    header_.proximity_voxels += value == VoxelValue::kProximity;
  }

  bool has_free_neighbour(const VoxelIndex& v) const {
    bool found = false;
    for_each_voxel({{v[0] - 1, v[1] - 1, v[2] - 1}, {v[0] + 2, v[1] + 2, v[2] + 2}},
                   [&](const VoxelIndex& n) {
                     found |= voxels_.value(n[0], n[1], n[2]) == VoxelValue::kFree;
                   });
    return found;
  }

  void fill_header() {
    header_.voxel_size_m = voxels_.voxel_size_m();
    header_.offset_layers = options_.offset_layers;
    header_.static_deviation_m = options_.static_deviation_m;
    header_.cropped_sides = options_.cropped_sides;
    const VoxelBox& valid = options_.valid_box.empty() ? tight_ : options_.valid_box;
    header_.valid_min_voxel = valid.low;
    header_.valid_max_voxel = valid.high;
    if (boundary_.empty()) return;
    header_.origin_voxel = tight_.low;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t first = block_of(tight_.low[axis]), last = block_of(tight_.high[axis] - 1);
      header_.dims_voxels[axis] = static_cast<std::uint64_t>(tight_.high[axis] - tight_.low[axis]);
      header_.directory_origin[axis] = first * kUpperNodeEdge;
      header_.directory_dims[axis] = static_cast<std::uint32_t>(last - first + 1);
    }
  }

  // Whether all voxels of `box` have one value, and which.
  std::pair<bool, VoxelValue> uniform_value_of(const VoxelBox& box) const {
    const VoxelBox part = intersection(box, voxels_.box());
    const VoxelValue first = voxels_.value(box.low[0], box.low[1], box.low[2]);
    bool uniform = true;
    std::int64_t seen = 0;
    if (!part.empty()) {
      for_each_voxel(part, [&](const VoxelIndex& v) {
        uniform &= voxels_.value(v[0], v[1], v[2]) == first;
        ++seen;
      });
    }
    const std::int64_t edge = box.high[0] - box.low[0];
    const bool reaches_outside = seen < edge * edge * edge;
    return {uniform && (!reaches_outside || first == VoxelValue::kFree), first};
  }

  // The Chebyshev distance to the nearest voxel that is not free or, beyond a cropped side,
  // unknown; at most max_clearance.
  std::uint32_t clearance_of(const VoxelBox& box) const {
    std::int64_t nearest = options_.max_clearance;
    for (const VoxelIndex& v : boundary_) nearest = std::min(nearest, voxel_distance(box, v));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t below = box.low[axis] - header_.valid_min_voxel[axis] + 1;
      const std::int64_t above = header_.valid_max_voxel[axis] - box.high[axis] + 1;
      if (options_.cropped_sides & (1u << (2 * axis))) nearest = std::min(nearest, below);
      if (options_.cropped_sides & (2u << (2 * axis))) nearest = std::min(nearest, above);
    }
    return static_cast<std::uint32_t>(std::max<std::int64_t>(nearest, 0));
  }

  // The entry of the box of `edge` voxels at `low`; stores the nodes and bricks below it.
  std::uint32_t entry_of(const VoxelIndex& low, std::int64_t edge) {
    const VoxelBox box{low, {low[0] + edge, low[1] + edge, low[2] + edge}};
    const bool holds_voxels = !intersection(box, voxels_.box()).empty();
    const auto [uniform, value] = uniform_value_of(box);
    if (uniform && (options_.collapse_uniform || !holds_voxels)) {
      const bool with_clearance = options_.clearances && value == VoxelValue::kFree;
      return uniform_entry(static_cast<std::uint32_t>(value),
                           with_clearance ? clearance_of(box) : 0);
    }
    if (edge == kBrickEdge) return store(bricks_, brick_words(low));
    std::vector<std::uint32_t> entries;
    for_each_voxel({{0, 0, 0}, {8, 8, 8}}, [&](const VoxelIndex& c) {
      const std::int64_t e = edge / 8;
      entries.push_back(entry_of({low[0] + c[0] * e, low[1] + c[1] * e, low[2] + c[2] * e}, e));
    });
    return store(edge == kUpperNodeEdge ? upper_ : lower_, entries);
  }

  std::vector<std::uint32_t> brick_words(const VoxelIndex& low) const {
    std::vector<std::uint32_t> words(kNodeEntries * 2 / 32, 0);
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const auto value = static_cast<std::uint32_t>(
          voxels_.value(low[0] + (n >> 6), low[1] + ((n >> 3) & 7), low[2] + (n & 7)));
      words[n / 16] |= value << (2 * (n % 16));
    }
    return words;
  }

  std::uint32_t store(Level& level, const std::vector<std::uint32_t>& words) {
    const auto found = level.known.find(words);
    if (found != level.known.end() && options_.share_equal_nodes) return found->second;
    level.words.insert(level.words.end(), words.begin(), words.end());
    level.known[words] = level.count;
    return level.count++;
  }

  const DenseVoxels& voxels_;
  DenseVoxmapOptions options_;
  VoxmapHeader header_{};
  // The non-free voxels beside a free one: of a nearest voxel to a free box, the next one towards
  // the box is free.
  std::vector<VoxelIndex> boundary_;
  VoxelBox tight_{};
  std::vector<std::uint32_t> directory_;
  Level upper_, lower_, bricks_;
};

// The bytes of a valid .vox file with these voxels.
inline AlignedBytes dense_voxmap_bytes(const DenseVoxels& voxels,
                                       const DenseVoxmapOptions& options = {}) {
  return AlignedBytes(voxmap_bytes(DenseTree(voxels, options).content()));
}

// A Voxmap in memory with these voxels. Movable; throws where the reader refuses the bytes.
class BuiltVoxmap {
 public:
  explicit BuiltVoxmap(const DenseVoxels& voxels, const DenseVoxmapOptions& options = {})
      : bytes_(dense_voxmap_bytes(voxels, options)),
        voxmap_(checked(
            Voxmap::from_bytes(bytes_.bytes(), "dense voxels", Verify::kStructureAndChecksums))) {}

  const Voxmap& voxmap() const { return voxmap_; }

 private:
  static Voxmap checked(Result<Voxmap> result) {
    if (!result) throw std::runtime_error(to_line(result.error()));
    return std::move(*result);
  }

  AlignedBytes bytes_;
  Voxmap voxmap_;
};

// Writes a valid .vox file with these voxels; throws on failure.
inline void write_dense_voxmap(const std::filesystem::path& path, const DenseVoxels& voxels,
                               const DenseVoxmapOptions& options = {}) {
  const auto written = write_voxmap(path, DenseTree(voxels, options).content());
  if (!written) throw std::runtime_error(to_line(written.error()));
}

}  // namespace forcelayer::testing
