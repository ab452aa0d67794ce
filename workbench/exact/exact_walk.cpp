#include "workbench/exact/exact_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace forcelayer::exact {

ExactWalk::ExactWalk(const clearance::CenterPath& path, const MeshPair& everything,
                     const MeshPair& seated, double rounding_m)
    : path_(path), everything_(everything), seated_(seated), rounding_m_(rounding_m) {}

const Sample& ExactWalk::at(const Moment& moment, bool seated, double hint_m) {
  const auto [place, is_new] =
      samples_.try_emplace({moment.pose, moment.fraction, seated}, Sample{moment, {}, seated});
  if (is_new) {
    const MeshPair& pair = seated ? seated_ : everything_;
    place->second.measured = pair.at(path_.world_from_center(moment), hint_m);
  }
  return place->second;
}

double ExactWalk::between_m(const Sample& a, const Sample& b) const {
  const double way = path_.travel_m(b.moment) - path_.travel_m(a.moment);
  const double from = a.measured.distance_m, to = b.measured.distance_m;
  const double by_travel = (from + to - way) / 2;
  const double nearer = std::min(from, to), chord = nearer * nearer - way * way / 4;
  if (!(chord > 0)) return std::max(0.0, by_travel);
  const double by_chord = std::sqrt(chord) - path_.deviation_m(a.moment, b.moment);
  return std::max({0.0, by_travel, by_chord});
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

std::pair<Piece, Piece> ExactWalk::cut(const Piece& piece) {
  const Moment half = path_.middle(piece.from, piece.to);
  Piece first{piece.from, half, piece.min_m, piece.seated};
  Piece second{half, piece.to, piece.min_m, piece.seated};
  measure(first);
  measure(second);
  return {first, second};
}

ExactWalk::Least ExactWalk::smallest(std::vector<Piece> pieces, double within_m,
                                     std::optional<Sample> known) {
  const auto later = [](const Piece& a, const Piece& b) { return a.min_m > b.min_m; };
  std::priority_queue<Piece, std::vector<Piece>, decltype(later)> open(later, std::move(pieces));
  Least found;
  found.sample.measured.distance_m = 2 * kNothingM;
  const auto take = [&](const Sample& sample) {
    if (sample.measured.distance_m < found.sample.measured.distance_m) found.sample = sample;
  };
  if (known) take(*known);
  double widest_m = 0;  // between what was found and what is proven
  while (!open.empty()) {
    Piece piece = open.top();
    const double enough = found.sample.measured.distance_m - within_m;
    if (piece.min_m >= enough || found.sample.measured.distance_m == 0) break;
    open.pop();
    widest_m = std::max(widest_m, enough - piece.min_m);
    progress_(1 - (enough - piece.min_m) / widest_m);
    if (piece.is_measured) {
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
  found.at_least_m = found.sample.measured.distance_m;
  if (!open.empty()) found.at_least_m = std::min(found.at_least_m, open.top().min_m);
  return found;
}

std::vector<Piece> ExactWalk::nearer_than(const Piece& whole, double required_m,
                                          double resolution_m) {
  // Where both ends are too near, what is between is looked at only this closely.
  const double coarse_m = 16 * resolution_m;
  std::vector<Piece> nearer, open{whole};
  while (!open.empty()) {
    Piece piece = open.back();
    open.pop_back();
    measure(piece);
    progress_((path_.travel_m(piece.from) - path_.travel_m(whole.from)) /
              std::max(travel_m(whole), std::numeric_limits<double>::min()));
    if (piece.min_m >= required_m) continue;
    const double from_m = at(piece.from, piece.seated).measured.distance_m;
    const double to_m = at(piece.to, piece.seated).measured.distance_m;
    const double travel = travel_m(piece);
    if (travel <= resolution_m || (std::max(from_m, to_m) < required_m && travel <= coarse_m)) {
      nearer.push_back(piece);
      continue;
    }
    const auto [first, second] = cut(piece);
    open.push_back(second);
    open.push_back(first);
  }
  return nearer;
}

}  // namespace forcelayer::exact
