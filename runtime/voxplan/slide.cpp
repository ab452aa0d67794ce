#include "runtime/voxplan/slide.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <vector>

#include "runtime/coupling/coupling.h"

namespace forcelayer::voxplan {
namespace {

constexpr std::size_t kMostFloors = 512;
constexpr int kRounds = 40;

// A point keeps before its floor while along . twist >= -left_m.
struct Bound {
  Twist6 along;
  double left_m, squared;
};

std::vector<Bound> bounds(std::span<const clearance::SeatStretch::Floor> floors, double radius_m,
                          double length_m, bool turns) {
  std::vector<Bound> all;
  const std::size_t every = floors.size() / kMostFloors + 1;
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
  const bool turns = random.share() < 0.5;
  for (std::size_t i = 0; i < (turns ? 6 : 3); ++i) twist[i] = random.normal();
  return of_length(twist, length_m);
}

// By going to the nearest place before one floor after the other (Kaczmarz).
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

Pose moved(const Pose& pose, const Twist6& twist, double radius_m) {
  const glm::dvec3 turn_rad = glm::dvec3(twist[3], twist[4], twist[5]) / radius_m;
  return {pose.position_m + glm::dvec3(twist[0], twist[1], twist[2]),
          glm::normalize(coupling::rotation_by(turn_rad) * pose.orientation)};
}

}  // namespace forcelayer::voxplan
