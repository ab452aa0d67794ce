// Seeded random meshes in voxels: soups, closed and open solids, degenerate triangles, needles.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "formats/mesh/mesh.h"

namespace forcelayer::reference {

using Random = std::mt19937_64;

inline std::int64_t whole(Random& random, std::int64_t low, std::int64_t high) {
  return std::uniform_int_distribution<std::int64_t>(low, high)(random);
}
inline double real(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline void add_triangle(mesh::Mesh& mesh, const mesh::Vec3d& a, const mesh::Vec3d& b,
                         const mesh::Vec3d& c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

// A box with corners `low` and `high`; bit f of `missing` leaves face f out.
inline void add_box(mesh::Mesh& mesh, const mesh::Vec3d& low, const mesh::Vec3d& high,
                    unsigned missing = 0) {
  const auto corner = [&](unsigned n) {
    return mesh::Vec3d{n & 1 ? high[0] : low[0], n & 2 ? high[1] : low[1],
                       n & 4 ? high[2] : low[2]};
  };
  constexpr unsigned kFaces[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                     {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
  for (unsigned f = 0; f < 6; ++f) {
    if (missing >> f & 1) continue;
    const auto& face = kFaces[f];
    add_triangle(mesh, corner(face[0]), corner(face[1]), corner(face[2]));
    add_triangle(mesh, corner(face[0]), corner(face[2]), corner(face[3]));
  }
}

// A closed sphere of rings x 2 rings faces.
inline void add_sphere(mesh::Mesh& mesh, const mesh::Vec3d& center, double radius, int rings) {
  const auto point = [&](int i, int j) {
    const double polar = 3.14159265358979 * i / rings,
                 turn = 3.14159265358979 * (j % (2 * rings)) / rings;
    const double ring = i == 0 || i == rings ? 0 : radius * std::sin(polar);
    return mesh::Vec3d{center[0] + ring * std::cos(turn), center[1] + ring * std::sin(turn),
                       center[2] + radius * std::cos(polar)};
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < 2 * rings; ++j) {
      add_triangle(mesh, point(i, j), point(i + 1, j), point(i + 1, j + 1));
      add_triangle(mesh, point(i, j), point(i + 1, j + 1), point(i, j + 1));
    }
  }
}

// A triangle a few units wide and up to about `longest` long along an axis. The line through its
// long edges leads from its tip through a point, but for its rounding.
inline std::array<std::array<std::int64_t, 3>, 3> random_needle(
    Random& random, const std::array<std::int64_t, 3>& through, std::int64_t longest) {
  std::array<std::int64_t, 3>
      along;  // small numbers, so that what is on the line is a lattice point
  do {
    for (std::int64_t& x : along) x = whole(random, -3, 3);
  } while (along == std::array<std::int64_t, 3>{});
  const std::int64_t tip = whole(random, 0, 1024);
  const std::int64_t end = tip + 1 + (longest / 3 >> whole(random, 0, 5));
  std::array<std::array<std::int64_t, 3>, 3> corners;
  for (std::size_t d = 0; d < 3; ++d) {
    corners[0][d] = through[d] + tip * along[d];
    corners[1][d] = through[d] + end * along[d];
    corners[2][d] = corners[1][d] + whole(random, -4, 4);
  }
  return corners;
}

// One in units of 2^-10 voxel, through the center of a voxel near `place`.
inline void add_needle(mesh::Mesh& mesh, Random& random, const mesh::Vec3d& place, double longest) {
  std::array<std::int64_t, 3> center;
  for (std::size_t d = 0; d < 3; ++d) {
    center[d] = static_cast<std::int64_t>(std::floor(place[d])) * 1024 + 512;
  }
  std::array<mesh::Vec3d, 3> corners;
  const auto units = random_needle(random, center, static_cast<std::int64_t>(1024 * longest));
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) corners[k][d] = static_cast<double>(units[k][d]) / 1024;
  }
  add_triangle(mesh, corners[0], corners[1], corners[2]);
}

// One object of up to `extent` voxels around `center`, coordinates in voxels.
inline mesh::Mesh random_object(Random& random, const mesh::Vec3d& center, double extent) {
  mesh::Mesh mesh;
  const double grid =
      std::array<double, 4>{0, 0, 0.5, 1}[static_cast<std::size_t>(whole(random, 0, 3))];
  const auto point = [&] {
    mesh::Vec3d p;
    for (std::size_t d = 0; d < 3; ++d) {
      p[d] = center[d] + real(random, -extent / 2, extent / 2);
      if (grid > 0) p[d] = std::round(p[d] / grid) * grid;
    }
    return p;
  };
  const auto ordered_box = [&](unsigned missing) {
    mesh::Vec3d a = point(), b = point();
    for (std::size_t d = 0; d < 3; ++d) {
      if (a[d] > b[d]) std::swap(a[d], b[d]);
    }
    add_box(mesh, a, b, missing);
  };
  switch (whole(random, 0, 7)) {
    case 0:  // a soup
      for (std::int64_t n = whole(random, 1, 25); n > 0; --n)
        add_triangle(mesh, point(), point(), point());
      break;
    case 1:  // segments and points
      for (std::int64_t n = whole(random, 1, 6); n > 0; --n) {
        const mesh::Vec3d a = point();
        add_triangle(mesh, a, whole(random, 0, 1) == 0 ? a : point(), a);
      }
      break;
    case 2:
      ordered_box(0);
      break;
    case 3:  // open by one or two faces
      ordered_box(1u << whole(random, 0, 5) | 1u << whole(random, 0, 5));
      break;
    case 4:  // a box in a box
      add_box(mesh, {center[0] - extent / 2, center[1] - extent / 2, center[2] - extent / 2},
              {center[0] + extent / 2, center[1] + extent / 2, center[2] + extent / 2});
      ordered_box(0);
      break;
    case 5:
      add_sphere(mesh, center, real(random, 0.3, extent / 2),
                 static_cast<int>(whole(random, 3, 8)));
      break;
    case 6:
      for (std::int64_t n = whole(random, 1, 12); n > 0; --n)
        add_needle(mesh, random, point(), extent);
      break;
    default:  // closed walls with a soup inside
      add_sphere(mesh, center, extent / 2, 6);
      for (std::int64_t n = whole(random, 1, 6); n > 0; --n)
        add_triangle(mesh, point(), point(), point());
  }
  return mesh;
}

}  // namespace forcelayer::reference
