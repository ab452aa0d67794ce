#include "workbench/disassembly/disassembly.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "formats/command/command.h"
#include "formats/command/text.h"
#include "workbench/disassembly/part_shapes.h"
#include "workbench/disassembly/straight_motions.h"
#include "workbench/exact/watch.h"
#include "workbench/pairs/near_boxes.h"
#include "workbench/pairs/threads.h"

namespace forcelayer::disassembly {
namespace {

constexpr double kEverywhereM = 1e100;
// So many lengths of a first leg are tried for each pair of directions.
constexpr std::size_t kMaxFirstLegs = 6;

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double volume_m3(const mesh::Box& box) {
  double volume = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) volume *= box.high[axis] - box.low[axis];
  return volume;
}

double length_of(const std::vector<PathRow>& rows) {
  double length_m = 0;
  for (std::size_t n = 1; n < rows.size(); ++n) {
    const auto &a = rows[n - 1].position_m, &b = rows[n].position_m;
    length_m += std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
  }
  return length_m;
}

class Disassembly {
 public:
  Disassembly(const pairs::AssemblyParts& assembly, const Request& request,
              const Observer& observer)
      : request_(request),
        observer_(observer),
        shapes_(assembly, request.required_m, request.rules),
        motions_(shapes_) {}

  Outcome run() {
    Parts all(shapes_.size());
    for (std::size_t part = 0; part < all.size(); ++part) all[part] = part;
    if (!request_.target.empty()) {
      free_target(all);
    } else {
      take_all(all);
    }
    outcome_.is_out_of_time = is_over_;
    return std::move(outcome_);
  }

 private:
  // --- time

  bool is_over() {
    const bool is_late = request_.max_s && steady_s() - begun_s_ >= *request_.max_s;
    if (is_late || command::stop_signal() != 0) is_over_ = true;
    return is_over_;
  }

  template <typename Work>
  void for_each_part(const char* stage, const Parts& parts, const Work& work) {
    pairs::for_each_number(
        parts.size(),
        [&](std::size_t n) {
          if (is_over()) return;
          const exact::Watch watch([this] { return !is_over(); });
          try {
            work(parts[n]);
          } catch (const exact::Stopped&) {  // the time is over: what is known by now stays
          }
        },
        [&](std::size_t done) {
          const double gone = static_cast<double>(shapes_.size() - left_count_),
                       now = static_cast<double>(done) / static_cast<double>(parts.size());
          observer_.progress(command::text("%s, %zu of %zu parts are out", stage,
                                           shapes_.size() - left_count_, shapes_.size()),
                             (gone + now) / static_cast<double>(shapes_.size() + 1));
        });
  }

  // --- the whole assembly

  void take_all(const Parts& all) {
    const Parts left = rounds(all, {});
    outcome_.base = base_of(left);
    if (left.size() > 1) explain(without(left, {*outcome_.base}), left);
    for (std::size_t n = 0; n < outcome_.steps.size(); ++n) {
      const Parts group = outcome_.steps[n].parts;
      if (group.size() == 1) continue;
      const Parts together = rounds(group, group);
      if (together.size() > 1) explain(without(together, {base_of(together)}), together);
    }
  }

  // Takes parts away until no more come out, or the target is out, and returns those that are left.
  Parts rounds(Parts present, const Parts& from) {
    // On the way to a target not every step is needed: they are told when that is known.
    const bool tells = request_.target.empty();
    while (present.size() > 1 && (tells || has_target(present))) {
      left_count_ = present.size();
      std::vector<Step> steps;
      if (tells) steps = observer_.recall(present);
      const bool is_known = !steps.empty();
      if (!is_known && is_over()) break;
      if (steps.empty()) steps = axis_steps(present);
      if (steps.empty()) steps = feature_steps(present);
      if (steps.empty()) steps = two_leg_steps(present);
      if (steps.empty()) steps = group_steps(present);
      if (steps.empty()) break;
      for (Step& step : steps) step.from = from;
      if (tells && !is_known) finish(steps, present);
      if (!is_known && is_over()) break;  // the round may lack steps, and what they overlap
      if (tells) observer_.found(present, steps, is_known);
      for (Step& step : steps) {
        present = without(present, step.parts);
        outcome_.steps.push_back(std::move(step));
      }
    }
    return present;
  }

