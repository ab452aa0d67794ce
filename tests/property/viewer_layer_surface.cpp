// The extracted surfaces of layers against a list of unit faces read off a dense array.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <tuple>

#include "tests/support/dense_voxmap.h"
#include "tests/support/golden_bytes.h"
#include "workbench/viewer/surface/coarse_layers.h"
#include "workbench/viewer/surface/layer_surface.h"

namespace forcelayer::testing {
namespace {

// A unit face: the voxel that it belongs to, its axis and the side it looks to.
using Face = std::tuple<std::int64_t, std::int64_t, std::int64_t, int, int>;

int rank_of(VoxelValue value) {
  switch (value) {
    case VoxelValue::kInterior:
      return 0;
    case VoxelValue::kSurface:
      return 1;
    case VoxelValue::kProximity:
      return 2;
    case VoxelValue::kFree:
      break;
  }
  return 3;
}

std::set<Face> expected_faces(const DenseVoxels& voxels, VoxelValue layer) {
  std::set<Face> faces;
  for_each_voxel(voxels.box(), [&](const VoxelIndex& v) {
    if (voxels.value(v[0], v[1], v[2]) != layer) return;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        VoxelIndex n = v;
        n[static_cast<std::size_t>(axis)] += side;
        if (rank_of(voxels.value(n[0], n[1], n[2])) > rank_of(layer)) {
          faces.insert({v[0], v[1], v[2], axis, side});
        }
      }
    }
  });
  return faces;
}

// The unit faces that the rectangles cover; fails where two cover the same one.
std::set<Face> covered_faces(const viewer::QuadSurface& surface, double s) {
  std::set<Face> faces;
  for (std::uint64_t q = 0; q < surface.quad_count(); ++q) {
    std::array<std::array<std::int64_t, 3>, 4> corner{};  // in voxels
    for (std::size_t n = 0; n < 4; ++n) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double at_m =
            double{surface.corners[4 * q + n][axis]} + surface.origin_m[static_cast<int>(axis)];
        corner[n][axis] = std::llround(at_m / s);
        EXPECT_NEAR(at_m / s, static_cast<double>(corner[n][axis]), 1e-3);
      }
    }
    std::array<std::int64_t, 3> a{}, b{}, low = corner[0], high = corner[0];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      a[axis] = corner[1][axis] - corner[0][axis];
      b[axis] = corner[2][axis] - corner[1][axis];
      for (const auto& c : corner) {
        low[axis] = std::min(low[axis], c[axis]);
        high[axis] = std::max(high[axis], c[axis]);
      }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (low[axis] != high[axis]) continue;
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      const int side = a[u] * b[v] - a[v] * b[u] > 0 ? 1 : -1;
      for (std::int64_t i = low[u]; i < high[u]; ++i) {
        for (std::int64_t j = low[v]; j < high[v]; ++j) {
          std::array<std::int64_t, 3> voxel{};
          voxel[axis] = low[axis] - (side > 0 ? 1 : 0);
          voxel[u] = i;
          voxel[v] = j;
          const bool fresh =
              faces.insert({voxel[0], voxel[1], voxel[2], static_cast<int>(axis), side}).second;
          EXPECT_TRUE(fresh) << "face covered twice";
        }
      }
    }
  }
  return faces;
}

DenseVoxels random_voxels(std::mt19937_64& random) {
  const auto below = [&](std::int64_t n) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n));
  };
  const VoxelIndex lowest = {below(40) - 20, -512 + below(30), below(20)};
  DenseVoxels voxels(lowest, {70, 24, 30}, 0.005);
  for (int box = 0; box < 10; ++box) {
    VoxelIndex low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = voxels.box().low[axis] + below(24);
      high[axis] = std::min(voxels.box().high[axis], low[axis] + 1 + below(axis == 0 ? 60 : 16));
    }
    voxels.fill(low, high, static_cast<VoxelValue>(below(4)));
  }
  return voxels;
}

TEST(LayerSurface, CoversEachFaceOnceAndNoOther) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const DenseVoxels voxels = random_voxels(random);
    const BuiltVoxmap built(voxels);
    for (const VoxelValue layer :
         {VoxelValue::kInterior, VoxelValue::kSurface, VoxelValue::kProximity}) {
      const std::set<Face> expected = expected_faces(voxels, layer);
      for (const viewer::Faces faces : {viewer::Faces::kMerged, viewer::Faces::kSingle}) {
        const viewer::QuadSurface surface =
            viewer::layer_surface(built.voxmap(), layer, {0.1, -2.5, 0.07}, faces);
        EXPECT_EQ(surface.voxel_faces, expected.size());
        EXPECT_EQ(covered_faces(surface, 0.005), expected);
        if (faces == viewer::Faces::kSingle) {
          EXPECT_EQ(surface.quad_count(), expected.size());
        }
      }
    }
  }
}

