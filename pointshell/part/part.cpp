#include "pointshell/part/part.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "pointshell/part/pieces.h"

namespace forcelayer::part {
namespace {

// All triangles of all instances with their own three corners each.
struct CornerSoup {
  std::vector<Vec3> corners;                // [3 * triangles]
  std::vector<std::uint32_t> body, source;  // [triangles]
  double largest_m = 0;                     // sum on the way of a vertex to its place
};

double determinant(const std::array<double, 9>& m) {
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
         m[2] * (m[3] * m[7] - m[4] * m[6]);
}

mesh::Affine in_meters(mesh::Affine assembly_from_mesh, double meters_per_unit) {
  for (double& x : assembly_from_mesh.linear) x *= meters_per_unit;
  for (double& x : assembly_from_mesh.translation) x *= meters_per_unit;
  return assembly_from_mesh;
}

void append_instance(const mesh::Mesh& mesh, const mesh::Affine& assembly_from_mesh,
                     double meters_per_unit, std::uint32_t body, CornerSoup& soup) {
  std::vector<Vec3> placed;
  placed.reserve(mesh.vertices.size());
  mesh::Vec3d largest{0, 0, 0};
  for (const mesh::Vec3d& vertex : mesh.vertices) {
    for (std::size_t d = 0; d < 3; ++d) largest[d] = std::max(largest[d], std::abs(vertex[d]));
    const mesh::Vec3d moved = mesh::apply(assembly_from_mesh, vertex);
    // Adding zero turns -0 into +0, so that equal places have equal bits.
    placed.push_back({moved[0] * meters_per_unit + 0.0, moved[1] * meters_per_unit + 0.0,
                      moved[2] * meters_per_unit + 0.0});
  }
  soup.largest_m = std::max(
      soup.largest_m, mesh::largest_sum(assembly_from_mesh, largest) * std::abs(meters_per_unit));
  // A mirrored placing turns every triangle inside out; its corners are taken the other way round.
  const bool mirrored = determinant(assembly_from_mesh.linear) < 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    mesh::Triangle triangle = mesh.triangles[t];
    if (mirrored) std::swap(triangle[1], triangle[2]);
    for (const std::uint32_t corner : triangle) soup.corners.push_back(placed[corner]);
    soup.body.push_back(body);
    soup.source.push_back(t);
  }
}

// Fills part.vertices and part.triangles (in the soup's order) with equal corners merged.
void weld(const CornerSoup& soup, Part& part) {
  std::vector<std::uint32_t> order(soup.corners.size());
  std::iota(order.begin(), order.end(), 0u);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return lexicographic_less(soup.corners[a], soup.corners[b]);
  });
  part.triangles.resize(soup.body.size());
  for (const std::uint32_t corner : order) {
    const Vec3& position = soup.corners[corner];
    if (part.vertices.empty() || !(part.vertices.back() == position)) {
      part.vertices.push_back(position);
    }
    part.triangles[corner / 3][corner % 3] = static_cast<std::uint32_t>(part.vertices.size() - 1);
  }
}

// The same corners from the same first one, the other way round.
mesh::Triangle turned(const mesh::Triangle& t) { return {t[0], t[2], t[1]}; }

mesh::Triangle without_side(const mesh::Triangle& t) { return std::min(t, turned(t)); }

// Whether two bodies, as lists of their triangles, are the same but for their triangles' sides.
bool same_triangles(const Part& part, std::span<const std::uint32_t> a,
                    std::span<const std::uint32_t> b) {
  std::vector<mesh::Triangle> of_a, of_b;
  for (const std::uint32_t t : a) of_a.push_back(without_side(part.triangles[t]));
  for (const std::uint32_t t : b) of_b.push_back(without_side(part.triangles[t]));
  std::sort(of_a.begin(), of_a.end());
  std::sort(of_b.begin(), of_b.end());
  return of_a == of_b;
}

