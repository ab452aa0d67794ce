#include "workbench/exact/exact_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace forcelayer::exact {
namespace {

// Between more poses a path bends too far for a proof.
constexpr std::size_t kMaxPosesBetween = 8;
// Into more pieces a stretch in which the part is too near all the time is not cut.
constexpr double kCoarsePieces = 256;

}  // namespace

ExactWalk::ExactWalk(const clearance::CenterPath& path, const MeshPair& everything,
                     const MeshPair& seated, double rounding_m)
    : path_(path), everything_(everything), seated_(seated), rounding_m_(rounding_m) {}

const Sample& ExactWalk::at(const Moment& moment, bool seated, double hint_m) {
  const std::tuple key{moment.pose, moment.fraction, seated};
  if (const auto known = samples_.find(key); known != samples_.end()) return known->second;
  const MeshPair& pair = seated ? seated_ : everything_;
  const MeshDistance measured = pair.at(path_.world_from_center(moment), hint_m);
  return samples_.emplace(key, Sample{moment, measured, seated}).first->second;
}

double ExactWalk::between_m(const Sample& a, const Sample& b) const {
  return min_between_m(a.measured.distance_m, b.measured.distance_m,
                       path_.travel_m(b.moment) - path_.travel_m(a.moment),
                       [&] { return path_.deviation_m(a.moment, b.moment); });
}

// Measures the distance at the ends, and holds it against what was said of the piece.
void ExactWalk::measure(Piece& piece) {
  if (piece.is_measured) return;
  const Sample& from = at(piece.from, piece.seated);
  const Sample& to =
      at(piece.to, piece.seated, from.measured.distance_m + travel_m(piece) + rounding_m_);
  for (const Sample* end : {&from, &to}) {
    const double exact = end->measured.distance_m;
    if (exact + rounding_m_ >= piece.min_m || contradiction_) continue;
    contradiction_ = {path_.time_s(end->moment), exact, piece.min_m};
  }
  piece.min_m = std::max(piece.min_m, between_m(from, to));
  piece.is_measured = true;
}

// Whether the meshes are proven to stay `min_m` apart, by their triangles.
bool ExactWalk::stays_apart(const Piece& piece, double min_m) const {
  if (clearance::CenterPath::between(piece.from, piece.to).count() > kMaxPosesBetween) return false;
  const MeshPair& pair = piece.seated ? seated_ : everything_;
  return pair.stays_apart(path_.world_from_center(piece.from), path_.world_from_center(piece.to),
                          path_.deviation_m(piece.from, piece.to), min_m + rounding_m_);
}

std::pair<Piece, Piece> ExactWalk::cut(const Piece& piece) {
  const Moment half = path_.middle(piece.from, piece.to);
  Piece first{piece.from, half, piece.min_m, piece.seated};
  Piece second{half, piece.to, piece.min_m, piece.seated};
  measure(first);
  measure(second);
  return {first, second};
}

ExactWalk::Least ExactWalk::smallest(std::vector<Piece> pieces, double within_m,
                                     std::optional<Sample> known, double within_fraction) {
  const auto later = [](const Piece& a, const Piece& b) { return a.min_m > b.min_m; };
  std::priority_queue<Piece, std::vector<Piece>, decltype(later)> open(later, std::move(pieces));
  Least found;
  found.sample.measured.distance_m = 2 * kNothingM;
  const auto take = [&](const Sample& sample) {
    if (sample.measured.distance_m < found.sample.measured.distance_m) found.sample = sample;
  };
  if (known) take(*known);
  double widest_m = 0;              // between what was found and what is proven
  double proven_m = 2 * kNothingM;  // of pieces that are settled
  while (!open.empty()) {
    Piece piece = open.top();
    const double found_m = found.sample.measured.distance_m;
    const double enough = found_m - std::max(within_m, within_fraction * found_m);
    if (piece.min_m >= enough || found_m == 0) break;
    open.pop();
    widest_m = std::max(widest_m, enough - piece.min_m);
    progress_(1 - (enough - piece.min_m) / widest_m);
    if (piece.is_measured) {
      if (stays_apart(piece, enough)) {
        proven_m = std::min(proven_m, enough);
        continue;
      }
      const auto [first, second] = cut(piece);
      take(at(first.to, piece.seated));
      open.push(first);
      open.push(second);
    } else {
      measure(piece);
      take(at(piece.from, piece.seated));
      take(at(piece.to, piece.seated));
      open.push(piece);
    }
  }
  found.at_least_m = std::min(found.sample.measured.distance_m, proven_m);
  if (!open.empty()) found.at_least_m = std::min(found.at_least_m, open.top().min_m);
  return found;
}

std::vector<Piece> ExactWalk::nearer_than(const Piece& whole, double required_m,
                                          double resolution_m, bool first_only) {
  // Where both ends are too near, what is between is looked at only this closely.
  const double coarse_m = std::max(16 * resolution_m, travel_m(whole) / kCoarsePieces);
  std::vector<Piece> nearer, open{whole};
  while (!open.empty()) {
    Piece piece = open.back();
    open.pop_back();
    reached_s_ = path_.time_s(piece.from);
    measure(piece);
    progress_((path_.travel_m(piece.from) - path_.travel_m(whole.from)) /
              std::max(travel_m(whole), std::numeric_limits<double>::min()));
    if (piece.min_m >= required_m || stays_apart(piece, required_m)) continue;
    const double from_m = at(piece.from, piece.seated).measured.distance_m;
    const double to_m = at(piece.to, piece.seated).measured.distance_m;
    const double travel = travel_m(piece);
    if (travel <= resolution_m || (std::max(from_m, to_m) < required_m && travel <= coarse_m)) {
      nearer.push_back(piece);
      if (first_only) break;
      continue;
    }
    const auto [first, second] = cut(piece);
    open.push_back(second);
    open.push_back(first);
  }
  return nearer;
}

std::optional<Sample> ExactWalk::nearest_between(const Moment& from, const Moment& to,
                                                 bool seated) const {
  std::optional<Sample> nearest;
  for (const auto& [key, sample] : samples_) {
    const double at_s = path_.time_s(sample.moment);
    if (sample.seated != seated || at_s < path_.time_s(from) || at_s > path_.time_s(to)) continue;
    const bool is_nearer = !nearest || sample.measured.distance_m < nearest->measured.distance_m;
    if (is_nearer) nearest = sample;
  }
  return nearest;
}

std::optional<Moment> ExactWalk::first_as_far(Piece piece, double distance_m, double resolution_m,
                                              bool backwards) {
  measure(piece);
  const double along_m = path_.travel_m(backwards ? piece.to : piece.from);
  const double whole_m = path_.travel_m({path_.poses() - 1, 0});
  if (whole_m > 0) progress_(backwards ? 1 - along_m / whole_m : along_m / whole_m);
  const Moment& first = backwards ? piece.to : piece.from;
  const Moment& last = backwards ? piece.from : piece.to;
  const double first_m = at(first, piece.seated).measured.distance_m;
  const double last_m = at(last, piece.seated).measured.distance_m;
  if (first_m >= distance_m) return first;
  const double travel = travel_m(piece);
  // No distance grows faster than the part travels.
  if ((first_m + last_m + travel) / 2 < distance_m) return {};
  if (travel <= resolution_m) return last_m >= distance_m ? std::optional(last) : std::nullopt;
  auto [early, late] = cut(piece);
  if (backwards) std::swap(early, late);
  if (const auto found = first_as_far(early, distance_m, resolution_m, backwards)) return found;
  return first_as_far(late, distance_m, resolution_m, backwards);
}

}  // namespace forcelayer::exact
