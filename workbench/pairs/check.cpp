#include "workbench/pairs/check.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "workbench/pairs/near_boxes.h"
#include "workbench/pairs/threads.h"

namespace forcelayer::pairs {
namespace {

using command::VerdictKind;

double required_m(const Requirement& requirement) { return requirement.clearance_m; }

// The shapes of parts, each from its first pair to its last.
class Shapes {
 public:
  Shapes(const AssemblyParts& assembly, std::span<const Pair> pairs)
      : assembly_(assembly), shapes_(assembly.parts.size()), locks_(assembly.parts.size()) {
    uses_.resize(assembly.parts.size());
    for (const auto& [a, b] : pairs) ++uses_[a], ++uses_[b];
  }

  std::shared_ptr<const Shape> of(std::uint32_t part) {
    const std::lock_guard lock(locks_[part]);
    if (!shapes_[part]) {
      const AssemblyPart& own = assembly_.parts[part];
      shapes_[part] = std::make_shared<const Shape>(surface_of(assembly_.scene, own), own.box_m);
    }
    return shapes_[part];
  }

  void release(std::uint32_t part) {
    const std::lock_guard lock(locks_[part]);
    if (--uses_[part] == 0) shapes_[part] = nullptr;
  }

 private:
  const AssemblyParts& assembly_;
  std::vector<std::shared_ptr<const Shape>> shapes_;  // [parts]
  std::vector<std::mutex> locks_;                     // [parts]
  std::vector<std::uint32_t> uses_;                   // [parts] pairs to come
};

// How bad a finding is: overlaps first, then pairs that are not decided, then those too near.
int rank_of(const PairFinding& finding) {
  switch (finding.kind) {
    case VerdictKind::kCollides:
      return 0;
    case VerdictKind::kUndecided:
      return 1;
    case VerdictKind::kTooNear:
      return 2;
    case VerdictKind::kTooCloseToCall:
      return 3;
    default:
      return 4;
  }
}

double badness_m(const PairFinding& finding) {
  return finding.measure.depth_m + finding.requirement.clearance_m - finding.measure.distance_m;
}

class Check {
 public:
  Check(const AssemblyParts& assembly, std::span<const Rule> rules, const RuleTable& table,
        const Requirement& otherwise)
      : assembly_(assembly), rules_(rules), table_(table), otherwise_(otherwise) {}

  Findings run(const std::function<void(double)>& progress) {
    Findings findings;
    const std::uint64_t count = assembly_.parts.size();
    findings.pairs = count * (count - 1) / 2;
    findings.ignored = count_ignored();
    const std::vector<Pair> pairs = near_pairs();
    findings.measured = pairs.size();
    std::vector<std::optional<PairFinding>> found(pairs.size());
    measure_all(pairs, found, progress);
    for (auto& finding : found) {
      if (finding) findings.by_rank.push_back(std::move(*finding));
    }
    std::stable_sort(findings.by_rank.begin(), findings.by_rank.end(),
                     [](const PairFinding& a, const PairFinding& b) {
                       const int rank_a = rank_of(a), rank_b = rank_of(b);
                       if (rank_a != rank_b) return rank_a < rank_b;
                       const double bad_a = badness_m(a), bad_b = badness_m(b);
                       if (bad_a != bad_b) return bad_a > bad_b;
                       return std::pair(a.part, a.object) < std::pair(b.part, b.object);
                     });
    return findings;
  }

 private:
  const Requirement& requirement_of(const Pair& pair) const {
    const std::size_t rule = table_.first_rule(pair.first, pair.second);
    return rule < rules_.size() ? rules_[rule].requirement : otherwise_;
  }

  double margin_m(const Pair& pair) const {
    const AssemblyPart &a = assembly_.parts[pair.first], &b = assembly_.parts[pair.second];
    return a.deviation_m + b.deviation_m + rounding_m(pair);
  }
  double rounding_m(const Pair& pair) const {
    return assembly_.parts[pair.first].rounding_m + assembly_.parts[pair.second].rounding_m;
  }

