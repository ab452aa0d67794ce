// The exact distance along a path, between its poses as at them. It is measured at moments, and
// what it is at least in between follows from how far the part's points travel (conservative
// advancement). Between two moments whose points travel S at most, where the distances are a and b:
//   (a + b - S) / 2                    no point comes nearer than it goes
//   sqrt(min(a, b)^2 - S^2 / 4) - e    where points deviate from straight ways by e at most
// The latter holds of each point of the part, because the squared distance to any set, less the
// square of the place, is concave (voxmap_format.md, 13.4). Where that is too little, the hulls of
// the triangles that move are held against those that stand (mesh_distance.h).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "runtime/clearance/center_path.h"
#include "workbench/exact/mesh_distance.h"

namespace forcelayer::exact {

using clearance::Moment;
using Progress = std::function<void(double fraction)>;

// The least distance between two moments at which it is `from_m` and `to_m`, as above: `travel_m`
// is S, and `deviation_m()` e, asked for where it matters.
template <typename Deviation>
double min_between_m(double from_m, double to_m, double travel_m, const Deviation& deviation_m) {
  const double by_travel = (from_m + to_m - travel_m) / 2;
  const double nearer = std::min(from_m, to_m);
  const double chord = nearer * nearer - travel_m * travel_m / 4;
  if (!(chord > 0)) return std::max(0.0, by_travel);
  return std::max({0.0, by_travel, std::sqrt(chord) - deviation_m()});
}

// The surfaces at a moment.
struct Sample {
  Moment moment;
  MeshDistance measured;
  bool seated = false;
};

// A piece of a path.
struct Piece {
  Moment from, to;
  double min_m = 0;          // the distance is at least this in all of it
  bool seated = false;       // the seat's objects do not count
  bool is_measured = false;  // at its ends
};

class ExactWalk {
 public:
  // All outlive this. `everything` holds all objects that count, `seated` those that count while
  // the part is in its seat. `rounding_m`: of a measured distance.
  ExactWalk(const clearance::CenterPath& path, const MeshPair& everything, const MeshPair& seated,
            double rounding_m);

  // From here on reports how far a search is, as a fraction of it.
  void tell(Progress progress) { progress_ = std::move(progress); }

  const Sample& at(const Moment& moment, bool seated, double hint_m = kNothingM);

  // The least distance of the pieces, and what it is at least in all of them: these differ by
  // `within_m` at most, or by this fraction of it. `known`: a sample of the path, where one is at
  // hand.
  struct Least {
    Sample sample;
    double at_least_m = 0;
  };
  Least smallest(std::vector<Piece> pieces, double within_m, std::optional<Sample> known = {},
                 double within_fraction = 0);

  // Those parts of a piece, in the order of time, of which it is not proven that the distance is
  // `required_m` or more. Their begin and end are found to `resolution_m` of travel, and breaks in
  // a long one to a part of its length.
  // `first_only`: no more than the first of them is asked for.
  std::vector<Piece> nearer_than(const Piece& piece, double required_m, double resolution_m,
                                 bool first_only = false);

  // The first moment of a piece at which the distance is `distance_m` or more; with `backwards` the
  // last. One that lasts for less than `resolution_m` of travel may be missed.
  std::optional<Moment> first_as_far(Piece piece, double distance_m, double resolution_m,
                                     bool backwards = false);

  // Until when the last search has looked at its pieces, which follow each other.
  double reached_s() const { return reached_s_; }

  // The sample with the least distance of those between two moments; nothing if no sample lies
  // there.
  std::optional<Sample> nearest_between(const Moment& from, const Moment& to, bool seated) const;

  double time_s(const Moment& moment) const { return path_.time_s(moment); }
  std::uint64_t measured() const { return samples_.size(); }

  // A moment at which the meshes are nearer than the pieces given said.
  struct Contradiction {
    double time_s = 0, exact_m = 0, proven_m = 0;
  };
  const std::optional<Contradiction>& contradiction() const { return contradiction_; }

 private:
  static constexpr double kNothingM = voxcheck::kNothingM;

  void measure(Piece& piece);
  bool stays_apart(const Piece& piece, double min_m) const;
  double between_m(const Sample& a, const Sample& b) const;
  std::pair<Piece, Piece> cut(const Piece& piece);
  double travel_m(const Piece& piece) const {
    return path_.travel_m(piece.to) - path_.travel_m(piece.from);
  }

  const clearance::CenterPath& path_;
  const MeshPair& everything_;
  const MeshPair& seated_;
  double rounding_m_;
  std::map<std::tuple<std::size_t, double, bool>, Sample> samples_;
  std::optional<Contradiction> contradiction_;
  Progress progress_ = [](double) {};
  double reached_s_ = 0;
};

}  // namespace forcelayer::exact
