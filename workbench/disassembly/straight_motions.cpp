#include "workbench/disassembly/straight_motions.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "workbench/exact/seat_meshes.h"
#include "workbench/pairs/near_boxes.h"

namespace forcelayer::disassembly {
namespace {

constexpr double kSpeedMps = 0.1;
// A length for a work instruction: whole millimeters, or tenths of a short one. What is longer is
// never rounded to less.
double rounded_up_m(double length_m) {
  constexpr double kShortM = 0.02;
  const double tenths_m = std::ceil(length_m * 1e4) / 1e4;
  return tenths_m <= kShortM ? tenths_m : std::ceil(length_m * 1e3) / 1e3;
}

// So many axes are tried of a part's own features, and of each of its neighbors': those of the
// largest flat sides come first, then the lines in which these meet, such as the axis of a bore.
constexpr std::size_t kMaxOwnAxes = 12, kMaxAxesOfNeighbor = 4;
// Directions nearer to each other are one, rad: those that facets of a round side give differ by
// the rounding of the file's numbers, and each of them takes a long proof.
constexpr double kSameDirection = 1e-4;

}  // namespace

StraightMotions::StraightMotions(const PartShapes& shapes)
    : shapes_(shapes), features_(shapes.size()), proven_(shapes.size()), blocks_(shapes.size()) {
  for (const int axis : {2, 1, 0}) {
    for (const double sign : {1.0, -1.0}) {
      glm::dvec3 direction(0);
      direction[axis] = sign;
      directions_.push_back(direction);
    }
  }
}

std::size_t StraightMotions::add(const glm::dvec3& direction) {
  for (std::size_t n = 0; n < directions_.size(); ++n) {
    if (glm::length(directions_[n] - direction) < kSameDirection) return n;
  }
  directions_.push_back(direction);
  return directions_.size() - 1;
}

void StraightMotions::add_feature_directions(std::size_t part) {
  Parts& features = features_[part];
  if (!features.empty()) return;
  std::vector<glm::dvec3> axes;
  const auto add_axes = [&](std::size_t of_part, std::size_t max_count) {
    std::vector<glm::dvec3> own;
    exact::add_straight_axes(shapes_.surface(of_part), {1, 0, 0, 0}, own);
    own.resize(std::min(own.size(), max_count));
    axes.insert(axes.end(), own.begin(), own.end());
  };
  add_axes(part, kMaxOwnAxes);
  for (std::size_t object = 0; object < shapes_.size(); ++object) {
    if (object == part || !shapes_.installed(part, object).is_seat) continue;
    add_axes(object, kMaxAxesOfNeighbor);
  }
  for (const glm::dvec3& axis : axes) {
    for (const double sign : {1.0, -1.0}) {
      const std::size_t number = add(sign * axis);
      const bool is_known = std::find(features.begin(), features.end(), number) != features.end();
      if (number >= kAxisDirections && !is_known) features.push_back(number);
    }
  }
}

// Out of the box around all parts, so that the answer holds whatever other parts there are.
std::vector<PathRow> StraightMotions::rows_out(std::size_t direction) const {
  const mesh::Box& all = shapes_.box_of_all_m();
  const glm::dvec3 shift_m = length_m(directions_[direction], all, all) * directions_[direction];
  return rows_through({&shift_m, 1});
}

PairOutcome StraightMotions::outcome(std::size_t part, std::size_t direction, std::size_t object) {
  const std::pair key{direction, object};
  auto& proven = proven_[part];
  {
    const std::lock_guard lock(known_lock_);
    if (const auto found = proven.find(key); found != proven.end()) return found->second;
  }
  PairOutcome outcome = PairOutcome::kBlocked;
  if (!is_seen(part, direction, object)) {
    const clearance::CenterPath path(rows_out(direction), glm::dvec3(0), 0);  // it does not turn
    outcome = check_pair(path, shapes_.in_world(part), shapes_.in_world(object),
                         shapes_.installed(part, object), shapes_.rule(part, object));
  }
  const std::lock_guard lock(known_lock_);
  proven.emplace(key, outcome);
  return outcome;
}

bool StraightMotions::is_seen(std::size_t part, std::size_t direction, std::size_t object) {
  const std::pair key{direction, object};
  auto& blocks = blocks_[part];
  {
    const std::lock_guard lock(known_lock_);
    const auto& proven = proven_[part];
    if (const auto found = proven.find(key); found != proven.end()) {
      return found->second != PairOutcome::kFree;
    }
    if (const auto found = blocks.find(key); found != blocks.end()) return found->second;
  }
  const clearance::CenterPath path(rows_out(direction), glm::dvec3(0), 0);  // it does not turn
  const bool is_blocked =
      is_seen_blocked(path, shapes_.in_world(part), shapes_.in_world(object),
                      shapes_.installed(part, object), shapes_.rule(part, object));
  const std::lock_guard lock(known_lock_);
  blocks.emplace(key, is_blocked);
  return is_blocked;
}

// The nearest are the likeliest to be in the way.
Parts StraightMotions::by_gap(std::size_t part, const Parts& others) const {
  Parts by_gap = without(others, {part});
  const auto gap_m = [&](std::size_t object) {
    return pairs::distance_of(shapes_.box_m(part), shapes_.box_m(object));
  };
  std::stable_sort(by_gap.begin(), by_gap.end(),
                   [&](std::size_t a, std::size_t b) { return gap_m(a) < gap_m(b); });
  return by_gap;
}

bool StraightMotions::is_any_seen(std::size_t part, std::size_t direction, const Parts& others) {
  const Parts objects = by_gap(part, others);
  return std::any_of(objects.begin(), objects.end(),
                     [&](std::size_t object) { return is_seen(part, direction, object); });
}

bool StraightMotions::is_free(std::size_t part, std::size_t direction, const Parts& others) {
  const Parts objects = by_gap(part, others);
  return !is_any_seen(part, direction, others) &&
         std::all_of(objects.begin(), objects.end(), [&](std::size_t object) {
           return outcome(part, direction, object) == PairOutcome::kFree;
         });
}

Parts StraightMotions::seen_blockers(std::size_t part, std::size_t direction, const Parts& others) {
  Parts found;
  for (const std::size_t object : others) {
    if (object != part && is_seen(part, direction, object)) found.push_back(object);
  }
  return found;
}

double StraightMotions::length_m(const glm::dvec3& direction, const mesh::Box& moved,
                                 const mesh::Box& rest) const {
  // More than end_gap_m() of any pair asks for, by far more than the rounding of a place. A part
  // that is outside already goes as far.
  const double gap_m = shapes_.max_end_gap_m() * (1 + 0x1p-10);
  double length_m = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = direction[static_cast<int>(axis)];
    if (along == 0) continue;
    const double beside_m = along > 0 ? rest.high[axis] - moved.low[axis] + gap_m
                                      : moved.high[axis] - rest.low[axis] + gap_m;
    length_m = std::min(length_m, std::max(gap_m, beside_m) / std::abs(along));
  }
  return rounded_up_m(length_m);
}

double StraightMotions::length_m(const Parts& parts, const glm::dvec3& displaced_m,
                                 const glm::dvec3& direction, const Parts& others) const {
  mesh::Box moved = mesh::empty_box(), rest = mesh::empty_box();
  for (const std::size_t part : parts) mesh::extend(moved, shapes_.box_m(part));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    moved.low[axis] += displaced_m[static_cast<int>(axis)];
    moved.high[axis] += displaced_m[static_cast<int>(axis)];
  }
  for (const std::size_t other : others) {
    if (std::find(parts.begin(), parts.end(), other) == parts.end()) {
      mesh::extend(rest, shapes_.box_m(other));
    }
  }
  return length_m(direction, moved, rest);
}

std::vector<PathRow> rows_through(std::span<const glm::dvec3> shifts_m) {
  std::vector<PathRow> rows(1);
  glm::dvec3 last_m(0);
  for (const glm::dvec3& shift_m : shifts_m) {
    const double time_s = rows.back().time_s + glm::length(shift_m - last_m) / kSpeedMps;
    rows.push_back({time_s, {shift_m.x, shift_m.y, shift_m.z}, {1, 0, 0, 0}});
    last_m = shift_m;
  }
  return rows;
}

}  // namespace forcelayer::disassembly
