// How deep a part goes into an object of its seat along its path, between its poses as at them. The
// depth (depth.h) is found at moments; where the surfaces are apart it is minus their distance.
// Between two moments whose points travel S at most, where no place is deeper than a and b, none is
// deeper than
//   (a + b + S) / 2
// where a place that is outside may come in through a crack as wide as e: a is no less than e, or
// e more where the surfaces are apart.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "runtime/clearance/center_path.h"
#include "workbench/exact/depth.h"
#include "workbench/exact/mesh_distance.h"

namespace forcelayer::exact {

using clearance::Moment;

class SeatWalk {
 public:
  // `part` about its centroid, `object` in the world; `distance` of the two. Depths are found to
  // `within_m`. All outlive this.
  SeatWalk(const clearance::CenterPath& path, const Bodies& part, const Bodies& object,
           const MeshPair& distance, double within_m);

  // The depth at a pose; less closely where it is far from `allowed_m`, if that is given.
  // Depth::place_m is of the part, Depth::foot_m of the object.
  Depth at_pose(const Pose& world_from_center, std::optional<double> allowed_m) const;

  // From here on tells how far deeper_than() is, as a share of it.
  void tell(std::function<void(double)> progress) { progress_ = std::move(progress); }

  // A stretch of which it is not proven that no place is deeper than allowed.
  struct Stretch {
    Moment from, to, worst_at;
    Depth worst;  // of all that was found
  };
  // Those between two moments, in the order of time. They are told to `resolution_m` of travel
  // where they begin and end.
  std::vector<Stretch> deeper_than(const Moment& from, const Moment& to, double allowed_m,
                                   double resolution_m);

  // The deepest place of all moments so far, and the moment.
  const std::optional<std::pair<Moment, Depth>>& deepest_so_far() const { return deepest_; }
  std::uint64_t measured() const { return depths_.size(); }

 private:
  const Depth& at(const Moment& moment, double allowed_m);
  double from_m(const Depth& depth) const;

  const clearance::CenterPath& path_;
  const Bodies& part_;
  const Bodies& object_;
  const MeshPair& distance_;
  double within_m_, crack_m_ = 0;
  std::map<std::pair<std::size_t, double>, Depth> depths_;
  std::optional<std::pair<Moment, Depth>> deepest_;
  std::function<void(double)> progress_ = [](double) {};
};

}  // namespace forcelayer::exact
