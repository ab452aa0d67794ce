#include "pointshell/certificate/convex_combination.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace forcelayer::certificate {
namespace {

constexpr std::size_t kMaxSupport = 5;  // four points and the one that enters
constexpr int kMaxSteps = 40;           // of one minimization; fewer than ten are usual
constexpr double kEnough = 1e-9;        // a step that gains less ends it
// Stands in for the inverse of a singular matrix: the solution is then far away in the direction
// along which nothing changes, and the way there ends where a weight becomes zero.
constexpr double kRidge = 1e-10;
// In radii. The gap is minimized as a square, whose weight follows the gap last found.
constexpr double kFirstGap = 0.2, kSmallGap = 0.01, kMinGap = 0.001;
constexpr int kAdaptiveRounds = 2;

using Square = std::array<std::array<double, kMaxSupport - 1>, kMaxSupport - 1>;
using Row = std::array<double, kMaxSupport - 1>;

// Solves the first `count` equations of a positive definite system; `right` becomes the solution.
void solve(Square& a, Row& right, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = i + 1; k < count; ++k) {
      const double fraction = a[k][i] / a[i][i];
      for (std::size_t j = i; j < count; ++j) a[k][j] -= fraction * a[i][j];
      right[k] -= fraction * right[i];
    }
  }
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t j = i + 1; j < count; ++j) right[i] -= a[i][j] * right[j];
    right[i] /= a[i][i];
  }
}

}  // namespace

part::Vec3 CombinationFinder::offset_of_combination() const {
  part::Vec3 sum;
  for (const std::size_t n : support_) sum += candidates_[n].weight * candidates_[n].offset;
  return sum;
}

void CombinationFinder::keep_if_better() {
  const part::Vec3 offset = offset_of_combination();
  double moment = 0;
  for (const std::size_t n : support_) {
    moment += candidates_[n].weight * part::length_squared(candidates_[n].offset - offset);
  }
  const double gap = part::length(offset);
  const double loss = distance_loss(aim_, moment, gap);
  if (!(loss < best_loss_)) return;
  best_loss_ = loss;
  best_ = {offset, moment, gap};
}

// The candidate whose weight is worth raising most, or the number of candidates.
std::size_t CombinationFinder::steepest(double stiffness) const {
  const part::Vec3 pull = 2 * stiffness * offset_of_combination();
  const auto slope = [&](const Candidate& c) { return c.cost + part::dot(pull, c.offset); };
  double level = 0;
  for (const std::size_t n : support_) level += candidates_[n].weight * slope(candidates_[n]);
  std::size_t best = candidates_.size();
  double smallest = level - kEnough;
  for (std::size_t n = 0; n < candidates_.size(); ++n) {
    const double own = slope(candidates_[n]);
    if (own < smallest) best = n, smallest = own;
  }
  return best;
}

// Moves the weights of the support to the minimum over it, and drops candidates that would become
// negative on the way (as Wolfe's method for the nearest point of a polytope, 1976).
void CombinationFinder::settle(double stiffness) {
  while (support_.size() > 1) {
    const Candidate& first = candidates_[support_[0]];
    const std::size_t count = support_.size() - 1;
    Square a;
    Row wanted;
    for (std::size_t i = 0; i < count; ++i) {
      const Candidate& own = candidates_[support_[i + 1]];
      const part::Vec3 along = own.offset - first.offset;
      for (std::size_t j = 0; j < count; ++j) {
        a[i][j] =
            2 * stiffness * part::dot(along, candidates_[support_[j + 1]].offset - first.offset);
      }
      a[i][i] += kRidge * (a[i][i] + stiffness);
      wanted[i] = first.cost - own.cost - 2 * stiffness * part::dot(along, first.offset);
    }
    solve(a, wanted, count);
    double first_wanted = 1;
    for (std::size_t i = 0; i < count; ++i) first_wanted -= wanted[i];
    const auto wanted_of = [&](std::size_t i) { return i == 0 ? first_wanted : wanted[i - 1]; };
    double step = 1;
    std::size_t leaves = support_.size();
    for (std::size_t i = 0; i < support_.size(); ++i) {
      const double weight = candidates_[support_[i]].weight;
      if (wanted_of(i) > 0) continue;
      const double until = weight / std::max(weight - wanted_of(i), 1e-300);
      if (leaves == support_.size() || until < step) step = until, leaves = i;
    }
    for (std::size_t i = 0; i < support_.size(); ++i) {
      double& weight = candidates_[support_[i]].weight;
      weight = std::max(0.0, weight + step * (wanted_of(i) - weight));
    }
    if (leaves == support_.size()) return;
    candidates_[support_[leaves]].weight = 0;
    support_.erase(support_.begin() + static_cast<std::ptrdiff_t>(leaves));
    double sum = 0;
    for (const std::size_t n : support_) sum += candidates_[n].weight;
    if (!(sum > 0)) {  // all of the weight was on the one that left
      candidates_[support_[0]].weight = sum = 1;
    }
    for (const std::size_t n : support_) candidates_[n].weight /= sum;
  }
  candidates_[support_[0]].weight = 1;
}

// Minimizes the sum of weight times cost, plus stiffness times the squared gap.
void CombinationFinder::minimize(double stiffness) {
  for (int step = 0; step < kMaxSteps; ++step) {
    const std::size_t enters = steepest(stiffness);
    if (enters == candidates_.size() || support_.size() == kMaxSupport ||
        std::find(support_.begin(), support_.end(), enters) != support_.end()) {
      return;
    }
    support_.push_back(enters);
    settle(stiffness);
  }
}

Combination CombinationFinder::at(const part::Vec3& place) {
  candidates_.clear();
  support_.clear();
  const double inverse = 1 / radius_;
  std::size_t nearest = 0;
  grid_.visit_near(place, kReach * radius_, [&](std::uint32_t, const part::Vec3& point) {
    const part::Vec3 offset = inverse * (point - place);
    const double squared = part::length_squared(offset);
    if (squared > kReach * kReach) return;
    // A second moment costs about this loss; the gap's fraction of `squared` is small.
    candidates_.push_back({offset, squared, squared / (2 * aim_), 0});
    if (squared < candidates_[nearest].squared) nearest = candidates_.size() - 1;
  });
  best_loss_ = std::numeric_limits<double>::infinity();
  if (candidates_.empty()) return {place, 0, best_loss_};
  support_.push_back(nearest);
  candidates_[nearest].weight = 1;
  best_ = {candidates_[nearest].offset, 0, std::sqrt(candidates_[nearest].squared)};
  best_loss_ = best_.gap;
  double assumed_gap = kFirstGap;
  for (int round = 0; round <= kAdaptiveRounds; ++round) {
    minimize(1 / (2 * assumed_gap));
    keep_if_better();
    assumed_gap = std::max(part::length(offset_of_combination()), kSmallGap);
  }
  if (assumed_gap <= 2 * kSmallGap) {
    minimize(1 / (2 * kMinGap));
    keep_if_better();
  }
  return {place + radius_ * best_.place, best_.second_moment * radius_ * radius_,
          best_.gap * radius_};
}

}  // namespace forcelayer::certificate
