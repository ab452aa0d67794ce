// Small scenes for tests: a dense box of voxel values, and the .vox file of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "formats/voxmap.h"
#include "formats/voxmap_writer.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {

using Voxel = std::array<std::int64_t, 3>;

// Values of the voxels min + [0, dims), free outside.
struct VoxelScene {
  double voxel_size_m = 0.005;
  Voxel min{};
  Voxel dims{};
  std::uint32_t layers = 2;
  std::vector<std::uint8_t> values;  // z fastest
  Metric metric = Metric::kChebyshev;

  // At 4 and 8 bits: what the header says, and the codes beside the values.
  struct Wide {
    std::uint32_t bits = 2;
    double range_m = 0, quantum_m = 0;
    std::uint32_t zero_code = 0, surface_code = 0, proximity_code = 0, free_code = 0;
    std::vector<float> compliance = {};
  } wide{};
  std::vector<std::uint8_t> codes;

  static VoxelScene filled(double voxel_size_m, Voxel min, Voxel dims,
                           const std::function<VoxelValue(Voxel)>& value) {
    VoxelScene scene;
    scene.voxel_size_m = voxel_size_m;
    scene.min = min;
    scene.dims = dims;
    scene.values.resize(static_cast<std::size_t>(dims[0] * dims[1] * dims[2]));
    for (std::int64_t i = 0; i < dims[0]; ++i)
      for (std::int64_t j = 0; j < dims[1]; ++j)
        for (std::int64_t k = 0; k < dims[2]; ++k)
          scene.values[static_cast<std::size_t>((i * dims[1] + j) * dims[2] + k)] =
              static_cast<std::uint8_t>(value({min[0] + i, min[1] + j, min[2] + k}));
    return scene;
  }

  VoxelValue at(const Voxel& v) const {
    const std::int64_t index = index_of(v);
    return index < 0 ? VoxelValue::kFree
                     : static_cast<VoxelValue>(values[static_cast<std::size_t>(index)]);
  }

  // What the file stores: the value at two bits.
  std::uint32_t code_at(const Voxel& v) const {
    const std::int64_t index = index_of(v);
    if (index < 0) return wide.free_code;
    return wide.bits == 2 ? values[static_cast<std::size_t>(index)]
                          : codes[static_cast<std::size_t>(index)];
  }

 private:
  std::int64_t index_of(const Voxel& v) const {  // -1 outside
    Voxel r{};
    for (int axis = 0; axis < 3; ++axis) {
      r[axis] = v[axis] - min[axis];
      if (r[axis] < 0 || r[axis] >= dims[axis]) return -1;
    }
    return (r[0] * dims[1] + r[1]) * dims[2] + r[2];
  }
};

// The layers (formats/voxmap_format.md, section 5) around the voxels where `solid` holds: Chebyshev
// distance below k interior, k surface, k + 1 proximity.
inline VoxelScene offset_scene(double voxel_size_m, Voxel min, Voxel dims, std::int64_t k,
                               const std::function<bool(Voxel)>& solid) {
  std::vector<Voxel> marked;
  for (std::int64_t i = 0; i < dims[0]; ++i)
    for (std::int64_t j = 0; j < dims[1]; ++j)
      for (std::int64_t l = 0; l < dims[2]; ++l)
        if (const Voxel v{min[0] + i, min[1] + j, min[2] + l}; solid(v)) marked.push_back(v);
  VoxelScene scene =
      VoxelScene::filled(voxel_size_m, min, dims, [](Voxel) { return VoxelValue{}; });
  scene.layers = static_cast<std::uint32_t>(k);
  std::vector<std::int64_t> distance(scene.values.size(), k + 2);
  for (const Voxel& m : marked)
    for (std::int64_t i = -k - 1; i <= k + 1; ++i)
      for (std::int64_t j = -k - 1; j <= k + 1; ++j)
        for (std::int64_t l = -k - 1; l <= k + 1; ++l) {
          const Voxel r{m[0] + i - min[0], m[1] + j - min[1], m[2] + l - min[2]};
          if (r[0] < 0 || r[1] < 0 || r[2] < 0 || r[0] >= dims[0] || r[1] >= dims[1] ||
              r[2] >= dims[2])
            continue;
          auto& d = distance[static_cast<std::size_t>((r[0] * dims[1] + r[1]) * dims[2] + r[2])];
          d = std::min(d, std::max({std::abs(i), std::abs(j), std::abs(l)}));
        }
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const VoxelValue value = distance[i] < k        ? VoxelValue::kInterior
                             : distance[i] == k     ? VoxelValue::kSurface
                             : distance[i] == k + 1 ? VoxelValue::kProximity
                                                    : VoxelValue::kFree;
    scene.values[i] = static_cast<std::uint8_t>(value);
  }
  return scene;
}

