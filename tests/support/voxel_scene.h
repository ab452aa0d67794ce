// Small scenes for tests: a dense box of voxel values, and the .vox file of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
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

  // Euclidean only: where the force begins, from the mesh (0: as the layers say), and its depth.
  double zero_force_voxels = 0, force_depth_voxels = 1;

  // Stored distances: what the header says, and the codes beside the values; none without a
  // quantum.
  struct Distances {
    double quantum_m = 0;
    std::int32_t zero_code = 0;
    std::vector<float> compliance = {};
  } distances{};
  std::vector<std::uint8_t> codes;

  bool tells_clearances = true;  // false: no free box says how far it is to the next brick

  bool has_distances() const { return distances.quantum_m > 0; }

  double zero_force_m() const {
    const double usual = layers - 1 + 888.0 / 1024 + force_depth_voxels;
    return (zero_force_voxels > 0 ? zero_force_voxels : usual) * voxel_size_m;
  }

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

  // The stored distance, as far as codes go outside the box.
  std::uint32_t code_at(const Voxel& v) const {
    const std::int64_t index = index_of(v);
    return index < 0 ? kMaxDistanceCode : codes[static_cast<std::size_t>(index)];
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
// distance below k interior, from there n layers of surface, then one of proximity.
inline VoxelScene offset_scene(double voxel_size_m, Voxel min, Voxel dims, std::int64_t k,
                               std::int64_t n, const std::function<bool(Voxel)>& solid) {
  std::vector<Voxel> marked;
  for (std::int64_t i = 0; i < dims[0]; ++i)
    for (std::int64_t j = 0; j < dims[1]; ++j)
      for (std::int64_t l = 0; l < dims[2]; ++l)
        if (const Voxel v{min[0] + i, min[1] + j, min[2] + l}; solid(v)) marked.push_back(v);
  VoxelScene scene =
      VoxelScene::filled(voxel_size_m, min, dims, [](Voxel) { return VoxelValue{}; });
  scene.layers = static_cast<std::uint32_t>(k);
  std::vector<std::int64_t> distance(scene.values.size(), k + n + 1);
  for (const Voxel& m : marked)
    for (std::int64_t i = -k - n; i <= k + n; ++i)
      for (std::int64_t j = -k - n; j <= k + n; ++j)
        for (std::int64_t l = -k - n; l <= k + n; ++l) {
          const Voxel r{m[0] + i - min[0], m[1] + j - min[1], m[2] + l - min[2]};
          if (r[0] < 0 || r[1] < 0 || r[2] < 0 || r[0] >= dims[0] || r[1] >= dims[1] ||
              r[2] >= dims[2])
            continue;
          auto& d = distance[static_cast<std::size_t>((r[0] * dims[1] + r[1]) * dims[2] + r[2])];
          d = std::min(d, std::max({std::abs(i), std::abs(j), std::abs(l)}));
        }
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const VoxelValue value = distance[i] < k        ? VoxelValue::kInterior
                             : distance[i] < k + n  ? VoxelValue::kSurface
                             : distance[i] == k + n ? VoxelValue::kProximity
                                                    : VoxelValue::kFree;
    scene.values[i] = static_cast<std::uint8_t>(value);
  }
  return scene;
}
inline VoxelScene offset_scene(double voxel_size_m, Voxel min, Voxel dims, std::int64_t k,
                               const std::function<bool(Voxel)>& solid) {
  return offset_scene(voxel_size_m, min, dims, k, 1, solid);
}

// The scene with its layers all around it, where its box cut them off: what a file must hold that
// is opened for a run. For one layer of force, without distances.
inline VoxelScene closed(const VoxelScene& scene) {
  const auto near = [](const VoxelScene& of, const Voxel& v, VoxelValue value) {
    for (std::int64_t n = 0; n < 27; ++n) {
      if (of.at({v[0] + n / 9 - 1, v[1] + n / 3 % 3 - 1, v[2] + n % 3 - 1}) == value) return true;
    }
    return false;
  };
  VoxelScene wider = scene;
  for (const auto& layer : {std::pair{VoxelValue::kSurface, VoxelValue::kInterior},
                            std::pair{VoxelValue::kProximity, VoxelValue::kSurface}}) {
    const VoxelScene before = wider;
    Voxel min = before.min, dims = before.dims;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      min[axis] -= 1;
      dims[axis] += 2;
    }
    VoxelScene grown = VoxelScene::filled(scene.voxel_size_m, min, dims, [&](const Voxel& v) {
      const bool joins = before.at(v) == VoxelValue::kFree && near(before, v, layer.second);
      return joins ? layer.first : before.at(v);
    });
    wider.min = grown.min;
    wider.dims = grown.dims;
    wider.values = std::move(grown.values);
  }
  return wider;
}

