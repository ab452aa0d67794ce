// The peer of the query benchmark: the same points looked up with an OpenVDB ValueAccessor in the
// same tree (8x8x8 leaves under two 8x8x8 levels and a root).
#pragma once

#include <cstdint>
#include <memory>

#include "formats/pshell.h"
#include "runtime/contact_query.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::bench {

class AccessorQuery {
 public:
  explicit AccessorQuery(const test::VoxelScene& scene);
  ~AccessorQuery();

  // Transforms every point as the contact query does, looks its voxel up, and counts those in
  // values 1, 2 and 3.
  std::uint32_t count(const ContactQuery& query, const Pose& world_from_center) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace forcelayer::bench