// Whether each body is another one again.
std::vector<bool> repeated_bodies(const Part& part) {
  std::vector<bool> repeated(part.body_names.size());
  if (repeated.size() < 2) return repeated;
  const auto of_body = triangles_by_body(part);
  using Sums = std::array<std::uint64_t, 4>;  // of corners, and the number of triangles
  std::map<Sums, std::vector<std::size_t>> known;
  for (std::size_t body = 0; body < of_body.size(); ++body) {
    Sums sums{0, 0, 0, of_body[body].size()};
    for (const std::uint32_t t : of_body[body]) {
      for (int n = 0; n < 3; ++n) sums[n] += without_side(part.triangles[t])[n];
    }
    std::vector<std::size_t>& alike = known[sums];
    repeated[body] = std::any_of(alike.begin(), alike.end(), [&](std::size_t other) {
      return same_triangles(part, of_body[body], of_body[other]);
    });
    if (!repeated[body]) alike.push_back(body);
  }
  return repeated;
}

// Drops of `order`, in which triangles ascend, those that are there already in their body.
void drop_repeated(const Part& part, std::vector<std::uint32_t>& order) {
  const auto key = [&](std::uint32_t t) { return std::tie(part.triangles[t], part.body[t]); };
  order.erase(std::unique(order.begin(), order.end(),
                          [&](std::uint32_t a, std::uint32_t b) { return key(a) == key(b); }),
              order.end());
  const std::vector<std::uint32_t> all = order;
  const auto has = [&](const mesh::Triangle& triangle, std::uint32_t body) {
    const auto wanted = std::tie(triangle, body);
    const auto found =
        std::lower_bound(all.begin(), all.end(), wanted,
                         [&](std::uint32_t t, const auto& value) { return key(t) < value; });
    return found != all.end() && key(*found) == wanted;
  };
  std::erase_if(order, [&](std::uint32_t t) {
    const mesh::Triangle& own = part.triangles[t];
    return own[2] < own[1] && has(turned(own), part.body[t]);
  });
}

// Keeps the triangles of `order`, in that order.
void keep_triangles(Part& part, std::span<const std::uint32_t> order) {
  std::vector<mesh::Triangle> triangles;
  std::vector<std::uint32_t> body, source;
  triangles.reserve(order.size());
  body.reserve(order.size());
  source.reserve(order.size());
  for (const std::uint32_t t : order) {
    triangles.push_back(part.triangles[t]);
    body.push_back(part.body[t]);
    source.push_back(part.source[t]);
  }
  part.triangles = std::move(triangles);
  part.body = std::move(body);
  part.source = std::move(source);
}

// Rotates every triangle to its lowest vertex, sorts, and drops those that are there already.
void sort_triangles(Part& part) {
  for (mesh::Triangle& t : part.triangles) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  }
  std::vector<std::uint32_t> order(part.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t t) {
    return std::tie(part.triangles[t], part.body[t], part.source[t]);
  };
  tbb::parallel_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  drop_repeated(part, order);
  keep_triangles(part, order);
  const std::vector<bool> repeated = repeated_bodies(part);
  if (std::find(repeated.begin(), repeated.end(), true) != repeated.end()) {
    order.clear();
    for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
      if (!repeated[part.body[t]]) order.push_back(t);
    }
    keep_triangles(part, order);
  }
  part.duplicate_triangles = part.input_triangles - part.triangles.size();
}

void measure(Part& part) {
  for (const Vec3& vertex : part.vertices) {
    part.largest_coordinate = std::max(part.largest_coordinate, max_abs(vertex));
  }
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    part.degenerate_triangles += is_flat(triangle_piece(part, t));
  }
}

Error no_triangles(const char* what) {
  return {ErrorCode::kMeshEmpty, "", "", what, "use a mesh that has a surface"};
}

}  // namespace

