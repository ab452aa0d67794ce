// OpenVDB peers of the query benchmark, which look up the same points and only count them.
#pragma once

#include <cstdint>
#include <memory>

#include "formats/mesh/mesh.h"
#include "runtime/query/contact_query.h"

namespace forcelayer::bench {

// A ValueAccessor on the same tree: 8x8x8 leaves under two 8x8x8 levels and a root.
class AccessorQuery {
 public:
  explicit AccessorQuery(const Voxmap& voxmap);
  ~AccessorQuery();

  // Transforms every point as the contact query does, looks its voxel up, and counts those in
  // values 1, 2 and 3.
  std::uint32_t count(const query::ContactQuery& query, const Pose& world_from_center) const;

  // The same, and what the contact query does: hands on all that a force field reads of them.
  std::uint32_t collect(const query::ContactQuery& query, const Pose& world_from_center,
                        query::CollectedPoints& out) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

// A level set of the scene's mesh at the same voxel size, four voxels to each side.
class LevelSetQuery {
 public:
  LevelSetQuery(const mesh::Mesh& scene, double voxel_size_m);
  ~LevelSetQuery();

  // Points whose distance, interpolated trilinearly, is below three and a half voxels.
  std::uint32_t count(const query::ContactQuery& query, const Pose& world_from_center) const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace forcelayer::bench
