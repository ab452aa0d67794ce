// Contact wrenches from meshes, as the collision libraries give their contacts: at every contact a
// force along its normal, in proportion to its depth.
#pragma once

#include <memory>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"

namespace forcelayer::bench {

// A part's and a static scene's wrench by some library. The unit of force is the library's meter of
// depth; torque is about the part's origin, world axes.
class MeshContacts {
 public:
  virtual ~MeshContacts() = default;
  virtual void set_scene(const mesh::Mesh& scene) = 0;  // world, m; first of all
  virtual Wrench at(const Pose& world_from_part) = 0;
};

// FCL 0.7: collide() of OBBRSS trees with all contacts. `part` in its frame, m.
std::unique_ptr<MeshContacts> fcl_contacts(const mesh::Mesh& part);

// FCL 0.7: distance() of OBBRSS trees. One force between the two nearest points, in proportion to
// how much nearer than `offset_m` they are.
std::unique_ptr<MeshContacts> fcl_distance(const mesh::Mesh& part, double offset_m);

}  // namespace forcelayer::bench