Result<Part> assemble_part(std::span<const PartInput> inputs) {
  CornerSoup soup;
  Part part;
  std::uint32_t meshes = 0;
  for (const PartInput& input : inputs) {
    if (input.assembly->up) part.up = input.assembly->up;
    part.deviation_m =
        std::max(part.deviation_m, input.assembly->deviation_units() * input.meters_per_unit);
    for (mesh::MissingFace face : input.assembly->missing_faces) {
      for (double& coordinate : face.center) coordinate *= input.meters_per_unit;
      face.size *= input.meters_per_unit;
      part.missing_faces.push_back(std::move(face));
    }
    for (const mesh::MeshInstance& instance : input.assembly->instances) {
      const mesh::Mesh& mesh = input.assembly->meshes[instance.mesh];
      append_instance(mesh, instance.assembly_from_mesh, input.meters_per_unit,
                      static_cast<std::uint32_t>(part.body_names.size()), soup);
      part.body_names.push_back(instance.name);
      part.placings.push_back(
          {meshes + instance.mesh, in_meters(instance.assembly_from_mesh, input.meters_per_unit)});
      part.single_precision |= mesh.single_precision;
    }
    meshes += static_cast<std::uint32_t>(input.assembly->meshes.size());
  }
  if (soup.body.empty()) return no_triangles("the part has no triangles");
  if (soup.corners.size() > std::numeric_limits<std::uint32_t>::max()) {
    return Error{ErrorCode::kBakeTooLarge, "", "", "the part has more than 2^32 / 3 triangles",
                 "use a coarser mesh"};
  }
  if (!std::all_of(soup.corners.begin(), soup.corners.end(), is_finite)) {
    return Error{ErrorCode::kMeshUnsupported, "", "",
                 "the transform of a vertex overflows double precision",
                 "check units and transforms"};
  }
  part.input_triangles = soup.body.size();
  part.body = std::move(soup.body);
  part.source = std::move(soup.source);
  soup.body.resize(part.body.size());
  part.largest_coordinate = soup.largest_m;
  weld(soup, part);
  sort_triangles(part);
  measure(part);
  if (part.degenerate_triangles == part.triangles.size()) {
    return no_triangles("no triangle of the part has an area");
  }
  return part;
}

Box box_of(const Part& part, std::span<const std::uint32_t> triangles) {
  Box box;
  for (const std::uint32_t t : triangles) {
    for (const std::uint32_t corner : part.triangles[t]) box.grow(part.vertices[corner]);
  }
  return box;
}

std::vector<std::vector<std::uint32_t>> triangles_by_body(const Part& part) {
  std::vector<std::vector<std::uint32_t>> triangles(part.body_names.size());
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t) triangles[part.body[t]].push_back(t);
  return triangles;
}

Part part_of_bodies(const Part& part, std::span<const std::uint32_t> bodies,
                    std::span<const std::vector<std::uint32_t>> of_body) {
  Part own;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> chosen;  // triangle, body of `own`
  for (const std::uint32_t body : bodies) {
    const auto number = static_cast<std::uint32_t>(own.body_names.size());
    own.body_names.push_back(part.body_names[body]);
    own.placings.push_back(part.placings[body]);
    for (const std::uint32_t t : of_body[body]) chosen.emplace_back(t, number);
  }
  std::sort(chosen.begin(), chosen.end());
  std::vector<std::uint32_t> used;
  for (const auto& [t, body] : chosen) {
    used.insert(used.end(), part.triangles[t].begin(), part.triangles[t].end());
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (const std::uint32_t v : used) own.vertices.push_back(part.vertices[v]);
  for (const auto& [t, body] : chosen) {
    mesh::Triangle triangle = part.triangles[t];
    for (std::uint32_t& corner : triangle) {
      const auto found = std::lower_bound(used.begin(), used.end(), corner);
      corner = static_cast<std::uint32_t>(found - used.begin());
    }
    own.triangles.push_back(triangle);
    own.body.push_back(body);
    own.source.push_back(part.source[t]);
  }
  own.input_triangles = own.triangles.size();
  own.largest_coordinate = part.largest_coordinate;
  own.single_precision = part.single_precision;
  return own;
}

Part relative_to(Part part, const Vec3& origin) {
  for (Vec3& vertex : part.vertices) {
    vertex = vertex - origin;
    part.largest_coordinate = std::max(part.largest_coordinate, max_abs(vertex));
  }
  for (auto& [node, center, size] : part.missing_faces) {
    center = {center[0] - origin.x, center[1] - origin.y, center[2] - origin.z};
  }
  return part;
}

}  // namespace forcelayer::part
