// Parts in memory and seeded random places on them.
#pragma once

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

#include "pointshell/part/part.h"
#include "tests/support/analytic_shapes.h"
#include "tests/support/models.h"

namespace forcelayer::testing {

inline part::Part part_of(std::vector<mesh::Mesh> meshes, double metres_per_unit = 1) {
  const mesh::Assembly assembly = assembly_of(std::move(meshes));
  const part::PartInput input{&assembly, metres_per_unit};
  return std::move(part::assemble_part({&input, 1})).value();
}

inline part::Part part_of(mesh::Mesh mesh, double metres_per_unit = 1) {
  return part_of(std::vector<mesh::Mesh>{std::move(mesh)}, metres_per_unit);
}

inline part::Part part_of_model(const std::string& file, double metres_per_unit) {
  const auto assembly = mesh::read_assembly(test::model_path(file));
  const part::PartInput input{&assembly.value(), metres_per_unit};
  return std::move(part::assemble_part({&input, 1})).value();
}

// A square bundle of rods side by side, with more surface than their outside has.
inline mesh::Mesh bundle_mesh(int rods_across, double rod_radius, double height, int segments) {
  mesh::Mesh bundle;
  for (int n = 0; n < rods_across * rods_across; ++n) {
    const auto first = static_cast<std::uint32_t>(bundle.vertices.size());
    const mesh::Mesh rod = cylinder_mesh(rod_radius, height, segments);
    for (const auto& [x, y, z] : rod.vertices) {
      bundle.vertices.push_back(
          {x + 2.5 * rod_radius * (n % rods_across), y + 2.5 * rod_radius * (n / rods_across), z});
    }
    for (const auto& [a, b, c] : rod.triangles) {
      bundle.triangles.push_back({a + first, b + first, c + first});
    }
  }
  return bundle;
}

// Places on the surface, uniform by area.
class SurfaceDice {
 public:
  SurfaceDice(const part::Part& part, std::uint64_t seed) : part_(part), random_(seed) {
    double sum = 0;
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      cumulated_area_.push_back(sum += part::length(part::doubled_area_normal(part, t)));
    }
  }

  part::Vec3 throw_once() {
    std::uniform_real_distribution<double> unit(0, 1);
    const auto at = std::lower_bound(cumulated_area_.begin(), cumulated_area_.end(),
                                     unit(random_) * cumulated_area_.back());
    const auto t = static_cast<std::size_t>(
        std::min(at - cumulated_area_.begin(), std::ptrdiff_t(part_.triangles.size()) - 1));
    double u = unit(random_), v = unit(random_);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const mesh::Triangle& corners = part_.triangles[t];
    const part::Vec3& a = part_.vertices[corners[0]];
    return a + u * (part_.vertices[corners[1]] - a) + v * (part_.vertices[corners[2]] - a);
  }

 private:
  const part::Part& part_;
  std::mt19937_64 random_;
  std::vector<double> cumulated_area_;
};

// The same triangles in another order, each starting at another corner, vertices renumbered.
inline mesh::Mesh shuffled(const mesh::Mesh& mesh, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint32_t> renumbered(mesh.vertices.size());
  for (std::uint32_t n = 0; n < renumbered.size(); ++n) renumbered[n] = n;
  std::shuffle(renumbered.begin(), renumbered.end(), random);
  mesh::Mesh result = mesh;
  for (std::size_t n = 0; n < renumbered.size(); ++n) {
    result.vertices[renumbered[n]] = mesh.vertices[n];
  }
  for (mesh::Triangle& t : result.triangles) {
    for (std::uint32_t& corner : t) corner = renumbered[corner];
    std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random() % 3), t.end());
  }
  std::shuffle(result.triangles.begin(), result.triangles.end(), random);
  return result;
}

}  // namespace forcelayer::testing
