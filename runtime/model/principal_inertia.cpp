#include "runtime/model/principal_inertia.h"

#include <cmath>
#include <glm/matrix.hpp>

namespace forcelayer::model {
namespace {

constexpr int kSweeps = 12;  // a 3x3 tensor is diagonal to the last bit after five or six

// The rotation in the plane of axes p and q that makes a[p][q] zero.
glm::dmat3 jacobi_rotation(const glm::dmat3& a, int p, int q) {
  glm::dmat3 rotation(1);
  if (a[p][q] == 0) return rotation;
  const double cotangent = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double tangent =
      std::copysign(1.0, cotangent) / (std::abs(cotangent) + std::hypot(1.0, cotangent));
  const double cosine = 1 / std::hypot(1.0, tangent), sine = tangent * cosine;
  rotation[p][p] = rotation[q][q] = cosine;
  rotation[q][p] = sine;
  rotation[p][q] = -sine;
  return rotation;
}

}  // namespace

PrincipalInertia principal_inertia(const glm::dmat3& tensor) {
  glm::dmat3 rest = tensor;
  PrincipalInertia result;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        const glm::dmat3 rotation = jacobi_rotation(rest, p, q);
        rest = glm::transpose(rotation) * rest * rotation;
        result.axes = result.axes * rotation;
      }
    }
  }
  result.moments = {rest[0][0], rest[1][1], rest[2][2]};
  return result;
}

glm::dmat3 tensor_of(const PrincipalInertia& inertia) {
  glm::dmat3 scaled = inertia.axes;
  for (int i = 0; i < 3; ++i) scaled[i] *= inertia.moments[i];
  glm::dmat3 tensor = scaled * glm::transpose(inertia.axes);
  for (int i = 1; i < 3; ++i)
    for (int j = 0; j < i; ++j) tensor[i][j] = tensor[j][i];
  return tensor;
}

}  // namespace forcelayer::model
