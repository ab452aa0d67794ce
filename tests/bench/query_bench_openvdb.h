// The OpenVDB peer of the query benchmark.
#pragma once

#include <cstdint>
#include <memory>

#include "runtime/query/contact_query.h"

namespace forcelayer::bench {

// A ValueAccessor on the same tree: 8x8x8 leaves under two 8x8x8 levels and a root.
class AccessorQuery {
 public:
  explicit AccessorQuery(const Voxmap& voxmap);
  ~AccessorQuery();

  // Transforms every point as the contact query does, looks its voxel up, and hands on all that a
  // force field reads of those in values 1, 2 and 3. Their number.
  std::uint32_t collect(const query::ContactQuery& query, const Pose& world_from_center,
                        query::CollectedPoints& out) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace forcelayer::bench
