#include "tests/bench/query_bench_accessor.h"

#include <openvdb/openvdb.h>
#include <openvdb/tree/Tree.h>
#include <openvdb/tree/ValueAccessor.h>

#include <cmath>

namespace forcelayer::bench {

struct AccessorQuery::Tree {
  using Type = openvdb::tree::Tree4<std::uint8_t, 3, 3, 3>::Type;
  Type tree{0};
};

AccessorQuery::AccessorQuery(const test::VoxelScene& scene) : tree_(std::make_unique<Tree>()) {
  for (std::int64_t i = 0; i < scene.dims[0]; ++i)
    for (std::int64_t j = 0; j < scene.dims[1]; ++j)
      for (std::int64_t k = 0; k < scene.dims[2]; ++k) {
        const test::Voxel v{scene.min[0] + i, scene.min[1] + j, scene.min[2] + k};
        if (scene.at(v) == VoxelValue::kFree) continue;
        tree_->tree.setValueOn(openvdb::Coord(int(v[0]), int(v[1]), int(v[2])),
                               static_cast<std::uint8_t>(scene.at(v)));
      }
  tree_->tree.prune();
}

AccessorQuery::~AccessorQuery() = default;

std::uint32_t AccessorQuery::count(const ContactQuery& query, const Pose& world_from_center) const {
  const VoxelPose pose = query.voxel_pose(world_from_center);
  const auto& origin = query.voxmap().header().directory_origin;
  const PshellView& shell = query.shell().view();
  openvdb::tree::ValueAccessor<const Tree::Type> accessor(tree_->tree);
  std::uint32_t found = 0;
  for (std::uint64_t n = 0; n < shell.point_count; ++n) {
    openvdb::Coord voxel;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& row = pose.turn[axis];
      const float position =
          row[0] * shell.x[n] + row[1] * shell.y[n] + row[2] * shell.z[n] + pose.fraction[axis];
      voxel[axis] = pose.whole[axis] + static_cast<std::int32_t>(std::floor(position)) +
                    static_cast<std::int32_t>(origin[axis]);
    }
    found += accessor.getValue(voxel) != 0;
  }
  return found;
}

}  // namespace forcelayer::bench
