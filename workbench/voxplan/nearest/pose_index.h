// Finds the exact nearest of the poses of a planner's tree. It is a kd-tree whose leaves hold
// coordinates side by side. Distances in single precision select the poses of a leaf that are
// compared in double precision.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <vector>

#include "forcelayer/pose.h"

namespace forcelayer::voxplan {

// The distance of two poses in a planner's tree, m: that of the positions, plus `turn_m` times the
// chord between the orientations, which is twice the sine of a quarter of the turn. It is a metric.
// It is exactly 0 from a pose to itself: else OMPL's trees may hold a pose twice, and free it
// twice.
inline double pose_distance_m(const Pose& from, const Pose& to, double turn_m) {
  const glm::dquat &p = from.orientation, &q = to.orientation;
  const glm::dquat chord = glm::dot(p, q) < 0 ? p + q : p - q;  // q and -q are one orientation
  return glm::length(to.position_m - from.position_m) + turn_m * glm::length(chord);
}

// A pose as coordinates: its position, 0, and its orientation times `turn_m`, with w >= 0.
using PoseCoordinates = std::array<float, 8>;

class PoseIndex {
 public:
  explicit PoseIndex(double turn_m) : turn_m_(turn_m) {}

  // Numbers are given from 0 on.
  void add(const Pose& pose);
  void clear();
  std::size_t size() const { return poses_.size(); }

  // The number of the nearest pose by pose_distance_m(); of equally near ones the smallest number.
  // The index must not be empty.
  std::uint32_t nearest(const Pose& pose) const;

 private:
  static constexpr std::uint32_t kLeafPoses = 256;  // a multiple of the lanes of any vector
  static constexpr std::size_t kColumns = 7;        // the coordinates without the 0
  struct Leaf {
    std::array<std::array<float, kLeafPoses>, kColumns> columns;
    std::array<std::uint32_t, kLeafPoses> numbers;
    std::uint32_t count = 0;
  };
  struct Node {
    PoseCoordinates low, high;      // of its poses
    std::uint32_t first_child = 0;  // the other child follows it; 0 for a leaf
    std::uint32_t leaf = 0, axis = 0;
    float cut = 0;  // coordinate along that axis where the second child begins
  };
  struct Best {
    double distance_m;
    std::uint32_t number;
  };
  struct Branch {
    float min_m;
    std::uint32_t node;
  };
  friend struct PoseSearch;

  PoseCoordinates coordinates(const Pose& pose) const;
  std::uint32_t make_node(std::uint32_t leaf);
  void put(std::uint32_t node, std::uint32_t number);
  void split(std::uint32_t node);
  void compare(const Pose& pose, std::uint32_t number, Best& best) const;

  double turn_m_;
  double largest_m_ = 0;  // of all coordinates
  std::vector<Pose> poses_;
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  mutable std::vector<Branch> open_;
  // The last answer. A planner queries the same pose until its other tree gets no nearer.
  mutable Pose last_;
  mutable Best last_best_{0, 0};
  mutable std::size_t last_size_ = 0;  // number of poses at that query
};

}  // namespace forcelayer::voxplan