  // The steps of a round leave one after the other: the last of them need not go so far, and what
  // left before is near no path. A group that is taken apart outside is beside itself alone.
  void finish(std::vector<Step>& steps, const Parts& present) {
    std::map<Parts, Parts> rest_of{{{}, present}};  // by where parts are taken from
    std::vector<Parts> others;
    for (const Step& step : steps) {
      Parts& rest = rest_of.try_emplace(step.from, step.from).first->second;
      rest = without(rest, step.parts);
      others.push_back(rest);
    }
    Parts numbers(steps.size());
    for (std::size_t n = 0; n < numbers.size(); ++n) numbers[n] = n;
    for_each_part("measuring", numbers, [&](std::size_t n) { measure(steps[n], others[n]); });
  }

  // The largest part stays, but for a target: the others are taken off it.
  std::size_t base_of(const Parts& present) const {
    const Parts may_stay = without(present, request_.target);
    return largest_of(may_stay.empty() ? present : may_stay);
  }
  std::size_t largest_of(const Parts& parts) const {
    return *std::max_element(parts.begin(), parts.end(), [&](std::size_t a, std::size_t b) {
      return volume_m3(shapes_.box_m(a)) < volume_m3(shapes_.box_m(b));
    });
  }

  Parts movable(const Parts& present) const { return without(present, {base_of(present)}); }

  // --- steps of one kind

  Step straight_step(Parts parts, std::size_t direction, const Parts& present,
                     const char* settled_by) const {
    Step step;
    const glm::dvec3 shift_m =
        motions_.length_m(parts, direction, present) * motions_.direction(direction);
    step.parts = std::move(parts);
    step.rows = rows_through({&shift_m, 1});
    step.settled_by = settled_by;
    return step;
  }

  std::vector<Step> axis_steps(const Parts& present) {
    std::vector<std::optional<std::size_t>> free(shapes_.size());
    for_each_part("straight motions along the axes", movable(present),
                  [&](std::size_t part) { free[part] = shortest_free_axis(part, present); });
    return straight_steps(free, present);
  }

  std::vector<Step> feature_steps(const Parts& present) {
    std::vector<std::optional<std::size_t>> free(shapes_.size());
    find_features(movable(present));
    for_each_part("straight motions along features", movable(present), [&](std::size_t part) {
      for (const std::size_t direction : motions_.feature_directions(part)) {
        if (!motions_.is_free(part, direction, present)) continue;
        free[part] = direction;
        return;
      }
    });
    return straight_steps(free, present);
  }

  // [parts] `free`: the direction in which each leaves.
  std::vector<Step> straight_steps(const std::vector<std::optional<std::size_t>>& free,
                                   const Parts& present) const {
    std::vector<Step> steps;
    for (const std::size_t part : present) {
      if (!free[part]) continue;
      steps.push_back(straight_step({part}, *free[part], present, "meshes, one straight leg"));
    }
    return steps;
  }

  std::optional<std::size_t> shortest_free_axis(std::size_t part, const Parts& present) {
    std::optional<std::size_t> best;
    double best_m = 0;
    for (std::size_t d = 0; d < StraightMotions::kAxisDirections; ++d) {
      const double length_m = motions_.length_m({part}, d, present);
      if (best && length_m >= best_m) continue;
      if (motions_.is_free(part, d, present)) best = d, best_m = length_m;
    }
    return best;
  }

  // Prepares the directions of features: what they need is measured by many threads.
  void find_features(const Parts& parts) {
    for_each_part("contacts", parts, [&](std::size_t part) {
      for (std::size_t object = 0; object < shapes_.size(); ++object) {
        if (object != part) shapes_.installed(part, object);
      }
    });
    if (is_over()) return;
    for (const std::size_t part : parts) motions_.add_feature_directions(part);
  }

