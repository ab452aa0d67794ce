#include "pointshell/sample/smallest_ball.h"

#include <array>
#include <optional>

namespace forcelayer::sample {
namespace {

constexpr int kMaxPivots = 100;
constexpr double kRelativeSlack = 1e-12;

// Up to four points on the ball, and the one to be added.
struct Support {
  std::array<part::Vec3, 5> points;
  int count = 0;
};

double squared_distance(const Ball& ball, const part::Vec3& p) {
  return part::length_squared(p - ball.center);
}

Ball through(const part::Vec3& a, const part::Vec3& b) {
  const part::Vec3 center = 0.5 * (a + b);
  return {center, part::length(a - center)};
}

// Center in the plane of the three; none when they lie on a line.
std::optional<Ball> through(const part::Vec3& a, const part::Vec3& b, const part::Vec3& c) {
  const part::Vec3 u = b - a, v = c - a, normal = part::cross(u, v);
  const double squared = part::length_squared(normal);
  if (squared <= 1e-24 * part::length_squared(u) * part::length_squared(v)) return std::nullopt;
  const part::Vec3 to_center = (0.5 / squared) * (part::length_squared(u) * part::cross(v, normal) +
                                                  part::length_squared(v) * part::cross(normal, u));
  return Ball{a + to_center, part::length(to_center)};
}

std::optional<Ball> through(const part::Vec3& a, const part::Vec3& b, const part::Vec3& c,
                            const part::Vec3& d) {
  const part::Vec3 u = b - a, v = c - a, w = d - a;
  const double volume = part::dot(u, part::cross(v, w));
  if (volume * volume <=
      1e-24 * part::length_squared(u) * part::length_squared(v) * part::length_squared(w)) {
    return std::nullopt;
  }
  const part::Vec3 to_center = (0.5 / volume) * (part::length_squared(u) * part::cross(v, w) +
                                                 part::length_squared(v) * part::cross(w, u) +
                                                 part::length_squared(w) * part::cross(u, v));
  return Ball{a + to_center, part::length(to_center)};
}

bool holds(const Ball& ball, const Support& support) {
  const double reach = ball.radius * ball.radius * (1 + kRelativeSlack);
  for (int n = 0; n < support.count; ++n) {
    if (squared_distance(ball, support.points[n]) > reach) return false;
  }
  return true;
}

// The ball through the chosen ones of the support's points.
std::optional<Ball> through_chosen(const Support& support, unsigned chosen) {
  std::array<part::Vec3, 4> p;
  int count = 0;
  for (int n = 0; n < support.count; ++n) {
    if (chosen >> n & 1u) p[count++] = support.points[n];
  }
  if (count == 2) return through(p[0], p[1]);
  if (count == 3) return through(p[0], p[1], p[2]);
  return through(p[0], p[1], p[2], p[3]);
}

// The smallest ball of at most five points, the last of which lies on it, by trying every choice of
// one to three others; the support becomes that choice.
std::optional<Ball> smallest_of_few(Support& support) {
  std::optional<Ball> best;
  unsigned best_chosen = 0;
  const unsigned last = 1u << (support.count - 1);
  for (unsigned others = 1; others < last; ++others) {
    const unsigned chosen = others | last;
    if (chosen == 0b11111u) continue;
    const auto ball = through_chosen(support, chosen);
    if (!ball || !holds(*ball, support) || (best && ball->radius >= best->radius)) continue;
    best = ball;
    best_chosen = chosen;
  }
  if (!best) return best;
  Support kept;
  for (int n = 0; n < support.count; ++n) {
    if (best_chosen >> n & 1u) kept.points[kept.count++] = support.points[n];
  }
  support = kept;
  return best;
}

}  // namespace

Ball smallest_ball(std::span<const part::Vec3> points) {
  Ball ball{points.front(), 0};
  Support support;
  support.points[support.count++] = points.front();
  for (int pivot = 0; pivot < kMaxPivots; ++pivot) {
    part::Vec3 farthest = points.front();
    double squared = 0;
    for (const part::Vec3& p : points) {
      if (const double s = squared_distance(ball, p); s > squared) squared = s, farthest = p;
    }
    if (squared <= ball.radius * ball.radius * (1 + kRelativeSlack)) return ball;
    support.points[support.count++] = farthest;
    const auto grown = smallest_of_few(support);
    // Rounding allows no further progress: grow the ball to hold the farthest point.
    if (!grown || grown->radius <= ball.radius) return {ball.center, std::sqrt(squared)};
    ball = *grown;
  }
  double squared = 0;
  for (const part::Vec3& p : points) squared = std::max(squared, squared_distance(ball, p));
  return {ball.center, std::sqrt(squared)};
}

}  // namespace forcelayer::sample
