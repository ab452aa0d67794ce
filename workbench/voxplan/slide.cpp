#include "workbench/voxplan/slide.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <vector>

#include "runtime/coupling/coupling.h"

namespace forcelayer::voxplan {
namespace {

constexpr std::size_t kMaxFloors = 512;
constexpr int kRounds = 40;
constexpr double kStiffness = 1e-3;  // e, the stiffness of free motions; floors give at most 2
// How far a floor may lean along the axis and still count. One value after the other is used.
constexpr std::array<double, 4> kLeans{1, 0.3, 0.1, 0.01};
constexpr double kSoftest = 1e-9;  // stiffness of an axis that nothing resists; floors give 1
constexpr int kAxisRounds = 20;    // of inverse iteration

// A point stays in front of its floor while along . twist >= -left_m.
struct Bound {
  Twist6 along;
  double left_m, squared;
};

std::vector<Bound> bounds(std::span<const clearance::SeatStretch::Floor> floors, double radius_m,
                          double length_m, bool turns) {
  std::vector<Bound> all;
  const std::size_t every = floors.size() / kMaxFloors + 1;
  for (std::size_t i = 0; i < floors.size(); i += every) {
    const glm::dvec3 out(floors[i].direction);
    const glm::dvec3 turn =
        turns ? glm::cross(glm::dvec3(floors[i].arm_m), out) / radius_m : glm::dvec3(0);
    const double left_m = double{floors[i].left_m};
    if (left_m > 2 * length_m || out == glm::dvec3(0)) continue;
    all.push_back({{out.x, out.y, out.z, turn.x, turn.y, turn.z},
                   left_m,
                   glm::dot(out, out) + glm::dot(turn, turn)});
  }
  return all;
}

}  // namespace

double length_of(const Twist6& twist) {
  double squared = 0;
  for (const double part : twist) squared += part * part;
  return std::sqrt(squared);
}

Twist6 of_length(Twist6 twist, double length_m) {
  const double factor = length_m / length_of(twist);
  for (double& part : twist) part *= factor;
  return twist;
}

Twist6 random_twist(double length_m, Random& random) {
  Twist6 twist{};
  const bool turns = random.fraction() < 0.5;
  for (std::size_t i = 0; i < (turns ? 6 : 3); ++i) twist[i] = random.normal();
  return of_length(twist, length_m);
}

// Moves to the nearest allowed motion of one floor after the other (Kaczmarz).
Twist6 allowed_twist(const Twist6& wanted, std::span<const clearance::SeatStretch::Floor> floors,
                     double radius_m) {
  const bool turns = wanted[3] != 0 || wanted[4] != 0 || wanted[5] != 0;
  const auto all = bounds(floors, radius_m, length_of(wanted), turns);
  Twist6 twist = wanted;
  for (int round = 0; round < kRounds; ++round) {
    bool moves = false;
    for (const Bound& bound : all) {
      double along = 0;
      for (std::size_t i = 0; i < 6; ++i) along += bound.along[i] * twist[i];
      if (along >= -bound.left_m) continue;
      moves = true;
      const double push = (-bound.left_m - along) / bound.squared;
      for (std::size_t i = 0; i < 6; ++i) twist[i] += push * bound.along[i];
    }
    if (!moves) break;
  }
  return twist;
}

// Gauss-Jordan elimination without pivoting, because A + e is positive definite.
Twist6 free_twist(const Twist6& wanted, std::span<const clearance::SeatStretch::Floor> floors,
                  double radius_m) {
  std::array<std::array<double, 6>, 6> a{};
  for (std::size_t i = 0; i < 6; ++i) a[i][i] = kStiffness;
  for (const clearance::SeatStretch::Floor& floor : floors) {
    const glm::dvec3 out(floor.direction);
    const glm::dvec3 turn = glm::cross(glm::dvec3(floor.arm_m), out) / radius_m;
    const Twist6 along{out.x, out.y, out.z, turn.x, turn.y, turn.z};
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        a[i][j] += along[i] * along[j] / static_cast<double>(floors.size());
      }
    }
  }
  Twist6 twist = wanted;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t row = 0; row < 6; ++row) {
      if (row == i) continue;
      const double factor = a[row][i] / a[i][i];
      for (std::size_t j = i; j < 6; ++j) a[row][j] -= factor * a[i][j];
      twist[row] -= factor * twist[i];
    }
  }
  for (std::size_t i = 0; i < 6; ++i) twist[i] /= a[i][i];
  return of_length(twist, 1);
}

std::vector<glm::dvec3> free_directions(std::span<const clearance::SeatStretch::Floor> floors) {
  if (floors.empty()) return {};
  std::vector<glm::dvec3> directions;
  glm::dvec3 away(0);
  for (const auto& floor : floors) away += glm::dvec3(floor.direction);
  if (glm::length(away) > 0) directions.push_back(glm::normalize(away));
  glm::dvec3 axis(0);
  for (const double max_lean : kLeans) {
    glm::dmat3 resisted(0);
    std::size_t count = 0;
    for (const auto& floor : floors) {
      const glm::dvec3 out(floor.direction);
      if (std::abs(glm::dot(out, axis)) > max_lean) continue;
      resisted += glm::outerProduct(out, out);
      ++count;
    }
    if (count == 0) return directions;
    const glm::dmat3 softer =
        glm::inverse(resisted / static_cast<double>(count) + kSoftest * glm::dmat3(1));
    if (axis == glm::dvec3(0)) axis = {0.48, 0.64, 0.6};  // parallel to no axis of the world
    for (int n = 0; n < kAxisRounds; ++n) axis = glm::normalize(softer * axis);
  }
  directions.push_back(axis);
  directions.push_back(-axis);
  return directions;
}

Pose moved(const Pose& pose, const Twist6& twist, double radius_m) {
  const glm::dvec3 turn_rad = glm::dvec3(twist[3], twist[4], twist[5]) / radius_m;
  return {pose.position_m + glm::dvec3(twist[0], twist[1], twist[2]),
          glm::normalize(coupling::rotation_by(turn_rad) * pose.orientation)};
}

}  // namespace forcelayer::voxplan
