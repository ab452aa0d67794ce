// The walk along a path: every moment of it is covered by a distance proven at its two ends, or
// lies in a piece that is too near.
//
// Between two moments whose points travel S at most, every shell point is at least
//   (d_a + d_b - S) / 2
// from the static mesh, where d_a and d_b are proven for all points at the two moments; within one
// motion, whose points go along chords of at most S and deviate from these by at most `arc`, also
//   sqrt(min(d_a, d_b)^2 - S^2 / 4) - arc
// (voxmap_format.md, 13.4). What is not covered so is cut in two.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/clearance/center_path.h"
#include "runtime/clearance/part_distance.h"

namespace forcelayer::clearance {

// The part at a moment. Distances are those of shell points, in voxels.
struct Sample {
  Moment moment;
  double travel_m = 0;
  LeastDistance least;
};

// A piece of a path, from one sample to the next.
struct Piece {
  Moment from, to;
  double least_voxels = 0;  // proven for all of it
  bool too_near = false;    // nearer than required, or not told
  Sample worst;             // the nearer of its ends
};

struct WalkLimits {
  double required_voxels = 0;  // of shell points
  double least_voxels = 0;     // the least distance known so far: only what is less is looked for
};

// One walk. For one thread.
class PathWalk {
 public:
  // All outlive this.
  PathWalk(const CenterPath& path, PartDistance& part, double voxel_size_m,
           const WalkLimits& limits);

  // From one moment to another, appended to pieces().
  void walk(const Moment& from, const Moment& to);

  // In the order of time, without gaps.
  const std::vector<Piece>& pieces() const { return pieces_; }
  std::uint64_t tested() const { return tested_; }  // moments
  std::uint64_t motions_subdivided() const { return motions_subdivided_; }

 private:
  Sample sample(const Moment& moment, double enough_voxels);
  double proven_between(const Sample& a, const Sample& b) const;
  bool is_settled(const Sample& a, const Sample& b, double proven, double travel) const;
  Moment between(const Sample& a, const Sample& b);
  void cover(const Sample& a, const Sample& b);

  const CenterPath& path_;
  PartDistance& part_;
  double voxel_size_m_;
  WalkLimits limits_;
  std::vector<Piece> pieces_;
  std::uint64_t tested_ = 0, motions_subdivided_ = 0;
  std::size_t last_subdivided_ = ~std::size_t{0};
};

}  // namespace forcelayer::clearance
