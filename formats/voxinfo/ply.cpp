// PLY, binary little-endian. The force layer is written as quads. Faces of one brick share their
// vertices and faces of different bricks do not, so that only one brick at a time is in memory.
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <vector>

#include "formats/voxinfo/export.h"
#include "formats/voxinfo/occupied_boxes.h"
#include "formats/voxinfo/output.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::voxinfo {
namespace {

using Voxel = std::array<std::int64_t, 3>;

// Quads of one brick: corners in 0..8 per axis relative to the brick, vertices in order of first
// use.
class BrickFaces {
 public:
  BrickFaces(const Voxmap& map, const VoxmapRegion& region) : low_(region.low) {
    vertex_of_.fill(-1);
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const Voxel voxel = voxmap_walk::child_low(region.low, n, 1);
      if (map.value(voxel[0], voxel[1], voxel[2]) == VoxelValue::kSurface) add_voxel(map, voxel);
    }
  }

  const Voxel& low() const { return low_; }
  const std::vector<std::array<std::uint8_t, 3>>& vertices() const { return vertices_; }
  const std::vector<std::array<std::int32_t, 4>>& quads() const { return quads_; }

 private:
  // The faces between `voxel` and neighbors that are not in the force layer.
  void add_voxel(const Voxmap& map, const Voxel& voxel) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        Voxel neighbor = voxel;
        neighbor[axis] += side ? 1 : -1;
        const VoxelValue value = map.value(neighbor[0], neighbor[1], neighbor[2]);
        if (value != VoxelValue::kSurface) add_quad(voxel, axis, side);
      }
    }
  }

  // Counter-clockwise seen from outside the voxel.
  void add_quad(const Voxel& voxel, std::size_t axis, int side) {
    constexpr int kAround[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<std::int32_t, 4> quad{};
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const auto& around = kAround[side ? corner : 3 - corner];
      std::array<std::uint8_t, 3> at{};
      for (std::size_t a = 0; a < 3; ++a) at[a] = static_cast<std::uint8_t>(voxel[a] - low_[a]);
      at[axis] = static_cast<std::uint8_t>(at[axis] + side);
      at[u] = static_cast<std::uint8_t>(at[u] + around[0]);
      at[v] = static_cast<std::uint8_t>(at[v] + around[1]);
      quad[corner] = vertex(at);
    }
    quads_.push_back(quad);
  }

  std::int32_t vertex(const std::array<std::uint8_t, 3>& at) {
    std::int32_t& known = vertex_of_[static_cast<std::size_t>((at[0] * 9 + at[1]) * 9 + at[2])];
    if (known < 0) {
      known = static_cast<std::int32_t>(vertices_.size());
      vertices_.push_back(at);
    }
    return known;
  }

  Voxel low_;
  std::array<std::int32_t, 729> vertex_of_{};
  std::vector<std::array<std::uint8_t, 3>> vertices_;
  std::vector<std::array<std::int32_t, 4>> quads_;
};

// Calls use(const BrickFaces&) for every 8^3 box that holds force-layer voxels.
template <typename Use>
void for_each_surface_brick(const Voxmap& map, const OccupiedBoxes<kValueBits>& occupied, Use use) {
  for_each_region_where(map.view(), occupied, [&](const VoxmapRegion& region) {
    if (region.is_brick) {
      use(BrickFaces(map, region));
      return;
    }
    if (static_cast<VoxelValue>(uniform_value(region.entry)) != VoxelValue::kSurface) return;
    VoxmapRegion box = region;
    box.edge_voxels = kBrickEdge;
    const std::int64_t edge = region.edge_voxels;
    for (std::int64_t x = 0; x < edge; x += kBrickEdge) {
      for (std::int64_t y = 0; y < edge; y += kBrickEdge) {
        for (std::int64_t z = 0; z < edge; z += kBrickEdge) {
          box.low = {region.low[0] + x, region.low[1] + y, region.low[2] + z};
          use(BrickFaces(map, box));
        }
      }
    }
  });
}

std::string header_text(const char* comment, std::uint64_t vertices, const char* properties,
                        std::uint64_t faces) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment ";
  text += comment;
  text += "\nelement vertex " + std::to_string(vertices) +
          "\nproperty double x\nproperty double y\nproperty double z\n" + properties;
  if (faces > 0) {
    text += "element face " + std::to_string(faces) + "\nproperty list uchar int vertex_indices\n";
  }
  return text + "end_header\n";
}

}  // namespace

Status export_voxmap_ply(const Voxmap& map, const std::string& out) {
  constexpr std::uint64_t kMaxIndex = 0x7fffffff;  // PLY's int
  const auto occupied = occupied_boxes(map);
  const double steps = occupied.steps([](std::uint32_t value, std::uint32_t edge) {
    return value == static_cast<std::uint32_t>(VoxelValue::kSurface) ? std::pow(edge, 3) : 0;
  });
  if (Status s = check_walk(steps, out); !s) return s;
  std::uint64_t vertices = 0, faces = 0;
  for_each_surface_brick(map, occupied, [&](const BrickFaces& brick) {
    vertices += brick.vertices().size();
    faces += brick.quads().size();
  });
  if (vertices > kMaxIndex) {
    return Error{ErrorCode::kUsage, out, "",
                 std::to_string(vertices) + " vertices are too many for a .ply file",
                 "export a .vdb, or bake a smaller region (--roi)"};
  }
  auto ply = BufferedOutput::create(out);
  if (!ply) return ply.error();
  ply->append(header_text("voxel faces of the force layer, meters", vertices, "", faces));
  const double s = map.voxel_size_m();
  for_each_surface_brick(map, occupied, [&](const BrickFaces& brick) {
    for (const auto& at : brick.vertices()) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ply->append_number(static_cast<double>(brick.low()[axis] + at[axis]) * s);
      }
    }
  });
  std::int32_t first = 0;
  for_each_surface_brick(map, occupied, [&](const BrickFaces& brick) {
    for (const auto& quad : brick.quads()) {
      ply->append_number(std::uint8_t{4});
      for (const std::int32_t corner : quad) ply->append_number(first + corner);
    }
    first += static_cast<std::int32_t>(brick.vertices().size());
  });
  return ply->finish();
}

Status export_pshell_ply(const Pshell& shell, const std::string& out) {
  auto ply = BufferedOutput::create(out);
  if (!ply) return ply.error();
  const PshellView& v = shell.view();
  ply->append(header_text("shell points with inward normals, meters, part frame", v.point_count,
                          "property float nx\nproperty float ny\nproperty float nz\n"
                          "property float weight_m2\nproperty uint block\n",
                          0));
  const auto& center = shell.header().center_m;
  for (std::size_t i = 0; i < v.point_count; ++i) {
    for (const double coordinate : {center[0] + v.x[i], center[1] + v.y[i], center[2] + v.z[i]}) {
      ply->append_number(coordinate);
    }
    for (const float number : {v.nx[i], v.ny[i], v.nz[i], v.weight_m2[i]}) {
      ply->append_number(number);
    }
    ply->append_number(static_cast<std::uint32_t>(i / v.block_points));
  }
  return ply->finish();
}

}  // namespace forcelayer::voxinfo
