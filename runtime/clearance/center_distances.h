// The distance of any place from the static mesh, proven from below: between voxel centers by the
// bound of voxmap_format.md, section 7, from stored distances, and from distances that are searched
// for (front.h) where none is stored, or where the stored one is to an object that is left out.
// Found distances are kept. No answer depends on earlier questions. For one thread at a time.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <unordered_map>
#include <vector>

#include "formats/voxmap.h"
#include "runtime/clearance/front.h"

namespace forcelayer::clearance {

class CenterDistances {
 public:
  // The map stores distances; both outlive this. Nothing is searched for beyond `cap_voxels`.
  CenterDistances(const Voxmap& voxmap, const LeftOut& left_out, double cap_voxels);

  // A lower bound of the distance of `place` (voxels, from the directory's lowest corner), in
  // voxels; about cap_voxels() for all that is farther. 0 beyond a cropped side.
  double at(const glm::dvec3& place);

  // The same from free space alone: no voxel within it is anything but free and known.
  double free_around(const glm::dvec3& place) const;

  // Whether the place lies beyond a cropped side.
  bool is_unknown(const glm::dvec3& place) const;

  // The object to which a place is nearest, and the most that it can be away from it, in voxels:
  // by the voxels next to the mesh. Infinity where no mesh is within reach.
  struct Nearest {
    std::uint32_t object = 0;
    double most_voxels = 0;
  };
  Nearest nearest(const glm::dvec3& place);

  double cap_voxels() const { return cap_; }

 private:
  // The centers of a brick's voxels and of those behind it along each axis.
  struct Block {
    static constexpr int kEdge = 9;
    static constexpr float kUnknown = -1;
    std::array<float, kEdge * kEdge * kEdge> squared;  // voxels^2; kUnknown: not searched for yet
    std::array<float, kEdge * kEdge * kEdge> known;    // voxels, where unknown: at least this
    bool has_near = false;
    struct Near {
      const Front* front;
      glm::vec3 low;  // of its brick, from the block's lowest corner
      float least;    // distance of any center of the block from any of its brick
    };
    std::vector<Near> near;  // by `least`, where it is asked for
  };

  Block& block_of(const BrickIndex& brick, std::uint64_t key);
  void read(const BrickIndex& brick, Block& block) const;
  void find_near(const BrickIndex& brick, Block& block);
  float search(const BrickIndex& brick, Block& block, int at);  // of its center `at`
  double side_distance(const glm::dvec3& place) const;

  const Voxmap& voxmap_;
  const LeftOut& left_out_;
  bool leaves_out_;
  double cap_;
  double quantum_, free_;  // voxels
  KnownBox known_;
  bool cropped_;
  glm::dvec3 tight_low_, tight_high_;  // of the non-free voxels
  bool all_free_;
  Fronts fronts_, mesh_fronts_;
  std::vector<BrickIndex> offsets_;  // of bricks that may be near, and how near at least
  std::vector<float> offset_least_;
  std::unordered_map<std::uint64_t, std::unique_ptr<Block>> blocks_;
  std::uint64_t last_key_ = ~std::uint64_t{0};
  Block* last_ = nullptr;
};

}  // namespace forcelayer::clearance
