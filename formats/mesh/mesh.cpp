#include "formats/mesh/mesh.h"

namespace forcelayer::mesh {

Vec3d apply(const Affine& a_from_b, const Vec3d& b) {
  const auto& m = a_from_b.linear;
  const auto& t = a_from_b.translation;
  return {m[0] * b[0] + m[1] * b[1] + m[2] * b[2] + t[0],
          m[3] * b[0] + m[4] * b[1] + m[5] * b[2] + t[1],
          m[6] * b[0] + m[7] * b[1] + m[8] * b[2] + t[2]};
}

Affine compose(const Affine& a_from_b, const Affine& b_from_c) {
  Affine a_from_c;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        sum += a_from_b.linear[3 * row + k] * b_from_c.linear[3 * k + column];
      }
      a_from_c.linear[3 * row + column] = sum;
    }
  }
  a_from_c.translation = apply(a_from_b, b_from_c.translation);
  return a_from_c;
}

std::uint64_t Assembly::triangle_count() const {
  std::uint64_t count = 0;
  for (const MeshInstance& instance : instances) count += meshes[instance.mesh].triangles.size();
  return count;
}

}  // namespace forcelayer::mesh
