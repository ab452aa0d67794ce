// The moving part as one canonical triangle soup in meters.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/result.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::part {

// Where a body's mesh stands.
struct Placing {
  std::uint32_t mesh = 0;       // bodies of one number are instances of one mesh
  mesh::Affine part_from_mesh;  // to m, in the frame in which the part was assembled
};

// One rigid part. Equal vertices are one vertex, and vertices ascend. Each triangle starts at its
// lowest vertex, and triangles ascend. So two files that hold the same triangles in another order
// give the same part.
struct Part {
  std::vector<Vec3> vertices;  // [n] distinct, lexicographically ascending, m, part frame
  std::vector<mesh::Triangle> triangles;  // [m] vertex indices, as oriented in the file
  std::vector<std::uint32_t> body;        // [m] index into body_names
  std::vector<std::string> body_names;
  std::vector<std::uint32_t> source;       // [m] number of the triangle in its body's mesh
  std::vector<Placing> placings;           // [bodies]
  std::uint64_t input_triangles = 0;       // over all instances
  std::uint64_t duplicate_triangles = 0;   // dropped: the corners of another of their body
  std::uint64_t degenerate_triangles = 0;  // is_flat(): kept and covered all the same
  // The largest of any vertex and of the sums on its way to its place, m, absolute: all rounding
  // follows it.
  double largest_coordinate = 0;
  bool single_precision = false;  // whether any file stores 32-bit vertices
  double deviation_m = 0;  // of the triangles from exact surfaces that a file holds (STEP, IGES)
  std::vector<mesh::MissingFace> missing_faces;  // of those surfaces; part frame, m
  std::optional<mesh::Up> up;                    // mesh::Assembly::up, where a file has one
};

// One mesh file's content and the unit to read it in.
struct PartInput {
  const mesh::Assembly* assembly = nullptr;
  double meters_per_unit = 1;
};

// Unites all instances of all inputs. Triangles of a body that have the same corners, either way
// round, are one; so are bodies that have the same triangles. Two faces back to back are one face:
// a sheet, or a wall between two rooms of a solid, not a second volume.
// Error: kMeshEmpty where no triangle has an area.
Result<Part> assemble_part(std::span<const PartInput> inputs);

// The corners of a triangle or of a piece of one, m.
using Piece = std::array<Vec3, 3>;

inline Piece triangle_piece(const Part& part, std::size_t t) {
  const mesh::Triangle& corners = part.triangles[t];
  return {part.vertices[corners[0]], part.vertices[corners[1]], part.vertices[corners[2]]};
}

inline Vec3 centroid(const Piece& p) { return (1.0 / 3) * (p[0] + p[1] + p[2]); }

// Twice the area times the unit normal (right-hand rule) of triangle `t`, m^2.
inline Vec3 doubled_area_normal(const Part& part, std::size_t t) {
  const auto [a, b, c] = triangle_piece(part, t);
  return cross(b - a, c - a);
}

// m^2
inline double area(const Part& part) {
  double area_m2 = 0;
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    area_m2 += length(doubled_area_normal(part, t)) / 2;
  }
  return area_m2;
}

// The box around these triangles.
Box box_of(const Part& part, std::span<const std::uint32_t> triangles);

// The triangles of each body, ascending: [bodies][triangles].
std::vector<std::vector<std::uint32_t>> triangles_by_body(const Part& part);

// These bodies as a part of their own; `of_body`: triangles_by_body() of the part.
Part part_of_bodies(const Part& part, std::span<const std::uint32_t> bodies,
                    std::span<const std::vector<std::uint32_t>> of_body);

// The part moved by -`origin`. Shells are made and proven relative to their center.
Part relative_to(Part part, const Vec3& origin);

}  // namespace forcelayer::part
