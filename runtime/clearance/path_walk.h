// The walk along a path. It cuts the path into pieces until each one is covered by the distances at
// its two ends, or is short and too near.
//
// Let every shell point be proven at least d_a from the static mesh at one moment and d_b at a
// later one, and let no point travel farther than S in between. Then at every moment in between
// every shell point is at least
//   (d_a + d_b - S) / 2
// from the mesh. Where no point deviates more than `e` from the straight way between its two
// places, it is also at least
//   sqrt(min(d_a, d_b)^2 - S^2 / 4) - e
// (voxmap_format.md, 13.4).
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
  MinDistance smallest;
};

// A piece of a path, from one sample to the next.
struct Piece {
  Moment from, to;
  double min_voxels = 0;  // proven for all of it
  bool too_near = false;  // not proven to be as far as required
  Sample worst;           // the nearer of its ends
};

struct WalkLimits {
  double required_voxels = 0;  // of shell points
  double min_voxels = 0;       // the least distance found so far; only lesser ones are looked for
};

// How far the shell points are at the ends of a way, as far as it is known; unknown below 0.
struct KnownEnds {
  static constexpr double kUnknown = -1;
  MinDistance first{kUnknown}, last{kUnknown};
};

// One walk. For one thread.
class PathWalk {
 public:
  // Path and part outlive this.
  PathWalk(const CenterPath& path, PartDistance& part, double voxel_size_m,
           const WalkLimits& limits);

  // Walks from one moment to another and appends to pieces().
  void walk(const Moment& from, const Moment& to);

  // The last moment up to which the required distance is proven, from `from` on; `from` where it
  // is too near itself. Where not all of the way is kept, the moment is found to a sixteenth of a
  // voxel of travel, or with `or_nothing` not at all. Adds no pieces. An end that is `known` is not
  // too near; it is looked at only where what is known of it is too little, and then known better.
  Moment kept_until(const Moment& from, const Moment& to, bool or_nothing, KnownEnds& known);

  // In the order of time, without gaps.
  const std::vector<Piece>& pieces() const { return pieces_; }
  std::uint64_t tested() const { return tested_; }  // moments
  std::uint64_t motions_subdivided() const { return motions_subdivided_; }

 private:
  Sample sample(const Moment& moment, double enough_voxels);
  double proven_between(const Sample& a, const Sample& b) const;
  double enough() const;
  double wanted() const;
  bool is_settled(const Sample& a, const Sample& b, double proven, double travel) const;
  Moment between(const Sample& a, const Sample& b);
  void cover(const Sample& a, const Sample& b);
  bool keep(const Sample& a, const Sample& b, bool or_nothing, Moment& until);
  Sample tested(const Moment& moment, double enough_voxels);
  Sample end(const Moment& moment, double enough_voxels, MinDistance& known);
  bool is_too_near(const Moment& moment);
  bool is_too_near_between(const Moment& from, const Moment& to);

  const CenterPath& path_;
  PartDistance& part_;
  double voxel_size_m_;
  WalkLimits limits_;
  double path_rounding_;  // of the place at a moment, and of the travel between two, in voxels
  double margin_;         // beyond a distance that is wanted between two moments, in voxels
  std::vector<Piece> pieces_;
  std::uint64_t tested_ = 0, motions_subdivided_ = 0;
  std::size_t last_subdivided_ = ~std::size_t{0};
};

}  // namespace forcelayer::clearance
