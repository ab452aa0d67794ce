// How deep a part goes into an object of its seat along its path, between its poses as at them. The
// depth (depth.h) is found at moments; where the surfaces are apart it is minus their distance.
// That it is nowhere more than allowed between two moments is proven by motion_proof.h. What is
// allowed may be as little as the rounding of the files: no proof needs more.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "runtime/clearance/center_path.h"
#include "workbench/exact/depth.h"
#include "workbench/exact/mesh_distance.h"
#include "workbench/exact/motion_proof.h"

namespace forcelayer::exact {

using clearance::Moment;

class SeatWalk {
 public:
  // `part` about its centroid, `object` in the world; `distance` of the two. Depths are found to
  // `within_m`. All outlive this.
  SeatWalk(const clearance::CenterPath& path, const Bodies& part, const Bodies& object,
           const MeshPair& distance, double within_m);

  // The depth at a pose; less closely where it is far from `allowed_m`, if that is given, and else
  // by this fraction of it. Depth::place_m is of the part, Depth::foot_m of the object.
  Depth at_pose(const Pose& world_from_center, std::optional<double> allowed_m,
                double within_fraction = 0, const DepthProgress& progress = {}) const;

  // Whether each of the part's bodies has an inside or each of the object's has: then one surface
  // that passes through the other is deep in it.
  bool is_settled() const;

  // From here on reports how far deeper_than() is, as a fraction of it.
  void tell(std::function<void(double)> progress) { progress_ = std::move(progress); }

  // A stretch of which it is not proven that no place is deeper than allowed, and no surface passes
  // through a wall of the other.
  struct Stretch {
    Moment from, to, worst_at;
    Depth worst;               // the deepest of all that was found
    bool is_deeper = false;    // than allowed; else it is too close to call
    bool passes_wall = false;  // it is no deeper, but may pass through a wall: from `worst` on
  };
  // Those between two moments, in the order of time. They are found to `resolution_m` of travel
  // where they begin and end; one that is too close to call is found to `within_m`. The search ends
  // behind the first in which it is deeper, unless `all` are asked for. Where a Watch stops it,
  // what was found counts if it is deeper.
  std::vector<Stretch> deeper_than(const Moment& from, const Moment& to, double allowed_m,
                                   double resolution_m, bool all = false);

  // From here on deeper_than() does not look at walls. Where a user allows a depth, as for a hook
  // that snaps over an edge, the part changes its side there.
  void allow_passing() { may_pass_ = true; }

  // Until when the last search has proven or found something.
  double reached_s() const { return reached_s_; }

  // The deepest place between two moments, of so many and some about the deepest of them; `known`
  // is one of them.
  static constexpr std::size_t kMoments = 12;
  Stretch deepest_of(const Moment& from, const Moment& to, const Moment& known,
                     std::size_t moments = kMoments);

  // The deepest place of all moments so far, and the moment.
  const std::optional<std::pair<Moment, Depth>>& deepest_so_far() const { return deepest_; }
  std::uint64_t measured() const { return depths_.size(); }

 private:
  // Parts of the surface of one body of both that may go too deep into one of the other.
  struct Open {
    std::size_t number;  // of the pair of bodies, in all_
    const Body *surface, *solid;
    bool is_of_part;
    Parts parts;
  };
  using Opens = std::vector<Open>;
  Opens not_proven(const Opens& open, const Moment& begin, const Moment& end, double allowed_m,
                   std::size_t max_open);
  // A piece that is no deeper than allowed in a motion, but may meet the solid.
  struct Met {
    Moment begin, end;
    part::Piece piece;
  };
  // A motion as the solid sees it: that of the part, or that of the object as the part sees it.
  Motion motion_of(bool is_of_part, const Moment& begin, const Moment& end) const;
  std::optional<Stretch> passage(double allowed_m);
  Stretch begin_of(const Met& change, const Open& pair) const;
  std::optional<Met> changes_side(const Open& open, double allowed_m, std::uint64_t max_cells,
                                  std::optional<Met> first) const;
  // The depth at a moment, and at a pose, of these parts. Those that are proven need not be among
  // them to know whether it is more than allowed.
  const Depth& at(const Moment& moment, std::optional<double> allowed_m, const Opens& open);
  const Depth& at(const Moment& moment, std::optional<double> allowed_m);
  Depth depth_of(const Opens& open, const Pose& world_from_center, std::optional<double> allowed_m,
                 double within_fraction, const DepthProgress& progress) const;
  void find_worst(Stretch& stretch, std::size_t moments = kMoments);

  const clearance::CenterPath& path_;
  const Bodies& part_;
  const Bodies& object_;
  const MeshPair& distance_;
  Opens all_;                          // of both surfaces
  std::vector<std::vector<Met>> met_;  // of each of these, in the last search
  bool may_pass_ = false;
  double within_m_, radius_m_ = 0;  // radius of the part about its centroid
  std::map<std::tuple<std::size_t, double, bool>, Depth> depths_;
  std::optional<std::pair<Moment, Depth>> deepest_;
  std::function<void(double)> progress_ = [](double) {};
  double reached_s_ = 0;
};

}  // namespace forcelayer::exact
