#include "runtime/coupling/virtual_coupling.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace forcelayer::coupling {
namespace {

// Impulse of one half at the end of the step, the target being where it is: offset - slope v, with
// the secant of the clamp at the velocity that is expected.
struct LinearForce {
  glm::dmat3 slope;
  glm::dvec3 offset;

  LinearForce(const CouplingHalf& half, const HalfStretch& stretch, const glm::dvec3& expected,
              double dt_s)
      : slope(half.damping + glm::dmat3(dt_s * half.stiffness)),
        offset(half.stiffness * stretch.displacement + half.damping * stretch.target_velocity) {
    const double force = glm::length(offset - slope * expected);
    const double secant = force > half.limit ? half.limit / force : 1;
    slope *= dt_s * secant;
    offset *= dt_s * secant;
  }
};

void add_block(const glm::dmat3& block, int first, Symmetric6& matrix) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column <= row; ++column) {
      matrix.lower[Symmetric6::at(first + row, first + column)] += block[column][row];
    }
  }
}

}  // namespace

glm::dvec3 effective_stretch(const CouplingHalf& half, const HalfStretch& stretch,
                             const glm::dvec3& velocity) noexcept {
  return stretch.displacement -
         half.damping * (velocity - stretch.target_velocity) / half.stiffness;
}

double spring_energy_j(const CouplingHalf& half, const glm::dvec3& displacement) noexcept {
  const double length = glm::length(displacement);
  const double force = half.stiffness * length;
  if (force <= half.limit) return 0.5 * force * length;
  return half.limit * (length - 0.5 * half.limit / half.stiffness);
}

glm::dvec3 spring_force(const CouplingHalf& half, const glm::dvec3& displacement) noexcept {
  const glm::dvec3 force = half.stiffness * displacement;
  const double length = glm::length(force);
  return length > half.limit ? force * (half.limit / length) : force;
}

void add_force(const CouplingHalf& half, const HalfStretch& stretch, const glm::dvec3& arm_m,
               const Vector6& guess, double dt_s, Symmetric6& matrix, Vector6& impulse) noexcept {
  const LinearForce force(half, stretch,
                          linear_part(guess) + glm::cross(angular_part(guess), arm_m), dt_s);
  // The point's velocity is v + w x r: its rows of the system are those of the centroid, and their
  // moments about it.
  const glm::dmat3& slope = force.slope;
  const glm::dmat3 moment(glm::cross(arm_m, slope[0]), glm::cross(arm_m, slope[1]),
                          glm::cross(arm_m, slope[2]));
  const glm::dmat3 turned_back = glm::transpose(moment);
  const glm::dmat3 about(glm::cross(arm_m, turned_back[0]), glm::cross(arm_m, turned_back[1]),
                         glm::cross(arm_m, turned_back[2]));
  add_block(slope, 0, matrix);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      matrix.lower[Symmetric6::at(3 + row, column)] += moment[column][row];
    }
  }
  add_block(about, 3, matrix);
  const glm::dvec3 angular = glm::cross(arm_m, force.offset);
  for (int axis = 0; axis < 3; ++axis) {
    impulse[axis] += force.offset[axis];
    impulse[3 + axis] += angular[axis];
  }
}

void add_torque(const CouplingHalf& half, const HalfStretch& stretch, const Vector6& guess,
                double dt_s, Symmetric6& matrix, Vector6& impulse) noexcept {
  const LinearForce torque(half, stretch, angular_part(guess), dt_s);
  add_block(torque.slope, 3, matrix);
  for (int axis = 0; axis < 3; ++axis) impulse[3 + axis] += torque.offset[axis];
}

// In the plane of r and F its eigenvectors halve the angle between them and are at right angles to
// that: r F (cos - 1) / 2 <= 0 along the bisector w, r F (cos + 1) / 2 >= 0 across it. At right
// angles to the plane it is r F cos.
glm::dmat3 lever_stiffness(const glm::dvec3& arm_m, const glm::dvec3& force_n) noexcept {
  const double size = glm::length(arm_m) * glm::length(force_n);
  if (!(size > 0)) return glm::dmat3(0);
  const glm::dvec3 r = glm::normalize(arm_m), f = glm::normalize(force_n);
  const double cosine = std::clamp(glm::dot(r, f), -1.0, 1.0);
  const glm::dvec3 sum = r + f, normal = glm::cross(r, f);
  const double across = 0.5 * size * (1 + cosine);
  // Opposite directions leave nothing that is positive; equal ones, no plane, and none is needed:
  // its two positive directions are then alike.
  if (!(glm::dot(sum, sum) > 0)) return glm::dmat3(0);
  const glm::dvec3 w = glm::normalize(sum);
  glm::dmat3 positive = across * (glm::dmat3(1) - glm::outerProduct(w, w));
  if (const double length2 = glm::dot(normal, normal); length2 > 0) {
    const double more = size * std::max(0.0, cosine) - across;
    positive += (more / length2) * glm::outerProduct(normal, normal);
  }
  return positive;
}

}  // namespace forcelayer::coupling