  std::vector<Step> two_leg_steps(const Parts& present) {
    std::vector<std::optional<Step>> found(shapes_.size());
    for_each_part("two straight legs", movable(present),
                  [&](std::size_t part) { found[part] = two_legs(part, present); });
    std::vector<Step> steps;
    for (auto& step : found) {
      if (step) steps.push_back(std::move(*step));
    }
    return steps;
  }

  // The first leg is so long that the part is then beside an object that blocks the second one.
  std::optional<Step> two_legs(std::size_t part, const Parts& present) {
    const Parts others = without(present, {part});
    for (std::size_t first = 0; first < StraightMotions::kAxisDirections; ++first) {
      const glm::dvec3& along = motions_.direction(first);
      for (std::size_t second = 0; second < StraightMotions::kAxisDirections; ++second) {
        if (std::abs(glm::dot(along, motions_.direction(second))) > 0.5) continue;
        std::set<double> legs_m;
        for (const std::size_t blocker : motions_.seen_blockers(part, second, others)) {
          legs_m.insert(motions_.length_m({part}, first, {blocker}));
        }
        std::size_t tried = 0;
        for (const double leg_m : legs_m) {
          if (leg_m == 0) continue;
          if (++tried > kMaxFirstLegs) break;
          const glm::dvec3 middle_m = leg_m * along;
          const double rest_m = motions_.length_m({part}, second, others);
          const glm::dvec3 shifts_m[] = {middle_m, middle_m + rest_m * motions_.direction(second)};
          auto rows = rows_through(shifts_m);
          if (!passes(part, rows, others)) continue;
          Step step;
          step.parts = {part};
          step.rows = std::move(rows);
          step.settled_by = "meshes, two straight legs";
          return step;
        }
      }
    }
    return std::nullopt;
  }

  // The smallest group that is free along an axis. Where the base is in it, the others are what
  // moves, the other way.
  std::vector<Step> group_steps(const Parts& present) {
    while (!is_over()) {
      for_each_part("groups", present, [&](std::size_t part) {
        for (std::size_t d = 0; d < StraightMotions::kAxisDirections; ++d) {
          motions_.seen_blockers(part, d, present);
        }
      });
      if (is_over()) break;
      const auto group = smallest_group(present);
      if (!group) break;
      // More may be in the way than was seen: where a proof fails, the next group is sought.
      const auto& [parts, direction] = *group;
      if (is_group_free(parts, direction, present)) {
        return {straight_step(parts, direction, present, "meshes, one straight leg")};
      }
    }
    return {};
  }

  std::optional<std::pair<Parts, std::size_t>> smallest_group(const Parts& present) {
    std::optional<std::pair<Parts, std::size_t>> smallest;
    const std::size_t base = base_of(present);
    const auto take = [&](const Parts& group, std::size_t direction) {
      if (group.empty() || contains(group, base)) return;
      if (smallest && group.size() >= smallest->first.size()) return;
      const Parts others = without(present, group);
      const bool is_blocked = std::any_of(group.begin(), group.end(), [&](std::size_t part) {
        return !motions_.seen_blockers(part, direction, others).empty();
      });
      if (!is_blocked) smallest = {group, direction};
    };
    for (std::size_t d = 0; d < StraightMotions::kAxisDirections; ++d) {
      std::vector<Parts> edges;
      for (const std::size_t part : present) {
        Parts& to = edges.emplace_back();
        for (const std::size_t blocker : motions_.seen_blockers(part, d, present)) {
          to.push_back(static_cast<std::size_t>(
              std::lower_bound(present.begin(), present.end(), blocker) - present.begin()));
        }
      }
      for (Parts group : closed_groups(edges)) {
        for (std::size_t& member : group) member = present[member];
        take(group, d);
        take(without(present, group), opposite(d));
      }
    }
    return smallest;
  }

