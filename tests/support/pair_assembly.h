// Small assemblies of boxes, rods, rings and plates for the tests of `forcelayer pairs`.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <string>
#include <utility>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"
#include "workbench/pairs/assembly_parts.h"

namespace forcelayer::test {

inline mesh::Mesh box_mesh(double x, double y, double z) {
  mesh::Mesh mesh;
  for (int n = 0; n < 8; ++n) {
    mesh.vertices.push_back({(n & 1 ? x : -x) / 2, (n & 2 ? y : -y) / 2, (n & 4 ? z : -z) / 2});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// A prism of some sides with a hole of as many along z.
inline mesh::Mesh ring_mesh(int sides, double hole, double radius, double length) {
  mesh::Mesh mesh;
  for (int n = 0; n < sides; ++n) {
    const double turn = 2 * std::numbers::pi * n / sides;
    for (const double r : {hole, radius}) {
      for (const double z : {-length / 2, length / 2}) {
        mesh.vertices.push_back({r * std::cos(turn), r * std::sin(turn), z});
      }
    }
  }
  const auto count = static_cast<std::uint32_t>(4 * sides);
  for (std::uint32_t a = 0; a < count; a += 4) {
    const std::uint32_t b = (a + 4) % count;
    const auto quad = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r, std::uint32_t s) {
      mesh.triangles.push_back({p, q, r});
      mesh.triangles.push_back({p, r, s});
    };
    quad(a, a + 1, b + 1, b);          // the hole
    quad(a + 2, b + 2, b + 3, a + 3);  // outside
    quad(a, b, b + 2, a + 2);          // the ends
    quad(a + 1, a + 3, b + 3, b + 1);
  }
  return mesh;
}

inline mesh::Mesh rod_mesh(int sides, double radius, double length) {
  mesh::Mesh mesh;
  for (int n = 0; n < sides; ++n) {
    const double turn = 2 * std::numbers::pi * n / sides;
    for (const double z : {-length / 2, length / 2}) {
      mesh.vertices.push_back({radius * std::cos(turn), radius * std::sin(turn), z});
    }
  }
  const auto count = static_cast<std::uint32_t>(2 * sides);
  for (std::uint32_t a = 0; a < count; a += 2) {
    const std::uint32_t b = (a + 2) % count;
    mesh.triangles.push_back({a, b, a + 1});
    mesh.triangles.push_back({b, b + 1, a + 1});
  }
  for (std::uint32_t a = 2; a + 2 < count; a += 2) {
    mesh.triangles.push_back({0, a + 2, a});
    mesh.triangles.push_back({1, a + 1, a + 3});
  }
  return mesh;
}

inline mesh::Mesh moved(mesh::Mesh mesh, const Pose& pose) {
  for (mesh::Vec3d& v : mesh.vertices) {
    const glm::dvec3 p = pose.position_m + pose.orientation * glm::dvec3(v[0], v[1], v[2]);
    v = {p.x, p.y, p.z};
  }
  return mesh;
}

inline mesh::Mesh moved(mesh::Mesh mesh, double x, double y, double z) {
  return moved(std::move(mesh), Pose{{x, y, z}, {1, 0, 0, 0}});
}

// Adds a part whose mesh is in the world.
inline void add_part(pairs::AssemblyParts& assembly, const std::string& name, mesh::Mesh mesh,
                     double deviation_m = 0) {
  if (assembly.scene.assemblies.empty()) assembly.scene.assemblies.emplace_back();
  std::vector<mesh::Mesh>& meshes = assembly.scene.assemblies[0].meshes;
  mesh::MeshObject object;
  object.name = name;
  object.mesh = static_cast<std::uint32_t>(meshes.size());
  pairs::AssemblyPart part;
  part.name = {name, name};
  part.object = assembly.scene.objects.size();
  part.box_m = mesh::box_of(mesh, {});
  part.deviation_m = deviation_m;
  for (const mesh::Vec3d& v : mesh.vertices) {
    for (const double x : v) part.rounding_m = std::max(part.rounding_m, 0x1p-24 * std::abs(x));
  }
  meshes.push_back(std::move(mesh));
  assembly.scene.objects.push_back(object);
  assembly.parts.push_back(part);
  assembly.add_paths();
}

}  // namespace forcelayer::test
