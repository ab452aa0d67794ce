// A lower bound of the distance of any place from the static mesh. The bound between voxel centers
// (voxmap_format.md, section 7) needs the distances of eight centers. A stored distance serves
// where there is one and its object counts; else the distance is searched for (front.h) and kept.
// No answer depends on earlier questions. For one thread at a time.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <memory>
#include <unordered_map>
#include <vector>

#include "formats/voxmap.h"
#include "runtime/clearance/front.h"

namespace forcelayer::clearance {

class CenterDistances {
 public:
  // The map stores distances. Map and table outlive this. Searches end at `cap_voxels`.
  CenterDistances(const Voxmap& voxmap, const LeftOut& left_out, double cap_voxels);

  // A lower bound of the distance of `place` (voxels, from the directory's lowest corner), in
  // voxels. Places farther than cap_voxels() get about that. 0 beyond a cropped side.
  double at(const glm::dvec3& place);

  // A lower bound from the clearances of free entries alone, voxels. 0 where the place is not free,
  // and beyond a cropped side.
  double free_around(const glm::dvec3& place) const;

  // Whether a distance at() of the place is that to a cropped side, or the place lies beyond it.
  bool is_of_side(const glm::dvec3& place, double voxels) const;

  // The object nearest to a place, and an upper bound of its distance, in voxels, both from the
  // voxels next to the mesh. The bound is infinity where the search finds no mesh.
  struct Nearest {
    std::uint32_t object = 0;
    double max_voxels = 0;
  };
  Nearest nearest(const glm::dvec3& place);

  double cap_voxels() const { return cap_; }

 private:
  // The centers of a brick's voxels and of those behind it along each axis, where distances are
  // searched for beside those that are stored.
  static constexpr std::size_t kCenters = 9 * 9 * 9;
  struct Searched {
    static constexpr float kUnknown = -1;
    std::array<float, kCenters> squared;  // voxels^2; kUnknown: not searched for yet
    std::array<float, kCenters> known;    // lower bound where unknown, voxels
    bool has_near = false;
    struct Near {
      const Front* front;
      glm::vec3 low;   // of its brick, from the block's lowest corner
      float smallest;  // distance of any center of the block from any of its brick
    };
    std::vector<Near> near;  // ascending by `smallest`; filled once has_near
  };
  // The same where the stored ones are all: a byte a center, so that the blocks of a whole search
  // stay in the processor's caches.
  struct Block {
    std::array<std::uint8_t, kCenters> code;  // into squared_of_code_
    std::unique_ptr<Searched> searched;       // then without codes
  };

  Block& block_of(const BrickIndex& brick, std::uint64_t key);
  void read(const BrickIndex& brick, Block& block) const;
  void find_near(const BrickIndex& brick, Searched& block);
  float search(const BrickIndex& brick, Searched& block, int at);  // of its center `at`
  double side_distance(const glm::dvec3& place) const;

  const Voxmap& voxmap_;
  const LeftOut& left_out_;
  bool leaves_out_;
  double cap_;
  bool searches_;                                           // for distances that are not stored
  std::array<float, 256> known_of_code_, squared_of_code_;  // voxels, voxels^2: lower bounds
  double quantum_, free_;                                   // voxels
  KnownBox known_;
  bool cropped_;
  glm::dvec3 tight_low_, tight_high_;  // of the non-free voxels
  bool all_free_;
  Fronts fronts_, mesh_fronts_;
  std::vector<BrickIndex> offsets_;  // to bricks within the cap, the nearest first
  std::vector<float> offset_min_;    // least distance between a center here and one there
  std::unordered_map<std::uint64_t, std::unique_ptr<Block>> blocks_;
  // Some of the blocks by a hash of their keys: those that poses beside each other ask for.
  struct Slot {
    std::uint64_t key = ~std::uint64_t{0};
    Block* block = nullptr;
  };
  static constexpr int kSlotBits = 13;
  static std::size_t slot_of(std::uint64_t key) {
    return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15u >> (64 - kSlotBits));
  }
  std::array<Slot, std::size_t{1} << kSlotBits> slots_;
};

}  // namespace forcelayer::clearance
