// The distance of two triangles against a twin in exact rational arithmetic, from a micrometer to a
// kilometer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <random>

#include "workbench/exact/triangle_distance.h"

namespace forcelayer::exact {
namespace {

using Exact = boost::multiprecision::cpp_rational;

struct Place {
  Exact x, y, z;
};
using ExactCorners = std::array<Place, 3>;

Place operator+(const Place& a, const Place& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Place operator-(const Place& a, const Place& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Place operator*(const Exact& s, const Place& a) { return {s * a.x, s * a.y, s * a.z}; }
Exact dot(const Place& a, const Place& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Place cross(const Place& a, const Place& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Place exact_of(const glm::dvec3& p) { return {Exact(p.x), Exact(p.y), Exact(p.z)}; }
ExactCorners exact_of(const Corners& t) { return {exact_of(t[0]), exact_of(t[1]), exact_of(t[2])}; }

Exact square_to_segment(const Place& p, const Place& a, const Place& b) {
  const Place way = b - a;
  const Exact square = dot(way, way);
  Exact fraction = 0;
  if (square > 0) fraction = std::clamp<Exact>(dot(p - a, way) / square, 0, 1);
  const Place off = p - (a + fraction * way);
  return dot(off, off);
}

// Whether the foot of a place on the plane of a triangle with an area lies in it.
bool is_above(const Place& p, const ExactCorners& t, const Place& normal) {
  for (std::size_t n = 0; n < 3; ++n) {
    if (dot(cross(normal, t[(n + 1) % 3] - t[n]), p - t[n]) < 0) return false;
  }
  return true;
}

Exact square_between_segments(const Place& a, const Place& b, const Place& c, const Place& d) {
  const Place u = b - a, v = d - c, normal = cross(u, v);
  const Exact square = dot(normal, normal);
  if (square > 0) {
    const Exact s = dot(cross(c - a, v), normal) / square,
                t = dot(cross(c - a, u), normal) / square;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) {
      const Exact along = dot(c - a, normal);
      return along * along / square;
    }
  }
  return std::min({square_to_segment(a, c, d), square_to_segment(b, c, d),
                   square_to_segment(c, a, b), square_to_segment(d, a, b)});
}

Exact square_between(const ExactCorners& s, const ExactCorners& t) {
  std::optional<Exact> smallest;
  const auto take = [&](const Exact& square) {
    if (!smallest || square < *smallest) smallest = square;
  };
  for (const auto& [from, into] : {std::pair(&s, &t), std::pair(&t, &s)}) {
    const Place normal = cross((*into)[1] - (*into)[0], (*into)[2] - (*into)[0]);
    const Exact square = dot(normal, normal);
    if (square == 0) continue;
    for (std::size_t n = 0; n < 3; ++n) {
      const Place &a = (*from)[n], &b = (*from)[(n + 1) % 3];
      const Exact at_a = dot(normal, a - (*into)[0]), at_b = dot(normal, b - (*into)[0]);
      if (is_above(a, *into, normal)) take(at_a * at_a / square);
      if (at_a * at_b < 0 && is_above(a + (at_a / (at_a - at_b)) * (b - a), *into, normal)) take(0);
    }
  }
  for (std::size_t n = 0; n < 3; ++n) {
    for (std::size_t m = 0; m < 3; ++m) {
      take(square_between_segments(s[n], s[(n + 1) % 3], t[m], t[(m + 1) % 3]));
    }
  }
  return *smallest;
}

double root(const Exact& square) {
  return static_cast<double>(std::sqrt(square.convert_to<long double>()));
}

enum class Shape { kFat, kSliver, kNeedle, kLine, kPoint, kLattice, kCount };

// A triangle about 1 across.
Corners triangle(std::mt19937& random, Shape shape) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::uniform_int_distribution<int> lattice(-2, 2), digits(1, 15);
  const auto any = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  const double little = std::pow(10.0, -digits(random));
  Corners t{any(), any(), any()};
  if (shape == Shape::kSliver) t[2] = glm::mix(t[0], t[1], unit(random)) + little * any();
  if (shape == Shape::kNeedle) t[2] = t[1] + little * any();
  if (shape == Shape::kLine) t[2] = t[1];
  if (shape == Shape::kPoint) t[1] = t[2] = t[0];
  if (shape == Shape::kLattice) {
    for (glm::dvec3& v : t) v = glm::dvec3(lattice(random), lattice(random), lattice(random)) / 2.0;
  }
  return t;
}

Corners placed(Corners t, double scale_m, const glm::dvec3& offset_m) {
  for (glm::dvec3& v : t) v = scale_m * v + offset_m;
  return t;
}

// How far a distance may be off, as a fraction of the largest coordinate. In 6,000 trials the
// largest error was a seventh of it.
constexpr double kOff = 0x1p-48;

TEST(TriangleDistance, IsThatOfRationalArithmeticAtAnyScaleAndShape) {
  std::mt19937 random(41);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::uniform_int_distribution<int> any_shape(0, static_cast<int>(Shape::kCount) - 1), away(0, 12);
  int meeting = 0, near = 0;
  for (int trial = 0; trial < 600; ++trial) {
    SCOPED_TRACE(trial);
    const double scale_m = std::pow(10.0, -6 + trial % 10);
    Corners s = triangle(random, static_cast<Shape>(any_shape(random)));
    Corners t = triangle(random, static_cast<Shape>(any_shape(random)));
    if (trial % 4 == 0) {  // beside each other: a copy that is turned a little, and moved
      const double little = std::pow(10.0, -away(random));
      for (std::size_t n = 0; n < 3; ++n) {
        t[n] = s[(n + 1) % 3] + little * glm::dvec3(unit(random), unit(random), unit(random));
      }
    }
    if (trial % 4 == 1) {  // a corner before the face
      const double little = std::pow(10.0, -away(random));
      const glm::dvec3 way = glm::cross(s[1] - s[0], s[2] - s[0]);
      const glm::dvec3 from = t[0];
      for (glm::dvec3& v : t) v += (s[0] + s[1] + s[2]) / 3.0 + little * way - from;
    }
    const glm::dvec3 offset_m =
        trial % 3 == 0 ? 100 * scale_m * glm::dvec3(unit(random), unit(random), 0) : glm::dvec3(0);
    s = placed(s, scale_m, offset_m), t = placed(t, scale_m, offset_m);
    double largest_m = 0;
    for (const Corners& corners : {s, t}) {
      for (const glm::dvec3& v : corners) {
        largest_m = std::max({largest_m, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
      }
    }
    const double truth_m = root(square_between(exact_of(s), exact_of(t)));
    const TriangleDistance found = triangle_distance(s, t);
    const double off_m = kOff * largest_m;
    EXPECT_NEAR(found.distance_m, truth_m, off_m);
    EXPECT_NEAR(triangle_distance(t, s).distance_m, truth_m, off_m);
    EXPECT_NEAR(glm::length(found.first_m - found.second_m), found.distance_m, off_m);
    // Both places lie in their triangles.
    const auto off = [&](const glm::dvec3& p, const Corners& corners) {
      return root(square_between(exact_of(Corners{p, p, p}), exact_of(corners)));
    };
    EXPECT_LE(off(found.first_m, s), off_m);
    EXPECT_LE(off(found.second_m, t), off_m);
    meeting += truth_m == 0;
    near += truth_m > 0 && truth_m < 1e-3 * scale_m;
  }
  EXPECT_GT(meeting, 30);
  EXPECT_GT(near, 60);
}

// The square of twice the area is 1e-16 m^4 and 5e-16 m^4: FCL's own distance leaves out such
// faces.
TEST(TriangleDistance, OfACornerBeforeASmallFaceIsItsHeight) {
  for (const double side_m : {1.5e-4, 1e-6}) {
    const double up_m = 0.2 * side_m;
    const Corners face{{{0, 0, 0}, {side_m, 0, 0}, {side_m, side_m, 0}}};
    const glm::dvec3 tip(0.7 * side_m, 0.3 * side_m, up_m);
    const Corners above{
        {tip, tip + side_m * glm::dvec3(1, 0, 3), tip + side_m * glm::dvec3(0, 1, 3)}};
    EXPECT_DOUBLE_EQ(triangle_distance(face, above).distance_m, up_m);
    EXPECT_DOUBLE_EQ(triangle_distance(above, face).distance_m, up_m);
  }
}

}  // namespace
}  // namespace forcelayer::exact
