#include "formats/path/path_edit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/path/quaternion.h"

namespace forcelayer {
namespace {

using Vector = std::array<double, 3>;

double length(const Vector& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

Vector difference(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Vector rotated(const Quaternion& q, const Vector& v) {
  const Quaternion r = product(product(q, {0, v[0], v[1], v[2]}), conjugate(q));
  return {r[1], r[2], r[3]};
}

// The angle from one orientation to another, the short way round.
double angle_between(const Quaternion& from, const Quaternion& to) {
  const Quaternion turn = product(to, conjugate(from));
  return 2 * std::atan2(length({turn[1], turn[2], turn[3]}), std::abs(turn[0]));
}

// A fraction of the way from one orientation to another.
Quaternion between(const Quaternion& from, const Quaternion& to, double fraction) {
  const Quaternion turn = product(to, conjugate(from));
  const Vector axis{turn[1], turn[2], turn[3]};
  const double sine = length(axis), angle = angle_between(from, to) * fraction;
  if (sine < 1e-12) return from;
  const double scale = std::sin(angle / 2) / sine * (turn[0] < 0 ? -1 : 1);
  Quaternion q =
      product({std::cos(angle / 2), axis[0] * scale, axis[1] * scale, axis[2] * scale}, from);
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& part : q) part /= norm;
  return q;
}

Vector center_of(const PathRow& row, const Vector& center_m) {
  const Vector arm = rotated(row.orientation_wxyz, center_m);
  return {row.position_m[0] + arm[0], row.position_m[1] + arm[1], row.position_m[2] + arm[2]};
}

// The distance of a point from the axis about which the part turns between two rows, as far as the
// orientation tells: that of the arm from a point on the axis.
double radius_of_turn_m(const PathRow& from, const PathRow& to, const Vector& arm_m) {
  const Quaternion turn = product(to.orientation_wxyz, conjugate(from.orientation_wxyz));
  const Vector axis{turn[1], turn[2], turn[3]}, arm = rotated(from.orientation_wxyz, arm_m);
  const double sine = length(axis);  // of half the angle
  if (!(sine > 0)) return 0;
  return length({axis[1] * arm[2] - axis[2] * arm[1], axis[2] * arm[0] - axis[0] * arm[2],
                 axis[0] * arm[1] - axis[1] * arm[0]}) /
         sine;
}

}  // namespace

PathFacts path_facts(std::span<const PathRow> rows, const std::array<double, 3>& center_m) {
  PathFacts facts;
  facts.poses = rows.size();
  facts.begin_s = rows.front().time_s;
  facts.end_s = rows.back().time_s;
  Vector before = facts.low_m = facts.high_m = center_of(rows.front(), center_m);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const Vector here = center_of(rows[i], center_m);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      facts.low_m[axis] = std::min(facts.low_m[axis], here[axis]);
      facts.high_m[axis] = std::max(facts.high_m[axis], here[axis]);
    }
    const double step_m = length(difference(here, before));
    const double turn_rad = angle_between(rows[i - 1].orientation_wxyz, rows[i].orientation_wxyz);
    facts.length_m += step_m;
    facts.turn_rad += turn_rad;
    facts.max_step_m = std::max(facts.max_step_m, step_m);
    facts.max_turn_rad = std::max(facts.max_turn_rad, turn_rad);
    facts.max_mps = std::max(facts.max_mps, step_m / (rows[i].time_s - rows[i - 1].time_s));
    before = here;
  }
  return facts;
}

WideStep widest_step(std::span<const PathRow> rows, const std::array<double, 3>& center_m) {
  WideStep widest;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const double turn_rad = angle_between(rows[i].orientation_wxyz, rows[i + 1].orientation_wxyz);
    const double quarter = std::sin(turn_rad / 4);
    const double aside_m = 2 * quarter * quarter *
                           radius_of_turn_m(rows[i], rows[i + 1], center_m);  // 1 - cos(turn / 2)
    if (!(aside_m > widest.aside_m)) continue;
    widest = {i, turn_rad,
              length(difference(center_of(rows[i + 1], center_m), center_of(rows[i], center_m))),
              aside_m};
  }
  return widest;
}

