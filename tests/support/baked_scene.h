// A bake as a reader of its file sees it, for tests.
#pragma once

#include <gtest/gtest.h>

#include <cstring>

#include <string>
#include <vector>

#include "formats/mesh/scene.h"
#include "formats/voxmap.h"
#include "formats/voxmap_writer.h"
#include "tests/support/aligned_bytes.h"
#include "tests/support/reference_bake.h"
#include "voxelize/bake.h"

namespace forcelayer::reference {

// Two threads, whose order must not show.
inline voxelize::BakeOptions options_with(std::uint32_t layers, double voxel_size_m = 1,
                                          Metric metric = Metric::kChebyshev) {
  voxelize::BakeOptions options;
  options.voxel_size_m = voxel_size_m;
  options.layers = layers;
  options.metric = metric;
  options.threads = 2;
  return options;
}

inline std::vector<voxelize::SceneObject> objects_of(const std::vector<mesh::Mesh>& meshes,
                                                     const mesh::Affine& placing = {}) {
  std::vector<voxelize::SceneObject> objects;
  for (const mesh::Mesh& mesh : meshes) objects.push_back({"object", &mesh, placing, {}, 0});
  return objects;
}

inline std::vector<voxelize::SceneObject> objects_of(const mesh::Scene& scene) {
  std::vector<voxelize::SceneObject> objects;
  for (const mesh::MeshObject& part : scene.objects) {
    objects.push_back({part.name, &scene.mesh_of(part), part.world_from_mesh, {}, 0});
  }
  return objects;
}

// Bakes, and reads the file's bytes back with every check on.
class BakedScene {
 public:
  BakedScene(const std::vector<voxelize::SceneObject>& objects,
             const voxelize::BakeOptions& options) {
    const auto result = voxelize::bake(objects, options);
    if (!result) throw std::runtime_error(to_line(result.error()));
    bytes_ = testing::AlignedBytes(voxmap_bytes(result->content("{}")));
    auto map = Voxmap::from_bytes(std::as_const(bytes_).bytes(), "baked scene",
                                  Verify::kStructureAndChecksums);
    if (!map) throw std::runtime_error(to_line(map.error()));
    map_.emplace(std::move(*map));
  }

  const Voxmap& map() const { return *map_; }
  std::string bytes() const {
    return {reinterpret_cast<const char*>(map_->bytes().data()), map_->bytes().size()};
  }

 private:
  testing::AlignedBytes bytes_;
  std::optional<Voxmap> map_;
};

// Every voxel of the grid equals the map's, the grid's border is free, and the header's box and
// counts are those of the grid.
inline void expect_equal(const Voxmap& map, const DenseGrid& expected) {
  std::array<std::uint64_t, 4> counts{};
  lattice::VoxelIndex low{INT64_MAX, INT64_MAX, INT64_MAX}, high{INT64_MIN, INT64_MIN, INT64_MIN};
  std::uint64_t wrong = 0;
  lattice::VoxelIndex first_wrong{};
  expected.for_each([&](const lattice::VoxelIndex& v) {
    const std::uint8_t value = expected.at(v);
    ++counts[value];
    for (std::size_t d = 0; d < 3 && value != 0; ++d) {
      low[d] = std::min(low[d], v[d]);
      high[d] = std::max(high[d], v[d]);
    }
    if (static_cast<std::uint8_t>(map.value(v[0], v[1], v[2])) == value) return;
    if (wrong++ == 0) first_wrong = v;
  });
  ASSERT_EQ(wrong, 0u) << "first at " << first_wrong[0] << ' ' << first_wrong[1] << ' '
                       << first_wrong[2] << ": expected " << int{expected.at(first_wrong)}
                       << ", found "
                       << static_cast<int>(
                              map.value(first_wrong[0], first_wrong[1], first_wrong[2]));
  const VoxmapHeader& header = map.header();
  EXPECT_EQ(header.interior_voxels, counts[1]);
  EXPECT_EQ(header.surface_voxels, counts[2]);
  EXPECT_EQ(header.proximity_voxels, counts[3]);
  EXPECT_EQ(header.origin_voxel, low);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_EQ(header.dims_voxels[d], static_cast<std::uint64_t>(high[d] - low[d] + 1));
  }
}

// Every uniform free entry promises its exact clearance: the Chebyshev distance from its box to the
// nearest voxel that is not free. `held` are all voxels of the map that are not free.
inline void expect_exact_clearance(const Voxmap& map,
                                   const std::vector<lattice::VoxelIndex>& held) {
  const VoxmapHeader& header = map.header();
  const auto lookup = [&](const lattice::VoxelIndex& v) {
    const auto& origin = header.directory_origin;
    return map.view().lookup(static_cast<std::int32_t>(v[0] - origin[0]),
                             static_cast<std::int32_t>(v[1] - origin[1]),
                             static_cast<std::int32_t>(v[2] - origin[2]));
  };
  const auto edge_at = [&](const lattice::VoxelIndex& v) {
    return std::int64_t{lookup(v).edge_voxels};
  };
  const auto check_entry = [&](const lattice::VoxelIndex& low, std::int64_t edge) {
    const VoxelLookup found = lookup(low);
    if (found.code != 0 || found.edge_voxels != edge) return;
    std::int64_t nearest = INT64_MAX;
    for (const lattice::VoxelIndex& v : held) {
      std::int64_t distance = 0;
      for (std::size_t d = 0; d < 3; ++d) {
        distance = std::max({distance, low[d] - v[d], v[d] - (low[d] + edge - 1)});
      }
      nearest = std::min(nearest, distance);
    }
    ASSERT_EQ(std::int64_t{found.clearance}, nearest)
        << "entry of " << edge << " voxels at " << low[0] << ' ' << low[1] << ' ' << low[2];
  };
  // Every entry of every level: 512, then 64 and 8 voxels an edge where the one above has a child.
  const auto walk = [&](const auto& self, const lattice::VoxelIndex& low,
                        std::int64_t edge) -> void {
    check_entry(low, edge);
    if (::testing::Test::HasFatalFailure() || edge == 8 || edge_at(low) == edge) return;
    for (std::int64_t n = 0; n < 512; ++n) {
      self(self,
           {low[0] + (n >> 6) * (edge / 8), low[1] + (n >> 3 & 7) * (edge / 8),
            low[2] + (n & 7) * (edge / 8)},
           edge / 8);
      if (::testing::Test::HasFatalFailure()) return;
    }
  };
  const auto& dims = header.directory_dims;
  for (std::int64_t n = 0; n < std::int64_t{dims[0]} * dims[1] * dims[2]; ++n) {
    walk(walk,
         {header.directory_origin[0] + n / dims[2] / dims[1] * 512,
          header.directory_origin[1] + n / dims[2] % dims[1] * 512,
          header.directory_origin[2] + n % dims[2] * 512},
         512);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

}  // namespace forcelayer::reference