// A 512-tree of elements of `bits` bits, uniform boxes collapsed.
class SceneTree {
 public:
  using Element = std::function<std::uint32_t(const Voxel&)>;
  using Uniform = std::function<std::uint32_t(std::uint32_t element, const Voxel&, std::int64_t)>;

  // `element` gives the element of a voxel in the scene's box, `outside` all others; `uniform`
  // makes the entry of a uniform box.
  SceneTree(const VoxelScene& scene, std::uint32_t bits, std::uint32_t outside, Element element,
            Uniform uniform)
      : scene_(scene),
        bits_(bits),
        outside_(outside),
        element_(std::move(element)),
        uniform_(std::move(uniform)) {
    Voxel origin{}, cells{};
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = directory_low(scene, axis);
      cells[axis] = directory_dim(scene, axis);
    }
    for (std::int64_t i = 0; i < cells[0]; ++i)
      for (std::int64_t j = 0; j < cells[1]; ++j)
        for (std::int64_t k = 0; k < cells[2]; ++k)
          directory_.push_back(
              entry({origin[0] + 512 * i, origin[1] + 512 * j, origin[2] + 512 * k}, 512));
  }

  TreeContent content() const { return {directory_, upper_, lower_, bricks_}; }

  static std::int64_t directory_low(const VoxelScene& scene, int axis) {
    return (scene.min[axis] >> 9) * 512;
  }
  static std::int64_t directory_dim(const VoxelScene& scene, int axis) {
    const std::int64_t last = scene.min[axis] + std::max<std::int64_t>(scene.dims[axis], 1) - 1;
    return (last >> 9) - (scene.min[axis] >> 9) + 1;
  }

  static constexpr std::uint32_t kMixed = 1u << 31;

  // Where the whole box has one element, that.
  std::uint32_t uniform_element_of(const Voxel& min, std::int64_t edge) const {
    bool reaches_outside = false;
    Voxel low{}, high{};
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::max(min[axis], scene_.min[axis]);
      high[axis] = std::min(min[axis] + edge, scene_.min[axis] + scene_.dims[axis]);
      if (low[axis] >= high[axis]) return outside_;
      if (high[axis] - low[axis] < edge) reaches_outside = true;
    }
    const std::uint32_t first = reaches_outside ? outside_ : element_(low);
    for (std::int64_t i = low[0]; i < high[0]; ++i)
      for (std::int64_t j = low[1]; j < high[1]; ++j)
        for (std::int64_t k = low[2]; k < high[2]; ++k)
          if (element_({i, j, k}) != first) return kMixed;
    return first;
  }

 private:
  std::uint32_t entry(const Voxel& min, std::int64_t edge) {
    const std::uint32_t element = uniform_element_of(min, edge);
    if (element != kMixed) return uniform_(element, min, edge);
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
    const std::uint32_t in_word = 32 / bits_, words = kNodeEntries / in_word;
    bricks_.resize(first + words);
    for (std::uint32_t slot = 0; slot < kNodeEntries; ++slot) {
      const Voxel v{min[0] + (slot >> 6), min[1] + ((slot >> 3) & 7), min[2] + (slot & 7)};
      bool inside = true;
      for (int axis = 0; axis < 3; ++axis) {
        inside &= v[axis] >= scene_.min[axis] && v[axis] < scene_.min[axis] + scene_.dims[axis];
      }
      const std::uint32_t element = inside ? element_(v) : outside_;
      bricks_[first + slot / in_word] |= element << (bits_ * (slot % in_word));
    }
    return static_cast<std::uint32_t>(first / words);
  }

  const VoxelScene& scene_;
  std::uint32_t bits_, outside_;
  Element element_;
  Uniform uniform_;
  std::vector<std::uint32_t> directory_, upper_, lower_, bricks_;
};

// The .vox file of a scene. Clearance by looking at every non-free brick: exact for bricks' boxes,
// so a lower bound for voxels.
class SceneFile {
 public:
  explicit SceneFile(const VoxelScene& scene)
      : scene_(scene), occupied_(occupied_bricks(scene)), values_(tree_of_values()) {
    if (scene.has_distances()) {
      distances_.emplace(
          scene, kDistanceBits, kMaxDistanceCode, [&](const Voxel& v) { return scene.code_at(v); },
          [](std::uint32_t code, const Voxel&, std::int64_t) { return uniform_entry(code); });
    }
  }