  std::uint64_t count_ignored() const {
    const bool any = std::any_of(rules_.begin(), rules_.end(), [](const Rule& rule) {
      return rule.requirement.kind == Requirement::Kind::kIgnore;
    });
    std::uint64_t ignored = 0;
    if (!any) return ignored;
    const auto count = static_cast<std::uint32_t>(assembly_.parts.size());
    for (std::uint32_t a = 0; a < count; ++a) {
      for (std::uint32_t b = a + 1; b < count; ++b) {
        ignored += requirement_of({a, b}).kind == Requirement::Kind::kIgnore;
      }
    }
    return ignored;
  }

  // Those whose boxes are near enough for their rule.
  std::vector<Pair> near_pairs() const {
    std::vector<mesh::Box> boxes_m;
    double reach_m = required_m(otherwise_), deviation_m = 0;
    for (const AssemblyPart& part : assembly_.parts) {
      boxes_m.push_back(part.box_m);
      deviation_m = std::max(deviation_m, part.deviation_m + part.rounding_m);
    }
    for (const Rule& rule : rules_) reach_m = std::max(reach_m, required_m(rule.requirement));
    return near_boxes(boxes_m, reach_m + 2 * deviation_m, [&](const Pair& pair) {
      const Requirement& requirement = requirement_of(pair);
      return requirement.kind != Requirement::Kind::kIgnore &&
             distance_of(boxes_m[pair.first], boxes_m[pair.second]) <=
                 required_m(requirement) + margin_m(pair);
    });
  }

  void measure_all(std::span<const Pair> pairs, std::span<std::optional<PairFinding>> found,
                   const std::function<void(double)>& progress) const {
    Shapes shapes(assembly_, pairs);
    for_each_number(
        pairs.size(),
        [&](std::size_t n) {
          found[n] = measure(pairs[n], shapes);
          shapes.release(pairs[n].first);
          shapes.release(pairs[n].second);
        },
        [&](std::size_t done) {
          progress(static_cast<double>(done) / static_cast<double>(pairs.size()));
        });
  }

  std::optional<PairFinding> measure(const Pair& pair, Shapes& shapes) const {
    const auto first = shapes.of(pair.first), second = shapes.of(pair.second);
    PairFinding finding;
    finding.part = pair.first, finding.object = pair.second;
    finding.rule = table_.first_rule(pair.first, pair.second);
    finding.requirement = requirement_of(pair);
    finding.margin_m = margin_m(pair);
    const auto name_of = [&](std::uint32_t part) {
      return [this, part] { return assembly_.shown_name(part); };
    };
    const auto measure =
        measure_pair({*first, name_of(pair.first)}, {*second, name_of(pair.second)},
                     required_m(finding.requirement) + finding.margin_m, finding.margin_m);
    if (!measure) return std::nullopt;
    finding.measure = *measure;
    finding.kind = kind_of(*measure, finding.requirement, finding.margin_m, rounding_m(pair));
    if (!finding.measure.is_first_deep) std::swap(finding.part, finding.object);
    return finding;
  }

  const AssemblyParts& assembly_;
  std::span<const Rule> rules_;
  const RuleTable& table_;
  const Requirement& otherwise_;
};

}  // namespace

command::VerdictKind kind_of(const PairMeasure& measure, const Requirement& requirement,
                             double margin_m, double rounding_m) {
  if (measure.contact == Contact::kOverlap) return VerdictKind::kCollides;
  const double required = required_m(requirement);
  if (measure.distance_m < required - rounding_m) return VerdictKind::kTooNear;
  if (measure.contact == Contact::kUndecided) return VerdictKind::kUndecided;
  if (measure.contact == Contact::kClose) return VerdictKind::kTooCloseToCall;
  if (required == 0) return VerdictKind::kStaysInstalled;
  return measure.distance_m >= required + margin_m ? VerdictKind::kKeepsClearance
                                                   : VerdictKind::kTooCloseToCall;
}

Findings check_pairs(const AssemblyParts& assembly, std::span<const Rule> rules,
                     const RuleTable& table, const Requirement& otherwise,
                     const std::function<void(double)>& progress) {
  return Check(assembly, rules, table, otherwise).run(progress);
}

}  // namespace forcelayer::pairs
