// Vectors and symmetric matrices over the six velocities of a rigid body, linear part first.
#pragma once

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

namespace forcelayer::coupling {

// [linear x y z, angular x y z]: a velocity (m/s, rad/s), or an impulse (N s, N m s).
using Vector6 = std::array<double, 6>;

inline Vector6 vector6(const glm::dvec3& linear, const glm::dvec3& angular) {
  return {linear.x, linear.y, linear.z, angular.x, angular.y, angular.z};
}
inline glm::dvec3 linear_part(const Vector6& v) { return {v[0], v[1], v[2]}; }
inline glm::dvec3 angular_part(const Vector6& v) { return {v[3], v[4], v[5]}; }

inline double dot(const Vector6& a, const Vector6& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

// Symmetric 6x6 matrix, its lower triangle by rows.
struct Symmetric6 {
  std::array<double, 21> lower{};

  static constexpr int at(int row, int column) { return row * (row + 1) / 2 + column; }

  bool operator==(const Symmetric6&) const = default;

  // += weight * j j^T
  void add_outer(const Vector6& j, double weight) {
    for (int row = 0, n = 0; row < 6; ++row) {
      const double scaled = weight * j[row];
      for (int column = 0; column <= row; ++column, ++n) lower[n] += scaled * j[column];
    }
  }
};

inline Vector6 operator*(const Symmetric6& a, const Vector6& x) {
  Vector6 y{};
  for (int row = 0, n = 0; row < 6; ++row) {
    for (int column = 0; column < row; ++column, ++n) {
      y[row] += a.lower[n] * x[column];
      y[column] += a.lower[n] * x[row];
    }
    y[row] += a.lower[n++] * x[row];
  }
  return y;
}

// Adds a symmetric 3x3 matrix on the diagonal, at row `first`.
inline void add_block(const glm::dmat3& block, int first, Symmetric6& matrix) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column <= row; ++column) {
      matrix.lower[Symmetric6::at(first + row, first + column)] += block[column][row];
    }
  }
}

// Adds J^T S J, J giving the velocity v + w x r of the point at the arm r: a mass or a damping that
// sits there, S symmetric.
inline void add_at_arm(const glm::dmat3& s, const glm::dvec3& arm_m, Symmetric6& matrix) {
  const glm::dmat3 moment(glm::cross(arm_m, s[0]), glm::cross(arm_m, s[1]),
                          glm::cross(arm_m, s[2]));
  const glm::dmat3 turned = glm::transpose(moment);
  add_block(s, 0, matrix);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      matrix.lower[Symmetric6::at(3 + row, column)] += moment[column][row];
    }
  }
  add_block(
      {glm::cross(arm_m, turned[0]), glm::cross(arm_m, turned[1]), glm::cross(arm_m, turned[2])}, 3,
      matrix);
}

// The x of a x = b by Cholesky. A pivot that rounding made non-positive leaves its component zero,
// so that the result is finite for every finite, positive semi-definite `a`.
inline Vector6 solve(Symmetric6 a, Vector6 b) {
  auto& l = a.lower;
  const auto at = Symmetric6::at;
  std::array<double, 6> inverse_pivot{};
  for (int j = 0; j < 6; ++j) {
    double pivot = l[at(j, j)];
    for (int k = 0; k < j; ++k) pivot -= l[at(j, k)] * l[at(j, k)];
    inverse_pivot[j] = pivot > 1e-14 * l[at(j, j)] ? 1 / std::sqrt(pivot) : 0;
    for (int i = j + 1; i < 6; ++i) {
      double sum = l[at(i, j)];
      for (int k = 0; k < j; ++k) sum -= l[at(i, k)] * l[at(j, k)];
      l[at(i, j)] = sum * inverse_pivot[j];
    }
  }
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= l[at(i, k)] * b[k];
    b[i] *= inverse_pivot[i];
  }
  for (int i = 5; i >= 0; --i) {
    for (int k = i + 1; k < 6; ++k) b[i] -= l[at(k, i)] * b[k];
    b[i] *= inverse_pivot[i];
  }
  return b;
}

}  // namespace forcelayer::coupling
