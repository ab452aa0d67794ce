#include "runtime/query/shell_neighbors.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::query {
namespace {

// Whether points of two blocks can lie within a distance of each other, with room for the rounding
// of their spheres.
bool are_near(const BoundingSphere& a, const BoundingSphere& b, float distance_m) {
  const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  const float reach_m = 1.001f * (a.radius + b.radius + distance_m) +
                        1e-6f * (std::abs(a.x) + std::abs(a.y) + std::abs(a.z));
  return x * x + y * y + z * z <= reach_m * reach_m;
}

}  // namespace

ShellNeighbors::ShellNeighbors(const PshellView& shell, double distance_m)
    : ranges_(shell.point_count) {
  const auto near_m = static_cast<float>(distance_m);
  std::vector<std::uint32_t> blocks;
  for (std::uint32_t i = 0; i < shell.point_count; ++i) {
    const std::uint32_t own = i / shell.block_points;
    if (i % shell.block_points == 0) {
      blocks.clear();
      for (std::uint32_t b = own; b < shell.block_count; ++b) {
        if (are_near(shell.blocks[own], shell.blocks[b], near_m)) blocks.push_back(b);
      }
    }
    ranges_[i].first = static_cast<std::uint32_t>(neighbors_.size());
    for (const std::uint32_t b : blocks) {
      const std::uint64_t begin =
          std::max(std::uint64_t{i} + 1, std::uint64_t{b} * shell.block_points);
      const std::uint64_t end =
          std::min(shell.point_count, (std::uint64_t{b} + 1) * shell.block_points);
      for (std::uint64_t j = begin; j < end && ranges_[i].count < kMax; ++j) {
        const float x = shell.x[j] - shell.x[i], y = shell.y[j] - shell.y[i],
                    z = shell.z[j] - shell.z[i];
        if (x * x + y * y + z * z > near_m * near_m) continue;
        neighbors_.push_back(static_cast<std::uint32_t>(j));
        ++ranges_[i].count;
      }
    }
  }
}

}  // namespace forcelayer::query
