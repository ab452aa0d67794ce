// The peer that knows no voxels: FCL, mesh against mesh, oriented boxes with swept spheres (the
// fastest of its volumes here).
#pragma once

#include <cstdint>
#include <memory>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"

namespace forcelayer::bench {

class FclQuery {
 public:
  FclQuery(const mesh::Mesh& scene, const mesh::Mesh& part);
  ~FclQuery();

  // All contacts between the meshes; their number.
  std::uint32_t contacts(const Pose& world_from_part) const;
  // Distance between them, m.
  double distance_m(const Pose& world_from_part) const;

 private:
  struct Models;
  std::unique_ptr<Models> models_;
};

}  // namespace forcelayer::bench
