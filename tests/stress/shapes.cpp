#include "tests/stress/shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace forcelayer::stress {
namespace {

std::uint32_t add_vertex(mesh::Mesh& mesh, const glm::dvec3& p) {
  mesh.vertices.push_back({p.x, p.y, p.z});
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

void add_quad(mesh::Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
              std::uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

// Drops triangles with two equal corners in space: where a profile touches the axis.
void drop_degenerate(mesh::Mesh& mesh) {
  std::erase_if(mesh.triangles, [&](const mesh::Triangle& t) {
    const auto& v = mesh.vertices;
    return v[t[0]] == v[t[1]] || v[t[1]] == v[t[2]] || v[t[2]] == v[t[0]];
  });
}

mesh::Mesh empty_mesh() {
  mesh::Mesh mesh;
  mesh.single_precision = false;
  return mesh;
}

}  // namespace

void append(mesh::Mesh& mesh, const mesh::Mesh& other, const Pose& pose) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const mesh::Vec3d& v : other.vertices) {
    add_vertex(mesh, pose.orientation * glm::dvec3(v[0], v[1], v[2]) + pose.position_m);
  }
  for (const mesh::Triangle& t : other.triangles) {
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  mesh.single_precision = false;
}

mesh::Mesh box(const glm::dvec3& half_m) {
  mesh::Mesh mesh = empty_mesh();
  for (int corner = 0; corner < 8; ++corner) {
    add_vertex(mesh, {corner & 4 ? half_m.x : -half_m.x, corner & 2 ? half_m.y : -half_m.y,
                      corner & 1 ? half_m.z : -half_m.z});
  }
  add_quad(mesh, 0, 1, 3, 2);
  add_quad(mesh, 4, 6, 7, 5);
  add_quad(mesh, 0, 4, 5, 1);
  add_quad(mesh, 2, 3, 7, 6);
  add_quad(mesh, 0, 2, 6, 4);
  add_quad(mesh, 1, 5, 7, 3);
  return mesh;
}

mesh::Mesh sheet(double half_x_m, double half_y_m) {
  mesh::Mesh mesh = empty_mesh();
  add_vertex(mesh, {-half_x_m, -half_y_m, 0});
  add_vertex(mesh, {half_x_m, -half_y_m, 0});
  add_vertex(mesh, {half_x_m, half_y_m, 0});
  add_vertex(mesh, {-half_x_m, half_y_m, 0});
  add_quad(mesh, 0, 1, 2, 3);
  return mesh;
}

mesh::Mesh revolved(const std::vector<glm::dvec2>& profile_m, int segments) {
  mesh::Mesh mesh = empty_mesh();
  const auto rings = static_cast<std::uint32_t>(profile_m.size());
  for (int i = 0; i < segments; ++i) {
    const double angle = 2 * M_PI * i / segments;
    for (const glm::dvec2& p : profile_m) {
      // On the axis all segments share one place, to the last bit.
      const double radius = p.x;
      add_vertex(mesh, radius == 0
                           ? glm::dvec3(0, 0, p.y)
                           : glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), p.y));
    }
  }
  for (int i = 0; i < segments; ++i) {
    const auto here = static_cast<std::uint32_t>(i) * rings;
    const auto next = static_cast<std::uint32_t>((i + 1) % segments) * rings;
    for (std::uint32_t k = 0; k < rings; ++k) {
      const std::uint32_t l = (k + 1) % rings;
      add_quad(mesh, here + k, next + k, next + l, here + l);
    }
  }
  drop_degenerate(mesh);
  return mesh;
}

mesh::Mesh sphere(double radius_m, int segments) {
  std::vector<glm::dvec2> profile;
  const int rings = std::max(3, segments / 2);
  for (int i = 0; i <= rings; ++i) {
    const double angle = M_PI * (static_cast<double>(i) / rings - 0.5);
    const bool pole = i == 0 || i == rings;
    profile.push_back({pole ? 0 : radius_m * std::cos(angle), radius_m * std::sin(angle)});
  }
  return revolved(profile, segments);
}

mesh::Mesh cylinder(double radius_m, double half_height_m, int segments) {
  return revolved({{0, -half_height_m},
                   {radius_m, -half_height_m},
                   {radius_m, half_height_m},
                   {0, half_height_m}},
                  segments);
}

mesh::Mesh tube(double inner_m, double outer_m, double half_height_m, int segments) {
  return revolved({{inner_m, -half_height_m},
                   {outer_m, -half_height_m},
                   {outer_m, half_height_m},
                   {inner_m, half_height_m}},
                  segments);
}

mesh::Mesh prism(const std::vector<glm::dvec2>& polygon_m, double half_width_m) {
  mesh::Mesh mesh = empty_mesh();
  const auto corners = static_cast<std::uint32_t>(polygon_m.size());
  for (const glm::dvec2& p : polygon_m) {
    add_vertex(mesh, {p.x, -half_width_m, p.y});
    add_vertex(mesh, {p.x, half_width_m, p.y});
  }
  for (std::uint32_t k = 0; k < corners; ++k) {
    const std::uint32_t l = (k + 1) % corners;
    add_quad(mesh, 2 * k, 2 * k + 1, 2 * l + 1, 2 * l);
  }
  for (std::uint32_t k = 1; k + 1 < corners; ++k) {
    mesh.triangles.push_back({0, 2 * k, 2 * (k + 1)});
    mesh.triangles.push_back({1, 2 * (k + 1) + 1, 2 * k + 1});
  }
  return mesh;
}

mesh::Mesh thread(double radius_m, double depth_m, double pitch_m, double turns,
                  int segments_per_turn) {
  mesh::Mesh mesh = empty_mesh();
  const int segments = static_cast<int>(std::lround(turns * segments_per_turn));
  for (int i = 0; i <= segments; ++i) {
    const double angle = 2 * M_PI * i / segments_per_turn;
    const double height = pitch_m * (static_cast<double>(i) / segments_per_turn - turns / 2);
    const glm::dvec3 out(std::cos(angle), std::sin(angle), 0);
    add_vertex(mesh, out * radius_m + glm::dvec3(0, 0, height - pitch_m / 4));
    add_vertex(mesh, out * (radius_m + depth_m) + glm::dvec3(0, 0, height));
    add_vertex(mesh, out * radius_m + glm::dvec3(0, 0, height + pitch_m / 4));
  }
  for (int i = 0; i < segments; ++i) {
    const auto here = static_cast<std::uint32_t>(3 * i), next = here + 3;
    const bool outwards = depth_m > 0;
    for (std::uint32_t k = 0; k < 2; ++k) {
      if (outwards)
        add_quad(mesh, here + k, next + k, next + k + 1, here + k + 1);
      else
        add_quad(mesh, here + k, here + k + 1, next + k + 1, next + k);
    }
  }
  return mesh;
}

double radius_m(const mesh::Mesh& mesh) {
  double largest = 0;
  for (const mesh::Vec3d& v : mesh.vertices) {
    largest = std::max(largest, glm::length(glm::dvec3(v[0], v[1], v[2])));
  }
  return largest;
}

}  // namespace forcelayer::stress
