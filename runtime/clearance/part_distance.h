// The least proven distance of a part's shell points from the static mesh, at a pose. The points
// are halved again and again, down to eight; of two halves the nearer one is looked at first. A
// half is skipped if its bounding sphere is known to be farther than the nearest point so far, or
// if it was so far when last looked at that it cannot have come nearer since. The answer is at
// least that of looking at every point, and at most the truth.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/clearance/center_distances.h"

namespace forcelayer::clearance {

struct LeastDistance {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  double voxels = 0;  // no shell point is nearer than this to the static mesh
  // The point at that distance; kNone where no point is nearer than was asked for.
  std::uint32_t point = kNone;
};

// For one thread at a time.
class PartDistance {
 public:
  // Map, shell and table outlive this. Distances beyond `cap_voxels` are not told apart.
  PartDistance(const Voxmap& voxmap, const Pshell& shell, const LeftOut& left_out,
               double cap_voxels);

  // Forgets what was looked at: the poses to come are of another path.
  void forget();

  // The least distance where it is below `enough_voxels`; else a lower bound of it, at least
  // enough_voxels where that can be proven. `travel_m`: how far any point of the part may have
  // travelled since the path's beginning, CenterPath::travel_m(). Once a point below `stop_voxels`
  // is found, no nearer one is looked for; the point that ended the last such search is looked at
  // first.
  LeastDistance at(const Pose& world_from_center, double travel_m, double enough_voxels,
                   double stop_voxels = 0);

  // A shell point's place in the world, m.
  glm::dvec3 place_m(const Pose& world_from_center, std::uint32_t point) const;

  // The object nearest to a place, and an upper bound of its distance.
  CenterDistances::Nearest nearest(const glm::dvec3& place_m);
  bool is_unknown(const glm::dvec3& place_m) const;

  // How far this arithmetic may misplace a point, m.
  double rounding_m() const { return rounding_m_; }

 private:
  // A bounding sphere, with a lower bound of its points' distance and the travel at which that
  // bound was found.
  struct Node {
    glm::dvec3 center{0};              // from the centroid, voxels
    double radius = 0;                 // voxels
    double least = 0;                  // voxels
    double travel = 0;                 // voxels
    std::uint64_t path = 0;            // of the bound
    std::uint32_t second = 0;          // half; the first is the node behind this one. 0: points
    std::uint32_t begin = 0, end = 0;  // of its points in order_
  };
  struct Place;  // of the part, in voxels from the directory on

  void make_nodes(std::span<std::uint32_t> blocks);
  void make_points(std::size_t begin, std::size_t end, std::size_t groups);
  std::uint32_t add_node();
  void enclose_halves(std::uint32_t node);
  double distance(const Place& place, std::size_t point);
  glm::dvec3 to_voxels(const glm::dvec3& place_m) const;
  double known(const Node& node, const Place& place) const;
  double bound(const Place& place, Node& node);
  bool look_at(const Place& place, std::uint32_t node);
  bool look_at_points(const Place& place, Node& node);
  double limit() const { return best_.voxels < enough_ ? best_.voxels : enough_; }
  bool stops() const { return best_.voxels < stop_; }

  const Voxmap& voxmap_;
  const Pshell& shell_;
  CenterDistances distances_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  // of the points
  glm::dvec3 directory_;              // voxels
  double radius_;                     // voxels
  double rounding_m_;
  std::uint64_t path_ = 1;                          // how often all was forgotten
  std::uint32_t last_points_ = 0;                   // the node of the nearest point
  std::uint32_t last_stop_ = LeastDistance::kNone;  // the point that ended a search
  // The search at the current pose.
  LeastDistance best_;
  double wished_ = 0, enough_ = 0;  // the question's enough_voxels; the same, at most the cap
  double stop_ = 0;
  double rest_ = 0;  // the least bound of the spheres that were skipped
};

}  // namespace forcelayer::clearance
