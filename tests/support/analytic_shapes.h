// Meshes of shapes whose area, volume, inertia and normals have closed forms. All face outwards and
// are centered on the origin; lengths in meters.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::testing {

// A mesh over a grid of parameters u, v in [0, 1); `wrap_u` and `wrap_v` close it. Triangles face
// along d/du x d/dv.
inline mesh::Mesh grid_mesh(int across, int along, bool wrap_u, bool wrap_v,
                            const std::function<part::Vec3(double, double)>& place) {
  mesh::Mesh mesh;
  mesh.single_precision = false;
  const int rows = wrap_u ? across : across + 1, columns = wrap_v ? along : along + 1;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const part::Vec3 p = place(static_cast<double>(i) / across, static_cast<double>(j) / along);
      mesh.vertices.push_back({p.x, p.y, p.z});
    }
  }
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>(i % rows * columns + j % columns);
  };
  for (int i = 0; i < across; ++i) {
    for (int j = 0; j < along; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

inline mesh::Mesh sphere_mesh(double radius, int segments) {
  return grid_mesh(segments, segments, false, true, [&](double u, double v) {
    // The poles are exact, so that all their vertices are one.
    const double polar = std::numbers::pi * u, turn = 2 * std::numbers::pi * v;
    const double ring = u == 0 || u == 1 ? 0 : radius * std::sin(polar);
    return part::Vec3{ring * std::cos(turn), ring * std::sin(turn), radius * std::cos(polar)};
  });
}

inline mesh::Mesh torus_mesh(double ring_radius, double tube_radius, int segments) {
  return grid_mesh(2 * segments, segments, true, true, [&](double u, double v) {
    const double turn = 2 * std::numbers::pi * u, tube = 2 * std::numbers::pi * v;
    const double from_axis = ring_radius + tube_radius * std::cos(tube);
    return part::Vec3{from_axis * std::cos(turn), from_axis * std::sin(turn),
                      tube_radius * std::sin(tube)};
  });
}

// Side along u around the axis z, closed by fans at both ends; a cone where top_radius is 0.
inline mesh::Mesh cone_mesh(double bottom_radius, double top_radius, double height, int segments) {
  mesh::Mesh mesh = grid_mesh(segments, 1, true, false, [&](double u, double v) {
    const double turn = 2 * std::numbers::pi * u;
    const double radius = v == 0 ? bottom_radius : top_radius;
    return part::Vec3{radius * std::cos(turn), radius * std::sin(turn), height * (v - 0.5)};
  });
  const auto first_cap = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back({0, 0, -height / 2});
  mesh.vertices.push_back({0, 0, height / 2});
  for (int i = 0; i < segments; ++i) {
    const auto a = static_cast<std::uint32_t>(2 * i);
    const auto b = static_cast<std::uint32_t>(2 * ((i + 1) % segments));
    mesh.triangles.push_back({first_cap, b, a});
    if (top_radius > 0) mesh.triangles.push_back({first_cap + 1, a + 1, b + 1});
  }
  return mesh;
}

inline mesh::Mesh cylinder_mesh(double radius, double height, int segments) {
  return cone_mesh(radius, radius, height, segments);
}

inline mesh::Mesh box_mesh(double x, double y, double z) {
  mesh::Mesh mesh;
  mesh.single_precision = false;
  for (unsigned n = 0; n < 8; ++n) {
    mesh.vertices.push_back(
        {(n & 1 ? 0.5 : -0.5) * x, (n & 2 ? 0.5 : -0.5) * y, (n & 4 ? 0.5 : -0.5) * z});
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// A kettle of a few patches, as modelers draw one: bowl, spout, handle and lid are open sheets that
// pass through each other. All face outwards.
inline mesh::Mesh kettle_mesh(int segments) {
  constexpr double kTurn = 2 * std::numbers::pi;
  mesh::Mesh kettle;
  const auto add = [&](const mesh::Mesh& patch) {
    const auto first = static_cast<std::uint32_t>(kettle.vertices.size());
    kettle.vertices.insert(kettle.vertices.end(), patch.vertices.begin(), patch.vertices.end());
    for (const auto& [a, b, c] : patch.triangles) {
      kettle.triangles.push_back({first + a, first + b, first + c});
    }
  };
  // A sheet around the axis z, from height z0 at radius r0 on along a bulging profile.
  const auto turned = [&](double z0, double r0, double z1, double r1, double bulge) {
    add(grid_mesh(2 * segments, segments, true, false, [&](double u, double v) {
      const double radius = r0 + v * (r1 - r0) + bulge * std::sin(std::numbers::pi * v);
      return part::Vec3{radius * std::cos(kTurn * u), radius * std::sin(kTurn * u),
                        z0 + v * (z1 - z0)};
    }));
  };
  // A tube open at both ends, around a curve in the plane y = 0.
  const auto tube = [&](double radius, const std::function<part::Vec3(double)>& curve) {
    add(grid_mesh(segments, segments, true, false, [&](double u, double v) {
      const part::Vec3 along = part::normalized(curve(v + 1e-3) - curve(v - 1e-3));
      const part::Vec3 side{0, 1, 0}, up = part::cross(along, side);
      return curve(v) + radius * (std::cos(kTurn * u) * side + std::sin(kTurn * u) * up);
    }));
  };
  turned(-1, 0, 0.6, 0.8, 0.7);    // bowl, open at the top
  turned(0.5, 0.85, 0.9, 0, 0.1);  // lid, whose rim stands over the bowl's
  tube(0.15, [](double t) { return part::Vec3{0.9 + 0.9 * t, 0, -0.5 + 1.2 * t * t}; });  // spout
  tube(0.1, [](double t) {  // handle, whose ends are inside
    const double turn = std::numbers::pi * (t - 0.5);
    return part::Vec3{-1 - 0.7 * std::cos(turn), 0, 0.6 * std::sin(turn)};
  });
  return kettle;
}

inline mesh::Assembly assembly_of(std::vector<mesh::Mesh> meshes) {
  mesh::Assembly assembly;
  for (mesh::Mesh& mesh : meshes) {
    const auto index = static_cast<std::uint32_t>(assembly.meshes.size());
    assembly.instances.push_back({index, "body " + std::to_string(index), {}});
    assembly.meshes.push_back(std::move(mesh));
  }
  return assembly;
}

}  // namespace forcelayer::testing
