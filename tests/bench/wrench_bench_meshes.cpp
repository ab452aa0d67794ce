#include "tests/bench/wrench_bench_meshes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <utility>

#include "tests/bench/wrench_bench_contacts.h"
#include "tests/stress/shapes.h"

namespace forcelayer::bench {
namespace {

constexpr double kReachM = 0.5;

// Segments of a circle whose chords are at most that far inside it.
int segments_of(double radius_m, double deviation_m) {
  if (radius_m <= deviation_m) return 12;
  return std::max(12, static_cast<int>(std::ceil(M_PI / std::acos(1 - deviation_m / radius_m))));
}

// A strip along y over a line of points in the xz plane, the side facing `front`.
mesh::Mesh strip(const std::vector<glm::dvec3>& line_m, const glm::dvec3& front) {
  mesh::Mesh mesh;
  mesh.single_precision = false;
  for (const glm::dvec3& p : line_m) {
    mesh.vertices.push_back({p.x, -kReachM, p.z});
    mesh.vertices.push_back({p.x, kReachM, p.z});
  }
  const glm::dvec3 along = line_m[1] - line_m[0];
  const bool turned = glm::dot(glm::cross(along, glm::dvec3(0, 1, 0)), front) < 0;
  for (std::uint32_t i = 0; i + 2 < mesh.vertices.size(); i += 2) {
    std::array<mesh::Triangle, 2> quad = {mesh::Triangle{i, i + 2, i + 3},
                                          mesh::Triangle{i, i + 3, i + 1}};
    for (mesh::Triangle& t : quad) {
      if (turned) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

mesh::Mesh wedge_mesh(const AnalyticStatic& body, double offset_m, double deviation_m) {
  const double a = body.free_angle / 2, cosine = std::cos(a), sine = std::sin(a);
  const glm::dvec3 n0(-cosine, 0, sine), n1(cosine, 0, sine);
  const glm::dvec3 along0(sine, 0, cosine), along1(-sine, 0, cosine);
  std::vector<glm::dvec3> line;
  if (body.free_angle < M_PI) {
    // The corner lies where both walls have their own offset.
    const double o0 = offset_m - body.wall_shift_m[0], o1 = offset_m - body.wall_shift_m[1];
    const glm::dvec3 corner((o1 - o0) / (2 * cosine), 0, (o0 + o1) / (2 * sine));
    line = {corner + kReachM * along0, corner, corner + kReachM * along1};
  } else {
    line.push_back(offset_m * n0 + kReachM * along0);
    const double half_turn = a - M_PI / 2;  // of the normals, about +z
    const int steps = segments_of(offset_m, deviation_m);
    for (int i = 0; i <= steps; ++i) {
      const double angle = half_turn * (1 - 2.0 * i / steps);
      line.push_back(offset_m * glm::dvec3(std::sin(angle), 0, std::cos(angle)));
    }
    line.push_back(offset_m * n1 + kReachM * along1);
  }
  return strip(line, n0);
}

}  // namespace

mesh::Mesh part_mesh(Part part, double deviation_m) {
  if (part == Part::kBox) return stress::box(kBoxHalfM);
  if (part == Part::kCone) {
    const double low = -kConeHeightM / 4;
    return stress::revolved({{0, low}, {kConeRadiusM, low}, {0, low + kConeHeightM}},
                            segments_of(kConeRadiusM, deviation_m));
  }
  if (part == Part::kTorus) {
    const int around = segments_of(kTorusTubeM, deviation_m);
    std::vector<glm::dvec2> circle;
    for (int i = 0; i < around; ++i) {
      const double v = 2 * M_PI * i / around;
      circle.push_back({kTorusRingM + kTorusTubeM * std::cos(v), kTorusTubeM * std::sin(v)});
    }
    return stress::revolved(circle, segments_of(kTorusRingM + kTorusTubeM, deviation_m));
  }
  const double radius_m = part == Part::kSphere ? kSphereRadiusM : kCylinderRadiusM;
  const int segments = segments_of(radius_m, deviation_m);
  if (part == Part::kSphere) return stress::sphere(radius_m, segments);
  return stress::cylinder(radius_m, kCylinderHalfM, segments);
}

mesh::Mesh offset_mesh(const AnalyticStatic& body, double offset_m, double deviation_m) {
  mesh::Mesh local;
  switch (body.kind) {
    case StaticKind::kPlane: {
      const Pose raised{{0, 0, offset_m}, {1, 0, 0, 0}};
      stress::append(local, stress::sheet(kReachM, kReachM), raised);
      break;
    }
    case StaticKind::kSphere:
      local = stress::sphere(body.radius_m + offset_m,
                             segments_of(body.radius_m + offset_m, deviation_m));
      break;
    case StaticKind::kBore: {
      const double inner_m = body.radius_m - offset_m;
      local = stress::tube(inner_m, inner_m + kReachM, kReachM, segments_of(inner_m, deviation_m));
      break;
    }
    case StaticKind::kWedge:
      local = wedge_mesh(body, offset_m, deviation_m);
      break;
  }
  mesh::Mesh world;
  stress::append(world, local, {body.origin_m, glm::quat_cast(body.rotation)});
  return world;
}

}  // namespace forcelayer::bench