  static std::size_t opposite(std::size_t axis_direction) { return axis_direction ^ 1U; }

  bool is_group_free(const Parts& group, std::size_t direction, const Parts& present) {
    const Parts others = without(present, group);
    const bool is_blocked = std::any_of(group.begin(), group.end(), [&](std::size_t part) {
      return motions_.is_any_seen(part, direction, others);
    });
    if (is_blocked) return false;
    for_each_part("proving", others, [&](std::size_t object) {  // by many threads
      for (const std::size_t part : group) motions_.outcome(part, direction, object);
    });
    return !is_over() && std::all_of(group.begin(), group.end(), [&](std::size_t part) {
      return motions_.is_free(part, direction, others);
    });
  }

  bool passes(std::size_t part, const std::vector<PathRow>& rows, const Parts& others) const {
    const pairs::Shape& shape = shapes_.in_world(part);
    const clearance::CenterPath path(rows, glm::dvec3(0), 0);  // it does not turn
    const bool is_blocked = std::any_of(others.begin(), others.end(), [&](std::size_t object) {
      return is_seen_blocked(path, shape, shapes_.in_world(object), shapes_.installed(part, object),
                             shapes_.rule(part, object));
    });
    return !is_blocked && std::all_of(others.begin(), others.end(), [&](std::size_t object) {
      return check_pair(path, shape, shapes_.in_world(object), shapes_.installed(part, object),
                        shapes_.rule(part, object)) == PairOutcome::kFree;
    });
  }

  // --- what a step is measured by

  void measure(Step& step, const Parts& others) const {
    step.length_m = length_of(step.rows);
    const clearance::CenterPath path(step.rows, glm::dvec3(0), 0);
    std::set<std::size_t> touched, ignored;
    double nearest_m = kEverywhereM;
    struct Gap {
      double gap_m;
      std::size_t part, object;
    };
    std::vector<Gap> gaps;
    for (const std::size_t part : step.parts) {
      for (const std::size_t object : others) {
        const Installed& installed = shapes_.installed(part, object);
        const PairRule rule = shapes_.rule(part, object);
        const double deviations_m = rule.margin_m();
        if (rule.is_ignored) {
          const double gap_m = swept_gap_m(path, shapes_.box_m(part), shapes_.box_m(object));
          if (gap_m <= deviations_m) ignored.insert(object);
          continue;
        }
        if (installed.margin_m > deviations_m) {
          step.hidden_overlap_m = std::max(step.hidden_overlap_m, installed.margin_m);
        }
        if (installed.is_seat && installed.gap_m <= deviations_m) {
          touched.insert(object);
          if (installed.depth_m > installed.margin_m) {
            step.overlaps.push_back({object, installed.depth_m});
          }
        } else {
          gaps.push_back(
              {pairs::distance_of(shapes_.box_m(part), shapes_.box_m(object)), part, object});
        }
      }
    }
    std::stable_sort(gaps.begin(), gaps.end(),
                     [](const Gap& a, const Gap& b) { return a.gap_m < b.gap_m; });
    for (const Gap& gap : gaps) {
      if (touched.contains(gap.object)) continue;
      const auto near =
          nearest_along(path, shapes_.in_world(gap.part), shapes_.in_world(gap.object),
                        shapes_.rule(gap.part, gap.object), nearest_m);
      if (!near) continue;
      nearest_m = near->distance_m;
      step.nearest = gap.object;
      step.distance_m = near->distance_m;
      step.clearance_m = near->proven_m;
    }
    step.touched.assign(touched.begin(), touched.end());
    step.ignored.assign(ignored.begin(), ignored.end());
  }

  // --- parts that are left