  VoxmapContent content(std::uint32_t cropped_sides = 0) const {
    VoxmapContent content;
    VoxmapHeader& h = content.header;
    h.voxel_size_m = scene_.voxel_size_m;
    h.offset_layers = scene_.layers;
    h.metric = static_cast<std::uint32_t>(scene_.metric);
    if (scene_.metric == Metric::kEuclidean) {
      h.zero_force_m = scene_.zero_force_m();
      h.force_depth_m = scene_.force_depth_voxels * scene_.voxel_size_m;
    }
    h.distance_quantum_m = scene_.distances.quantum_m;
    h.distance_zero_code = scene_.distances.zero_code;
    h.cropped_sides = cropped_sides;
    fill_tight_box(h);
    for (int axis = 0; axis < 3; ++axis) {
      h.valid_min_voxel[axis] = scene_.min[axis];
      h.valid_max_voxel[axis] = scene_.min[axis] + scene_.dims[axis];
      h.directory_origin[axis] = SceneTree::directory_low(scene_, axis);
      h.directory_dims[axis] = static_cast<std::uint32_t>(SceneTree::directory_dim(scene_, axis));
    }
    for (const std::uint8_t value : scene_.values) {
      h.interior_voxels += value == 1;
      h.surface_voxels += value == 2;
      h.proximity_voxels += value == 3;
    }
    content.values = values_.content();
    if (distances_) content.distances = distances_->content();
    content.compliance = scene_.distances.compliance;
    return content;
  }

 private:
  struct Brick {
    Voxel min;
  };

  static std::vector<Brick> occupied_bricks(const VoxelScene& scene) {
    std::vector<Brick> occupied;
    for (std::int64_t i = scene.min[0] & ~7; i < scene.min[0] + scene.dims[0]; i += 8)
      for (std::int64_t j = scene.min[1] & ~7; j < scene.min[1] + scene.dims[1]; j += 8)
        for (std::int64_t k = scene.min[2] & ~7; k < scene.min[2] + scene.dims[2]; k += 8)
          for (std::int64_t n = 0; n < kNodeEntries; ++n)
            if (scene.at({i + (n >> 6), j + (n >> 3 & 7), k + (n & 7)}) != VoxelValue::kFree) {
              occupied.push_back({{i, j, k}});
              break;
            }
    return occupied;
  }

  SceneTree tree_of_values() const {
    return SceneTree(
        scene_, kValueBits, 0,
        [&](const Voxel& v) { return static_cast<std::uint32_t>(scene_.at(v)); },
        [&](std::uint32_t value, const Voxel& min, std::int64_t edge) {
          return uniform_entry(value, value == 0 ? clearance(min, edge) : 0);
        });
  }

  std::uint32_t clearance(const Voxel& min, std::int64_t edge) const {
    if (!scene_.tells_clearances) return 0;
    std::int64_t best = kMaxClearance;
    for (const Brick& brick : occupied_) {
      std::int64_t distance = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {  // many calls: no list for std::max
        distance = std::max(distance, brick.min[axis] - (min[axis] + edge - 1));
        distance = std::max(distance, min[axis] - (brick.min[axis] + 7));
      }
      best = std::min(best, distance);
      if (best == 1) break;  // beside it
    }
    return static_cast<std::uint32_t>(best);
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
  std::vector<Brick> occupied_;
  SceneTree values_;
  std::optional<SceneTree> distances_;
};

inline void save_voxmap(const std::filesystem::path& path, const VoxelScene& scene,
                        std::uint32_t cropped_sides = 0) {
  save_bytes(path, voxmap_bytes(SceneFile(scene).content(cropped_sides)));
}

inline Voxmap open_content(const VoxmapContent& content) {
  const ScratchFolder folder;  // the bytes outlive the file
  save_bytes(folder / "scene.vox", voxmap_bytes(content));
  auto voxmap = Voxmap::open(folder / "scene.vox", Verify::kStructureAndChecksums);
  if (!voxmap) throw std::runtime_error(to_line(voxmap.error()));
  return std::move(*voxmap);
}

inline Voxmap make_voxmap(const VoxelScene& scene, std::uint32_t cropped_sides = 0) {
  return open_content(SceneFile(scene).content(cropped_sides));
}

// The same with objects of these names: `object_at` gives the nearest one, from 1, of a voxel whose
// distance is stored.
inline Voxmap make_voxmap_of_objects(const VoxelScene& scene, const std::vector<std::string>& names,
                                     const std::function<std::uint32_t(const Voxel&)>& object_at) {
  const SceneFile file(scene);
  VoxmapContent content = file.content();
  const SceneTree objects(
      scene, kObjectBits, 0,
      [&](const Voxel& v) -> std::uint32_t {
        const std::uint32_t code = scene.code_at(v);
        return code == 0 || code == kMaxDistanceCode ? 0 : object_at(v);
      },
      [](std::uint32_t object, const Voxel&, std::int64_t) { return uniform_entry(object); });
  content.objects = objects.content();
  std::string joined;
  for (const std::string& name : names) add_object_name(name, joined);
  content.object_names = joined;
  content.header.object_count = static_cast<std::uint32_t>(names.size());
  return open_content(content);
}

}  // namespace forcelayer::test
