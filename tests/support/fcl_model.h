// Meshes and poses as FCL takes them, for the measures and peers that know neither voxels nor
// points.
#pragma once

#include <fcl/geometry/bvh/BVH_model.h>

#include <memory>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"

namespace forcelayer::testing {

// The mesh's triangles in a tree of bounding volumes: fcl::RSSd, fcl::OBBRSSd.
template <class BoundingVolume>
std::shared_ptr<fcl::BVHModel<BoundingVolume>> fcl_model(const mesh::Mesh& mesh) {
  auto model = std::make_shared<fcl::BVHModel<BoundingVolume>>();
  model->beginModel(static_cast<int>(mesh.triangles.size()),
                    static_cast<int>(mesh.vertices.size()));
  const auto vertex = [&](std::uint32_t i) {
    const mesh::Vec3d& v = mesh.vertices[i];
    return fcl::Vector3d(v[0], v[1], v[2]);
  };
  for (const mesh::Triangle& t : mesh.triangles) {
    model->addTriangle(vertex(t[0]), vertex(t[1]), vertex(t[2]));
  }
  model->endModel();
  return model;
}

inline fcl::Transform3d fcl_transform(const Pose& pose) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  const glm::dquat& q = pose.orientation;
  transform.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  transform.translation() = fcl::Vector3d(pose.position_m.x, pose.position_m.y, pose.position_m.z);
  return transform;
}

}  // namespace forcelayer::testing
