// Inertia tensors by their principal axes.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace forcelayer::model {

// tensor = axes * diag(moments) * axes^T; the columns of `axes` are unit and perpendicular.
struct PrincipalInertia {
  glm::dmat3 axes{1};
  glm::dvec3 moments{0};
};

// By Jacobi rotations; for symmetric tensors.
PrincipalInertia principal_inertia(const glm::dmat3& tensor);

// axes * diag(moments) * axes^T, symmetric to the last bit
glm::dmat3 tensor_of(const PrincipalInertia& inertia);

}  // namespace forcelayer::model