  // Beside those that are still there.
  void explain(const Parts& left, const Parts& present) {
    std::vector<Left> reasons(shapes_.size());
    for_each_part("looking for what blocks", left, [&](std::size_t part) {
      Left& own = reasons[part];
      bool is_any = false;
      for (std::size_t d = 0; d < StraightMotions::kAxisDirections; ++d) {
        Parts blockers = motions_.seen_blockers(part, d, present);
        if (is_any && blockers.size() >= own.blocked_by.size()) continue;
        is_any = true;
        own.blocked_by = std::move(blockers);
      }
    });
    for (const std::size_t part : left) {
      Left& own = reasons[part];
      own.part = part;
      own.reason = is_over_ ? "not settled: " + end_text()
                            : "no path was found, straight or with two straight legs, alone or "
                              "in a group";
      if (is_over_) own.blocked_by.clear();
      outcome_.left.push_back(std::move(own));
    }
  }

  // --- a target

  // The fewest removals that are found: by straight motions alone, or else by all that comes out.
  void free_target(const Parts& all) {
    left_count_ = all.size();
    std::vector<Step> steps = observer_.recall(all);
    const bool is_known = !steps.empty();
    const bool is_largest = contains(request_.target, largest_of(all));
    if (!is_known) steps = straight_removals(all, is_largest);
    if (steps.empty() && !is_over()) {
      Parts left = rounds(all, {});
      for (std::size_t n = 0; n < outcome_.steps.size(); ++n) {
        const Parts group = outcome_.steps[n].parts;
        if (!has_target(group) || without(group, request_.target).empty()) continue;
        const Parts together = rounds(group, group);
        // A part that stays in one piece with another one has not come out.
        if (!without(together, request_.target).empty()) {
          left.insert(left.end(), together.begin(), together.end());
        }
      }
      std::sort(left.begin(), left.end());
      steps = needed_steps(std::exchange(outcome_.steps, {}), left, all);
    }
    if (steps.empty()) {
      explain(request_.target, all);
      return;
    }
    if (!is_known) finish(steps, all);
    if (!is_known && is_over()) {  // the steps may lack what they overlap
      explain(request_.target, all);
      return;
    }
    observer_.found(all, steps, is_known);
    outcome_.steps = std::move(steps);
  }

  // Along the axes alone: for all features of all parts that may be of use, the plan would take
  // longer than to take the whole assembly apart. A plan is made from what is quickly seen to be in
  // the way, so it may fail. Then more is known, and another plan is made.
  std::vector<Step> straight_removals(const Parts& all, bool may_move_base) {
    const std::size_t base = base_of(all);
    while (!is_over()) {
      const auto removals =
          fewest_removals(all.size(), request_.target.front(), [&](std::size_t part) {
            if (part == base && !may_move_base) return std::vector<BlockedMotion>();
            return blocked_motions(members(part), all);
          });
      if (!removals || is_over()) break;
      std::vector<Step> steps;
      Parts present = all;
      for (const Removal& removal : *removals) {
        const Parts group = members(removal.part);
        if (!is_group_free(group, removal.direction, present)) break;
        steps.push_back(
            straight_step(group, removal.direction, present, "meshes, one straight leg"));
        present = without(present, group);
      }
      if (steps.size() == removals->size()) return steps;
    }
    return {};
  }

  // The parts of the target are one: the first of them stands for all.
  Parts members(std::size_t part) const {
    return part == request_.target.front() ? request_.target : Parts{part};
  }

  // The first motion that nothing is seen to block, or else all motions.
  std::vector<BlockedMotion> blocked_motions(const Parts& group, const Parts& all) {
    const Parts axes = axes_by_length(group, all), others = without(all, group);
    std::vector<BlockedMotion> found(axes.size());
    for (std::size_t n = 0; n < axes.size(); ++n) found[n].direction = axes[n];
    const auto at = std::find_if(axes.begin(), axes.end(), [&](std::size_t direction) {
      return std::none_of(group.begin(), group.end(), [&](std::size_t member) {
        return !is_over() && motions_.is_any_seen(member, direction, others);
      });
    });
    if (at != axes.end()) {
      return {found[static_cast<std::size_t>(at - axes.begin())]};
    }
    for_each_part("looking for what must leave", others, [&](std::size_t object) {
      for (const std::size_t member : group) {
        for (const std::size_t axis : axes) motions_.seen_blockers(member, axis, {object});
      }
    });
    if (is_over()) return {};
    for (BlockedMotion& motion : found) {
      std::set<std::size_t> blockers;
      for (const std::size_t member : group) {
        for (const std::size_t blocker : motions_.seen_blockers(member, motion.direction, others)) {
          const bool is_of_target = contains(request_.target, blocker);
          blockers.insert(is_of_target ? request_.target.front() : blocker);
        }
      }
      motion.blockers.assign(blockers.begin(), blockers.end());
    }
    return found;
  }

