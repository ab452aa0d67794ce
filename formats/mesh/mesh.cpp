#include "formats/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcelayer::mesh {

Vec3d apply(const Affine& a_from_b, const Vec3d& b) {
  const auto& m = a_from_b.linear;
  const auto& t = a_from_b.translation;
  return {m[0] * b[0] + m[1] * b[1] + m[2] * b[2] + t[0],
          m[3] * b[0] + m[4] * b[1] + m[5] * b[2] + t[1],
          m[6] * b[0] + m[7] * b[1] + m[8] * b[2] + t[2]};
}

double largest_sum(const Affine& a_from_b, const Vec3d& largest) {
  Affine sizes = a_from_b;
  for (double& factor : sizes.linear) factor = std::abs(factor);
  for (double& offset : sizes.translation) offset = std::abs(offset);
  const Vec3d sums = mesh::apply(sizes, largest);
  return std::max({sums[0], sums[1], sums[2]});
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

bool is_flat(const Affine& affine) {
  constexpr double kRounding = 1e-12;  // of a determinant of three directions
  std::array<double, 9> m = affine.linear;
  for (std::size_t column = 0; column < 3; ++column) {
    const double length = std::hypot(m[column], m[3 + column], m[6 + column]);
    if (length == 0) return true;
    for (std::size_t row = 0; row < 3; ++row) m[3 * row + column] /= length;
  }
  const double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) -
                             m[1] * (m[3] * m[8] - m[5] * m[6]) +
                             m[2] * (m[3] * m[7] - m[4] * m[6]);
  return std::abs(determinant) < kRounding;
}

Box empty_box() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
}

void extend(Box& box, const Vec3d& point) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], point[axis]);
    box.high[axis] = std::max(box.high[axis], point[axis]);
  }
}

void extend(Box& box, const Box& other) {
  if (other.low[0] > other.high[0]) return;
  extend(box, other.low);
  extend(box, other.high);
}

Box box_of(const Mesh& mesh, const Affine& a_from_mesh) {
  Box box = empty_box();
  for (const Vec3d& vertex : mesh.vertices) extend(box, apply(a_from_mesh, vertex));
  return box;
}

Box box_of(const Box& box, const Affine& a_from_b) {
  Box moved = empty_box();
  if (box.low[0] > box.high[0]) return moved;
  for (unsigned corner = 0; corner < 8; ++corner) {
    extend(moved, apply(a_from_b, {corner & 1 ? box.high[0] : box.low[0],
                                   corner & 2 ? box.high[1] : box.low[1],
                                   corner & 4 ? box.high[2] : box.low[2]}));
  }
  return moved;
}

void measure_instances(Assembly& assembly) {
  std::uint64_t vertices = 0;
  for (const MeshInstance& instance : assembly.instances) {
    vertices += assembly.meshes[instance.mesh].vertices.size();
  }
  if (vertices <= kMaxMeasuredVertices) {
    for (MeshInstance& instance : assembly.instances) {
      instance.box = box_of(assembly.meshes[instance.mesh], instance.assembly_from_mesh);
    }
    return;
  }
  std::vector<Box> boxes;
  for (const Mesh& mesh : assembly.meshes) boxes.push_back(box_of(mesh, {}));
  for (MeshInstance& instance : assembly.instances) {
    instance.box = box_of(boxes[instance.mesh], instance.assembly_from_mesh);
  }
}

std::uint64_t Assembly::triangle_count() const {
  std::uint64_t count = 0;
  for (const MeshInstance& instance : instances) count += meshes[instance.mesh].triangles.size();
  return count;
}

double Assembly::deviation_units() const {
  double largest = 0;
  for (const MeshInstance& instance : instances) {
    largest = std::max(largest, instance.deviation_units);
  }
  return largest;
}

}  // namespace forcelayer::mesh
