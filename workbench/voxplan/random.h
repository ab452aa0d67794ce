// Random numbers that are the same on every machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <random>

namespace forcelayer::voxplan {

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}

  double fraction() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }  // in [0, 1)
  double between(double low, double high) { return low + (high - low) * fraction(); }
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(fraction() * static_cast<double>(count));
  }
  double normal() {  // each number drawn in a statement of its own: operands have no order
    const double length = std::sqrt(-2 * std::log(1 - fraction()));
    return length * std::cos(2 * M_PI * fraction());
  }

  glm::dvec3 direction() {
    const double z = between(-1, 1), angle = between(0, 2 * M_PI), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

  // Every orientation is as likely as any other (Shoemake 1992).
  glm::dquat orientation() {
    const double u = fraction(), a = between(0, 2 * M_PI), b = between(0, 2 * M_PI);
    return {std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a),
            std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b)};
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace forcelayer::voxplan