  // Those in which the way out is short come first.
  Parts axes_by_length(const Parts& group, const Parts& all) const {
    Parts axes(StraightMotions::kAxisDirections);
    for (std::size_t d = 0; d < axes.size(); ++d) axes[d] = d;
    std::stable_sort(axes.begin(), axes.end(), [&](std::size_t a, std::size_t b) {
      return motions_.length_m(group, a, all) < motions_.length_m(group, b, all);
    });
    return axes;
  }

  // Those of some steps that the target needs: the others are left out, one after the other, the
  // last first. None where the target did not come out.
  std::vector<Step> needed_steps(std::vector<Step> steps, const Parts& left, const Parts& all) {
    for (const std::size_t part : request_.target) {
      if (contains(left, part)) return {};
    }
    for (std::size_t n = steps.size(); n-- > 0;) {
      if (has_target(steps[n].parts)) continue;
      const Parts& from = steps[n].from;
      Parts rest = from.empty() ? all : from;
      for (std::size_t k = 0; k < n; ++k) {
        if (steps[k].from == from) rest = without(rest, steps[k].parts);
      }
      std::vector<Step> later(steps.begin() + static_cast<std::ptrdiff_t>(n) + 1, steps.end());
      const bool is_passed = std::all_of(later.begin(), later.end(), [&](Step& step) {
        if (step.from != from) return true;  // it is taken apart elsewhere
        rest = without(rest, step.parts);
        lead_past(step, rest);
        return std::all_of(step.parts.begin(), step.parts.end(), [&](std::size_t part) {
          return passes(part, step.rows, steps[n].parts);
        });
      });
      if (!is_passed) continue;
      steps.resize(n);
      steps.insert(steps.end(), later.begin(), later.end());
    }
    return steps;
  }

  // Makes the last leg of a step so long that it ends outside of the box around these parts.
  void lead_past(Step& step, const Parts& others) const {
    const auto shift_at = [&](std::size_t row) {
      const auto& at = step.rows[row].position_m;
      return glm::dvec3(at[0], at[1], at[2]);
    };
    std::vector<glm::dvec3> shifts_m;
    for (std::size_t row = 1; row < step.rows.size(); ++row) shifts_m.push_back(shift_at(row));
    const glm::dvec3 before_m = shift_at(step.rows.size() - 2);
    const glm::dvec3 leg_m = shifts_m.back() - before_m, along = glm::normalize(leg_m);
    const double length_m = motions_.length_m(step.parts, before_m, along, others);
    if (length_m <= glm::length(leg_m)) return;
    shifts_m.back() = before_m + length_m * along;
    step.rows = rows_through(shifts_m);
  }

  bool has_target(const Parts& parts) const {
    return std::any_of(parts.begin(), parts.end(),
                       [&](std::size_t part) { return contains(request_.target, part); });
  }

  const Request& request_;
  const Observer& observer_;
  const double begun_s_ = steady_s();
  std::atomic<bool> is_over_ = false;
  PartShapes shapes_;
  StraightMotions motions_;
  Outcome outcome_;
  std::size_t left_count_ = 0;
};

}  // namespace

std::string end_text() {
  return command::stop_signal() == 0 ? "--time was over" : "the command was stopped";
}

Outcome take_apart(const pairs::AssemblyParts& assembly, const Request& request,
                   const Observer& observer) {
  return Disassembly(assembly, request, observer).run();
}

}  // namespace forcelayer::disassembly