Result<std::vector<PathRow>> turned_about(std::span<const PathRow> rows,
                                          const std::array<double, 3>& pivot_m,
                                          const std::array<double, 3>& center_m, double within_m) {
  const Vector arm_m = difference(center_m, pivot_m);
  std::vector<PathRow> all{rows.front()};
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const PathRow &from = rows[i], &to = rows[i + 1];
    const double turn_rad = angle_between(from.orientation_wxyz, to.orientation_wxyz);
    const double radius_m = radius_of_turn_m(from, to, arm_m);
    const double steps = std::max(1.0, std::ceil(turn_rad * std::sqrt(radius_m / (8 * within_m))));
    if (!(static_cast<double>(all.size()) + steps <= double{kMaxPathRows})) {
      return Error{ErrorCode::kUsage, "", "",
                   "a path that turns about this point needs too many poses",
                   "check the unit of the point"};
    }
    for (double n = 1; n < steps; ++n) {
      const double time_s = from.time_s + n / steps * (to.time_s - from.time_s);
      if (!(time_s > all.back().time_s && time_s < to.time_s)) {
        return Error{ErrorCode::kUsage, "", "",
                     "two rows are too near in time to add poses between them",
                     "shift all times so that the path begins at 0 s"};
      }
      all.push_back(pose_at(rows.subspan(i, 2), time_s, pivot_m));
    }
    all.push_back(to);
  }
  return all;
}

PathRow pose_at(std::span<const PathRow> rows, double time_s,
                const std::array<double, 3>& center_m) {
  const auto next = std::upper_bound(rows.begin(), rows.end(), time_s,
                                     [](double t, const PathRow& row) { return t < row.time_s; });
  if (next == rows.begin()) return {time_s, rows[0].position_m, rows[0].orientation_wxyz};
  const PathRow& from = *(next - 1);
  if (next == rows.end()) return {time_s, from.position_m, from.orientation_wxyz};
  const double fraction = (time_s - from.time_s) / (next->time_s - from.time_s);
  const Vector a = center_of(from, center_m), b = center_of(*next, center_m);
  PathRow row{time_s, {}, between(from.orientation_wxyz, next->orientation_wxyz, fraction)};
  const Vector arm = rotated(row.orientation_wxyz, center_m);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    row.position_m[axis] = a[axis] + (b[axis] - a[axis]) * fraction - arm[axis];
  }
  return row;
}

std::vector<PathRow> resampled(std::span<const PathRow> rows, double period_s,
                               const std::array<double, 3>& center_m) {
  std::vector<PathRow> samples{rows.front()};
  const double begin_s = rows.front().time_s;
  const double min_s = 1e-9 * period_s;  // a sample that is nearer to a row is the row
  double n = 1;
  for (const PathRow& row : rows.subspan(1)) {
    for (; begin_s + n * period_s < row.time_s - min_s; ++n) {
      // Late times are coarse: two may be the same double.
      const double time_s = begin_s + n * period_s;
      if (time_s > samples.back().time_s + min_s) {
        samples.push_back(pose_at(rows, time_s, center_m));
      }
    }
    samples.push_back(row);
  }
  return samples;
}

std::vector<PathRow> thinned(std::span<const PathRow> rows, const std::array<double, 3>& center_m,
                             double radius_m, double within_m) {
  // Douglas and Peucker: between two kept rows, the row that is off farthest is kept, if it is off
  // by too much, and then the same on both sides of it.
  std::vector<bool> is_kept(rows.size());
  is_kept.front() = is_kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> spans{{0, rows.size() - 1}};
  while (!spans.empty()) {
    const auto [first, last] = spans.back();
    spans.pop_back();
    const PathRow ends[] = {rows[first], rows[last]};
    double farthest_m = within_m;
    std::size_t farthest = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const PathRow there = pose_at(ends, rows[i].time_s, center_m);
      const double shift_m =
          length(difference(center_of(there, center_m), center_of(rows[i], center_m)));
      const double turn_rad = angle_between(there.orientation_wxyz, rows[i].orientation_wxyz);
      const double off_m = shift_m + turn_rad * radius_m;
      if (!(off_m > farthest_m)) continue;
      farthest_m = off_m;
      farthest = i;
    }
    if (farthest == first) continue;
    is_kept[farthest] = true;
    spans.push_back({first, farthest});
    spans.push_back({farthest, last});
  }
  std::vector<PathRow> kept;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (is_kept[i]) kept.push_back(rows[i]);
  }
  return kept;
}

std::vector<PathRow> reversed(std::span<const PathRow> rows) {
  std::vector<PathRow> back;
  const double sum_s = rows.front().time_s + rows.back().time_s;
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    back.push_back({sum_s - row->time_s, row->position_m, row->orientation_wxyz});
  }
  return back;
}

}  // namespace forcelayer
