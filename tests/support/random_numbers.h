// Seeded random numbers, directions and orientations.
#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

namespace forcelayer::test {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline std::int64_t integer(Random& random, std::int64_t low, std::int64_t high) {
  return std::uniform_int_distribution<std::int64_t>(low, high)(random);
}

inline glm::dvec3 random_direction(Random& random) {
  std::normal_distribution<double> normal;
  glm::dvec3 v(0);
  while (glm::length(v) < 1e-3) v = {normal(random), normal(random), normal(random)};
  return glm::normalize(v);
}

inline glm::dquat random_orientation(Random& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
}

}  // namespace forcelayer::test