// Builds the 512-tree of a scene, uniform boxes collapsed, clearance by looking at every non-free
// brick: exact for bricks' boxes, so a lower bound for voxels.
class SceneTree {
 public:
  explicit SceneTree(const VoxelScene& scene) : scene_(scene) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t low = scene.min[axis] >> 9;
      const std::int64_t high =
          (scene.min[axis] + std::max<std::int64_t>(scene.dims[axis], 1) - 1) >> 9;
      origin_[axis] = low * 512;
      blocks_[axis] = high - low + 1;
    }
    find_occupied_bricks();
    for (std::int64_t i = 0; i < blocks_[0]; ++i)
      for (std::int64_t j = 0; j < blocks_[1]; ++j)
        for (std::int64_t k = 0; k < blocks_[2]; ++k)
          directory_.push_back(
              entry({origin_[0] + 512 * i, origin_[1] + 512 * j, origin_[2] + 512 * k}, 512));
  }

  VoxmapContent content(std::uint32_t cropped_sides = 0) const {
    VoxmapContent content;
    VoxmapHeader& h = content.header;
    h.voxel_size_m = scene_.voxel_size_m;
    h.offset_layers = scene_.layers;
    h.metric =
        static_cast<std::uint32_t>(scene_.wide.bits == 2 ? scene_.metric : Metric::kEuclidean);
    h.bits_per_voxel = scene_.wide.bits;
    h.range_m = scene_.wide.range_m;
    h.quantum_m = scene_.wide.quantum_m;
    h.zero_code = scene_.wide.zero_code;
    h.surface_code = scene_.wide.surface_code;
    h.proximity_code = scene_.wide.proximity_code;
    h.free_code = scene_.wide.free_code;
    h.cropped_sides = cropped_sides;
    fill_tight_box(h);
    for (int axis = 0; axis < 3; ++axis) {
      h.valid_min_voxel[axis] = scene_.min[axis];
      h.valid_max_voxel[axis] = scene_.min[axis] + scene_.dims[axis];
      h.directory_origin[axis] = origin_[axis];
      h.directory_dims[axis] = static_cast<std::uint32_t>(blocks_[axis]);
    }
    for (const std::uint8_t value : scene_.values) {
      h.interior_voxels += value == 1;
      h.surface_voxels += value == 2;
      h.proximity_voxels += value == 3;
    }
    content.directory = directory_;
    content.upper_nodes = upper_;
    content.lower_nodes = lower_;
    content.bricks = bricks_;
    content.compliance = scene_.wide.compliance;
    return content;
  }

 private:
  struct Brick {
    Voxel min;
  };

  void find_occupied_bricks() {
    for (std::int64_t i = scene_.min[0] & ~7; i < scene_.min[0] + scene_.dims[0]; i += 8)
      for (std::int64_t j = scene_.min[1] & ~7; j < scene_.min[1] + scene_.dims[1]; j += 8)
        for (std::int64_t k = scene_.min[2] & ~7; k < scene_.min[2] + scene_.dims[2]; k += 8)
          if (uniform_code_of({i, j, k}, 8) != scene_.wide.free_code)
            occupied_.push_back({{i, j, k}});
  }

  static constexpr std::uint32_t kMixed = 256;

  // Where the whole box has one code, that.
  std::uint32_t uniform_code_of(const Voxel& min, std::int64_t edge) const {
    bool outside_free = false;
    Voxel low{}, high{};
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::max(min[axis], scene_.min[axis]);
      high[axis] = std::min(min[axis] + edge, scene_.min[axis] + scene_.dims[axis]);
      if (low[axis] >= high[axis]) return scene_.wide.free_code;
      if (high[axis] - low[axis] < edge) outside_free = true;
    }
    const std::uint32_t first = outside_free ? scene_.wide.free_code : scene_.code_at(low);
    for (std::int64_t i = low[0]; i < high[0]; ++i)
      for (std::int64_t j = low[1]; j < high[1]; ++j)
        for (std::int64_t k = low[2]; k < high[2]; ++k)
          if (scene_.code_at({i, j, k}) != first) return kMixed;
    return first;
  }

  std::uint32_t clearance(const Voxel& min, std::int64_t edge) const {
    std::int64_t best = kMaxClearance;
    for (const Brick& brick : occupied_) {
      std::int64_t distance = 0;
      for (int axis = 0; axis < 3; ++axis) {
        distance = std::max({distance, brick.min[axis] - (min[axis] + edge - 1),
                             min[axis] - (brick.min[axis] + 7)});
      }
      best = std::min(best, distance);
    }
    return static_cast<std::uint32_t>(best);
  }

  std::uint32_t entry(const Voxel& min, std::int64_t edge) {
    const std::uint32_t code = uniform_code_of(min, edge);
    if (code == scene_.wide.free_code) return uniform_entry(code, clearance(min, edge));
    if (code != kMixed) return uniform_entry(code);
    if (edge == 8) return brick(min);
    auto& nodes = edge == 512 ? upper_ : lower_;
    std::vector<std::uint32_t> children(kNodeEntries);
    const std::int64_t child_edge = edge / 8;
    for (std::int64_t slot = 0; slot < kNodeEntries; ++slot) {
      children[static_cast<std::size_t>(slot)] =
          entry({min[0] + child_edge * (slot >> 6), min[1] + child_edge * ((slot >> 3) & 7),
                 min[2] + child_edge * (slot & 7)},
                child_edge);
    }
    nodes.insert(nodes.end(), children.begin(), children.end());
    return static_cast<std::uint32_t>(nodes.size() / kNodeEntries - 1);
  }

  std::uint32_t brick(const Voxel& min) {
    const std::size_t first = bricks_.size();
    const std::uint32_t bits = scene_.wide.bits, in_word = 32 / bits,
                        words = kNodeEntries / in_word;
    bricks_.resize(first + words);
    for (std::uint32_t slot = 0; slot < kNodeEntries; ++slot) {
      const std::uint32_t code =
          scene_.code_at({min[0] + (slot >> 6), min[1] + ((slot >> 3) & 7), min[2] + (slot & 7)});
      bricks_[first + slot / in_word] |= code << (bits * (slot % in_word));
    }
    return static_cast<std::uint32_t>(first / words);
  }

  void fill_tight_box(VoxmapHeader& h) const {
    Voxel low{std::numeric_limits<std::int64_t>::max(), 0, 0}, high{};
    bool any = false;
    for (std::int64_t i = 0; i < scene_.dims[0]; ++i)
      for (std::int64_t j = 0; j < scene_.dims[1]; ++j)
        for (std::int64_t k = 0; k < scene_.dims[2]; ++k) {
          const Voxel v{scene_.min[0] + i, scene_.min[1] + j, scene_.min[2] + k};
          if (scene_.at(v) == VoxelValue::kFree) continue;
          for (int axis = 0; axis < 3; ++axis) {
            low[axis] = any ? std::min(low[axis], v[axis]) : v[axis];
            high[axis] = any ? std::max(high[axis], v[axis]) : v[axis];
          }
          any = true;
        }
    for (int axis = 0; any && axis < 3; ++axis) {
      h.origin_voxel[axis] = low[axis];
      h.dims_voxels[axis] = static_cast<std::uint64_t>(high[axis] - low[axis] + 1);
    }
  }

  const VoxelScene& scene_;
  Voxel origin_{}, blocks_{};
  std::vector<Brick> occupied_;
  std::vector<std::uint32_t> directory_, upper_, lower_, bricks_;
};

inline void save_voxmap(const std::filesystem::path& path, const VoxelScene& scene,
                        std::uint32_t cropped_sides = 0) {
  const SceneTree tree(scene);
  save_bytes(path, voxmap_bytes(tree.content(cropped_sides)));
}

inline Voxmap make_voxmap(const VoxelScene& scene, std::uint32_t cropped_sides = 0) {
  const ScratchFolder folder;  // the mapping outlives the file's name
  save_voxmap(folder / "scene.vox", scene, cropped_sides);
  auto voxmap = Voxmap::open(folder / "scene.vox", Verify::kStructureAndChecksums);
  if (!voxmap) throw std::runtime_error(to_line(voxmap.error()));
  return std::move(*voxmap);
}

}  // namespace forcelayer::test
