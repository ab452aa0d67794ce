#include "tests/bench/query_bench_openvdb.h"

#include <openvdb/openvdb.h>
#include <openvdb/tree/Tree.h>
#include <openvdb/tree/ValueAccessor.h>

#include <cmath>

namespace forcelayer::bench {
namespace {

using ByteTree = openvdb::tree::Tree4<std::uint8_t, 3, 3, 3>::Type;

// Copies the entries below one node of the voxmap, `edge` voxels an entry.
class TreeCopy {
 public:
  TreeCopy(const Voxmap& voxmap, ByteTree& tree) : view_(voxmap.view()), tree_(tree) {}

  void copy() {
    const auto& dims = view_.directory_dims;
    const std::uint32_t* entry = view_.directory;
    for (int x = 0; x < dims[0]; ++x)
      for (int y = 0; y < dims[1]; ++y)
        for (int z = 0; z < dims[2]; ++z)
          copy_entry(*entry++, origin(512 * x, 512 * y, 512 * z), 3);
  }

 private:
  openvdb::Coord origin(int x, int y, int z) const {
    const auto& from = view_.directory_origin;
    return {x + static_cast<int>(from[0]), y + static_cast<int>(from[1]),
            z + static_cast<int>(from[2])};
  }

  void copy_entry(std::uint32_t entry, const openvdb::Coord& at, unsigned level) {
    if (is_uniform(entry)) {
      const auto value = static_cast<std::uint8_t>(uniform_value(entry));
      if (value != 0) tree_.addTile(level, at, value, true);
      return;
    }
    if (level == 1) {
      copy_brick(entry, at);
      return;
    }
    const std::uint32_t* entries =
        (level == 3 ? view_.upper_nodes : view_.lower_nodes) + std::uint64_t{entry} * kNodeEntries;
    const int edge = level == 3 ? 64 : 8;
    for (int n = 0; n < 512; ++n) {
      copy_entry(entries[n], at.offsetBy(edge * (n >> 6), edge * (n >> 3 & 7), edge * (n & 7)),
                 level - 1);
    }
  }

  void copy_brick(std::uint32_t brick, const openvdb::Coord& at) {
    auto* leaf = tree_.touchLeaf(at);
    for (unsigned n = 0; n < 512; ++n) {
      const std::uint32_t word = view_.bricks[std::uint64_t{brick} * 32 + n / 16];
      const auto value = static_cast<std::uint8_t>(word >> (2 * (n % 16)) & 3);
      if (value != 0) leaf->setValueOn(n, value);
    }
  }

  const VoxmapView& view_;
  ByteTree& tree_;
};

// Calls at(pose, position, point) with the position of every point, in voxels from the center's.
template <class At>
void place_points(const query::ContactQuery& query, const Pose& world_from_center, At at) {
  const query::VoxelPose pose = query.voxel_pose(world_from_center);
  const PshellView& shell = query.shell().view();
  for (std::uint64_t n = 0; n < shell.point_count; ++n) {
    float position[3];
    for (int axis = 0; axis < 3; ++axis) {
      const auto& row = pose.turn[axis];
      position[axis] =
          row[0] * shell.x[n] + row[1] * shell.y[n] + row[2] * shell.z[n] + pose.fraction[axis];
    }
    at(pose, position, n);
  }
}

}  // namespace

struct AccessorQuery::Tree {
  ByteTree tree{0};
};

AccessorQuery::AccessorQuery(const Voxmap& voxmap) : tree_(std::make_unique<Tree>()) {
  TreeCopy(voxmap, tree_->tree).copy();
}
AccessorQuery::~AccessorQuery() = default;

std::uint32_t AccessorQuery::collect(const query::ContactQuery& query,
                                     const Pose& world_from_center,
                                     query::CollectedPoints& out) const {
  const auto& origin = query.voxmap().header().directory_origin;
  const auto s = static_cast<float>(query.voxmap().voxel_size_m());
  const PshellView& shell = query.shell().view();
  openvdb::tree::ValueAccessor<const ByteTree> accessor(tree_->tree);
  out.clear();
  place_points(query, world_from_center,
               [&](const query::VoxelPose& pose, const float(&position)[3], std::uint64_t n) {
                 openvdb::Coord voxel;
                 std::int32_t relative[3];
                 float fraction[3];
                 for (int axis = 0; axis < 3; ++axis) {
                   const float whole = std::floor(position[axis]);
                   relative[axis] = pose.whole[axis] + static_cast<std::int32_t>(whole);
                   fraction[axis] = position[axis] - whole;
                   voxel[axis] = relative[axis] + static_cast<std::int32_t>(origin[axis]);
                 }
                 const std::uint8_t value = accessor.getValue(voxel);
                 if (value == 0) return;
                 const std::uint32_t at = out.count++;
                 out.index[at] = static_cast<std::uint32_t>(n);
                 out.value[at] = value;
                 out.vx[at] = relative[0], out.vy[at] = relative[1], out.vz[at] = relative[2];
                 out.fx[at] = fraction[0], out.fy[at] = fraction[1], out.fz[at] = fraction[2];
                 out.rx[at] = (position[0] - pose.fraction[0]) * s;
                 out.ry[at] = (position[1] - pose.fraction[1]) * s;
                 out.rz[at] = (position[2] - pose.fraction[2]) * s;
                 float normal[3];
                 for (int axis = 0; axis < 3; ++axis) {
                   const auto& row = pose.rotation[axis];
                   normal[axis] =
                       row[0] * shell.nx[n] + row[1] * shell.ny[n] + row[2] * shell.nz[n];
                 }
                 out.nx[at] = normal[0], out.ny[at] = normal[1], out.nz[at] = normal[2];
               });
  return out.count;
}

}  // namespace forcelayer::bench
