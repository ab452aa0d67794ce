// The least proven distance of a part's shell points from the static mesh, at a pose. A block is
// skipped if its bounding sphere is known to be farther than the nearest point so far, or if it was
// so far when last looked at that it cannot have come nearer since; so are groups of a block's
// points. The answer is at least that of looking at every point, and at most the truth.
#pragma once

#include <cstdint>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/clearance/center_distances.h"

namespace forcelayer::clearance {

struct MinDistance {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  double voxels = 0;  // no shell point is nearer than this to the static mesh
  // The point at that distance; kNone where no point is nearer than was asked for.
  std::uint32_t point = kNone;
};

// For one thread at a time.
class PartDistance {
 public:
  // Map, shell and table outlive this. All distances beyond `cap_voxels` count as that.
  PartDistance(const Voxmap& voxmap, const Pshell& shell, const LeftOut& left_out,
               double cap_voxels);

  // Forgets what was looked at: the poses to come are of another path.
  void forget();

  // The least distance where it is below `enough_voxels`; else a lower bound of it, at least
  // enough_voxels where that can be proven. `travel_m`: how far any point of the part may have
  // travelled since the path's beginning, CenterPath::travel_m(). Once a point below `stop_voxels`
  // is found, no nearer one is looked for; the point that ended the last such search is looked at
  // first.
  MinDistance at(const Pose& world_from_center, double travel_m, double enough_voxels,
                 double stop_voxels = 0);

  // A shell point's place in the world, m.
  glm::dvec3 place_m(const Pose& world_from_center, std::uint32_t point) const;

  // The object nearest to a place, and an upper bound of its distance.
  CenterDistances::Nearest nearest(const glm::dvec3& place_m);
  // Whether a point's distance there is that to a cropped side.
  bool is_of_side(const glm::dvec3& place_m, double voxels) const;

  // How far this arithmetic may misplace a point, m.
  double rounding_m() const { return rounding_m_; }

  std::uint64_t points_looked_at() const { return points_looked_at_; }

 private:
  // Bounding spheres, each with a lower bound of its points' distance and the travel at which that
  // bound was found.
  struct Level {
    std::vector<double> smallest;         // voxels
    std::vector<double> travel;           // voxels
    std::vector<glm::dvec3> center;       // from the centroid, voxels
    std::vector<double> radius;           // voxels
    std::vector<std::uint64_t> question;  // for which what is below was last forgotten
    double now(std::size_t i, double at) const {
      return smallest[i] - (at > travel[i] ? at - travel[i] : travel[i] - at);
    }
  };
  struct Place;  // of the part, in voxels from the directory on

  void make_groups();
  void forget_below(Level& level, std::size_t i, Level& below, std::size_t first, std::size_t end);
  std::size_t first_group(std::size_t block) const { return block * groups_a_block_; }
  double distance(const Place& place, std::size_t point);
  bool look_at_group(const Place& place, std::size_t group);
  static Level make_level(const BoundingSphere* spheres, std::uint64_t count, double voxel_size_m);
  glm::dvec3 to_voxels(const glm::dvec3& place_m) const;
  void look_at_block(const Place& place, std::size_t block);
  void look_at_blocks(const Place& place, std::size_t super_block);
  bool is_far(const Place& place, Level& level, std::size_t i, bool closely);
  double limit() const { return best_.voxels < enough_ ? best_.voxels : enough_; }
  bool stops() const { return best_.voxels < stop_; }

  const Voxmap& voxmap_;
  const Pshell& shell_;
  CenterDistances distances_;
  Level blocks_, super_blocks_;
  // Points of a block that lie beside each other; none in those beyond the last point's.
  std::size_t groups_a_block_;
  Level groups_;
  std::vector<std::uint32_t> order_;        // of the points, group by group
  std::vector<std::uint32_t> group_first_;  // [groups + 1], in that order
  glm::dvec3 directory_;                    // voxels
  double radius_;                           // voxels
  double rounding_m_;
  std::size_t last_block_ = 0;
  std::uint64_t question_ = 0;                    // one more with each forget()
  std::uint32_t last_stop_ = MinDistance::kNone;  // the point that ended a search
  std::uint64_t points_looked_at_ = 0;
  // The search at the current pose.
  MinDistance best_;
  double wished_ = 0, enough_ = 0;  // the question's enough_voxels; the same, at most the cap
  double stop_ = 0;
  double rest_ = 0;  // the least bound of the spheres that were skipped
};

}  // namespace forcelayer::clearance
