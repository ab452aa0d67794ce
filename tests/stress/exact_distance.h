// Distance between the exact meshes, by a library that knows neither voxels nor points (FCL).
#pragma once

#include <memory>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"

namespace forcelayer::stress {

class ExactDistance {
 public:
  // `scene` in world, `part` in the part's frame, m.
  ExactDistance(const mesh::Mesh& scene, const mesh::Mesh& part);
  ~ExactDistance();
  ExactDistance(ExactDistance&&) noexcept;

  // Smallest distance between the two surfaces, or `at_most_m` where that is less; 0 where they
  // meet.
  double at(const Pose& world_from_part, double at_most_m = 1e300) const;

 private:
  struct Models;
  std::unique_ptr<Models> models_;
};

// The smallest distance over a path. Poses whose distance cannot be a new minimum are not measured:
// a distance changes by at most the way that any point of the part goes. Nor is a distance measured
// to the end that is above the minimum by more than kSlackM.
class PathDistance {
 public:
  // A campaign of several paths asks only for the smallest distance of all: `below_m` is
  // that of the paths before, and what is above it is not looked for.
  PathDistance(const ExactDistance& exact, double part_radius_m, double below_m = 1e300)
      : exact_(exact), radius_m_(part_radius_m), smallest_m_(below_m) {}

  // Takes the next pose of the path. `center_m` is the point of the part frame that the radius is
  // about.
  void visit(const Pose& world_from_part, const glm::dvec3& center_m);

  // The smallest distance of the path, or `below_m` where no pose is nearer.
  double smallest_m() const { return smallest_m_; }
  std::uint64_t visited() const { return visited_; }
  std::uint64_t measured() const { return measured_; }

 private:
  static constexpr double kSlackM = 0.002;

  const ExactDistance& exact_;
  double radius_m_;
  double smallest_m_;
  double at_least_m_ = 0;  // lower bound of the distance at the pose last visited
  bool started_ = false;
  Pose last_;
  std::uint64_t visited_ = 0, measured_ = 0;
};

}  // namespace forcelayer::stress