// The map without the voxels that are nearest to an object, and without those of which no object is
// known.
DenseVoxels without_object(const Voxmap& map, std::uint32_t object) {
  const VoxmapHeader& h = map.header();
  VoxelIndex extent{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    extent[axis] = static_cast<std::int64_t>(h.dims_voxels[axis]);
  }
  DenseVoxels voxels(h.origin_voxel, extent, h.voxel_size_m);
  for_each_voxel(voxels.box(), [&](const VoxelIndex& v) {
    const auto [i, j, k] = v;
    const bool known =
        std::isfinite(map.min_distance_m(i, j, k)) && std::isfinite(map.max_distance_m(i, j, k));
    const std::uint32_t nearest = known ? map.nearest_object(i, j, k) : 0;
    if (nearest != 0 && nearest != object) voxels.set(i, j, k, map.value(i, j, k));
  });
  return voxels;
}

TEST(LayerSurface, LeavesOutTheVoxelsOfHiddenObjects) {
  const Voxmap map = Voxmap::open(golden_path("baked_objects.vox")).value();
  const std::uint32_t count = map.header().object_count;
  ASSERT_GT(count, 1u);
  for (std::uint32_t object = 1; object <= count; ++object) {
    viewer::HiddenObjects hidden(count + 1, 0);
    hidden[0] = hidden[object] = 1;
    const DenseVoxels voxels = without_object(map, object);
    for (const VoxelValue layer : {VoxelValue::kInterior, VoxelValue::kSurface}) {
      const std::set<Face> expected = expected_faces(voxels, layer);
      EXPECT_FALSE(expected.empty());
      const viewer::QuadSurface surface =
          viewer::layer_surface(map, layer, {0, 0, 0}, viewer::Faces::kMerged, hidden);
      EXPECT_EQ(covered_faces(surface, map.voxel_size_m()), expected);
    }
  }
}

// The cells of `edge` voxels, each with the value that CoarseLayers promises.
DenseVoxels coarse_cells(const DenseVoxels& voxels, std::int64_t edge) {
  const auto cell_of = [&](std::int64_t at) { return (at - (at < 0 ? edge - 1 : 0)) / edge; };
  VoxelIndex low{}, dims{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = cell_of(voxels.box().low[axis]);
    dims[axis] = cell_of(voxels.box().high[axis] - 1) + 1 - low[axis];
  }
  DenseVoxels cells(low, dims, 0.005 * static_cast<double>(edge));
  for (const VoxelValue value :  // what is last wins
       {VoxelValue::kProximity, VoxelValue::kInterior, VoxelValue::kSurface}) {
    for_each_voxel(voxels.box(), [&](const VoxelIndex& v) {
      if (voxels.value(v[0], v[1], v[2]) != value) return;
      const VoxelIndex cell = {cell_of(v[0]), cell_of(v[1]), cell_of(v[2])};
      cells.fill(cell, {cell[0] + 1, cell[1] + 1, cell[2] + 1}, value);
    });
  }
  return cells;
}

TEST(CoarseLayers, CoverEachFaceOfACellOnceAndNoOther) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const DenseVoxels voxels = random_voxels(random);
    const BuiltVoxmap built(voxels);
    for (const int edge : {2, 4, 8}) {
      const DenseVoxels cells = coarse_cells(voxels, edge);
      const viewer::CoarseLayers coarse(built.voxmap(), edge);
      for (const VoxelValue layer :
           {VoxelValue::kInterior, VoxelValue::kSurface, VoxelValue::kProximity}) {
        const viewer::QuadSurface surface = coarse.surface(layer, {0.1, -2.5, 0.07});
        EXPECT_EQ(covered_faces(surface, 0.005 * edge), expected_faces(cells, layer));
      }
    }
  }
}

TEST(CoarseLayers, ReadUniformBlocks) {
  DenseVoxels voxels({0, 0, 0}, {64, 64, 72}, 0.005);
  voxels.fill({0, 0, 0}, {64, 64, 64}, VoxelValue::kInterior);  // one entry of a lower node
  voxels.fill({0, 0, 64}, {64, 64, 72}, VoxelValue::kSurface);  // uniform bricks
  const BuiltVoxmap built(voxels);
  for (const int edge : {2, 4, 8}) {
    const DenseVoxels cells = coarse_cells(voxels, edge);
    const viewer::CoarseLayers coarse(built.voxmap(), edge);
    for (const VoxelValue layer : {VoxelValue::kInterior, VoxelValue::kSurface}) {
      const viewer::QuadSurface surface = coarse.surface(layer, {0, 0, 0});
      EXPECT_EQ(covered_faces(surface, 0.005 * edge), expected_faces(cells, layer));
    }
  }
}

TEST(LayerSurface, UniformBlocksAreRead) {
  DenseVoxels voxels({0, 0, 0}, {64, 64, 72}, 0.005);
  voxels.fill({0, 0, 0}, {64, 64, 64}, VoxelValue::kInterior);  // one entry of a lower node
  voxels.fill({0, 0, 64}, {64, 64, 72}, VoxelValue::kSurface);
  const BuiltVoxmap built(voxels);
  const viewer::QuadSurface surface =
      viewer::layer_surface(built.voxmap(), VoxelValue::kInterior, {0, 0, 0});
  EXPECT_EQ(surface.voxel_faces, 6u * 64 * 64);
  EXPECT_EQ(surface.quad_count(), 6u * 8 * 8);
}

}  // namespace
}  // namespace forcelayer::testing
