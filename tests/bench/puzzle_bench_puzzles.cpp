#include "tests/bench/puzzle_bench_puzzles.h"

#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "tests/stress/shapes.h"

namespace forcelayer::bench {
namespace {

using mesh::Mesh;
using stress::append;
using stress::box;

constexpr int kSegments = 24;  // around round parts

Pose at(double x, double y, double z) { return {{x, y, z}, {1, 0, 0, 0}}; }

Mesh empty() {
  Mesh mesh;
  mesh.single_precision = false;
  return mesh;
}

void add_box(Mesh& mesh, const glm::dvec3& low, const glm::dvec3& high) {
  const glm::dvec3 middle = (low + high) * 0.5;
  append(mesh, box((high - low) * 0.5), at(middle.x, middle.y, middle.z));
}

// A round wire along a polyline, flat at its ends.
Mesh wire(const std::vector<glm::dvec3>& line, double radius_m) {
  Mesh mesh = empty();
  const std::size_t count = line.size();
  glm::dvec3 side(0.3, 0.2, 0.9);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 along =
        glm::normalize(line[std::min(i + 1, count - 1)] - line[i == 0 ? 0 : i - 1]);
    side = glm::normalize(side - glm::dot(side, along) * along);
    const glm::dvec3 up = glm::cross(along, side);
    for (int n = 0; n < kSegments; ++n) {
      const double angle = 2 * M_PI * n / kSegments;
      const glm::dvec3 p = line[i] + radius_m * (std::cos(angle) * side + std::sin(angle) * up);
      mesh.vertices.push_back({p.x, p.y, p.z});
    }
  }
  const auto vertex = [](std::size_t ring, int n) {
    return static_cast<std::uint32_t>(ring * kSegments + static_cast<std::size_t>(n % kSegments));
  };
  for (std::size_t i = 0; i + 1 < count; ++i) {
    for (int n = 0; n < kSegments; ++n) {
      mesh.triangles.push_back({vertex(i, n), vertex(i, n + 1), vertex(i + 1, n)});
      mesh.triangles.push_back({vertex(i, n + 1), vertex(i + 1, n + 1), vertex(i + 1, n)});
    }
  }
  for (int n = 1; n + 1 < kSegments; ++n) {
    mesh.triangles.push_back({vertex(0, 0), vertex(0, n + 1), vertex(0, n)});
    mesh.triangles.push_back(
        {vertex(count - 1, 0), vertex(count - 1, n), vertex(count - 1, n + 1)});
  }
  return mesh;
}

// A quarter of a circle and two legs.
Mesh bent_peg() {
  std::vector<glm::dvec3> line{{0, 0, 0.04}};
  for (int n = 0; n <= 8; ++n) {
    const double angle = M_PI / 2 * n / 8;
    line.push_back({0.01 - 0.01 * std::cos(angle), 0, -0.01 * std::sin(angle)});
  }
  line.push_back({0.04, 0, -0.01});
  return wire(line, 0.004);
}

// Its upper leg stands in the hole of a plate, the lower one lies in a box under it. Its bend
// passes the hole along a diagonal alone, half a turn up, with 1.1 mm to either side.
Puzzle peg_with_bend() {
  Mesh scene = empty();
  const double half = 0.008, out = 0.06, low = -0.004 + 0.006, high = 0.022;
  add_box(scene, {-out, -out, low}, {-half, out, high});
  add_box(scene, {half, -out, low}, {out, out, high});
  add_box(scene, {-half, -out, low}, {half, -half, high});
  add_box(scene, {-half, half, low}, {half, out, high});
  add_box(scene, {-out, -out, -0.07}, {out, out, -0.06});
  for (const double side : {-1.0, 1.0}) {
    const double a = side < 0 ? -out : out - 0.005, b = side < 0 ? -out + 0.005 : out;
    add_box(scene, {a, -out, -0.06}, {b, out, low});
    add_box(scene, {-out + 0.005, a, -0.06}, {out - 0.005, b, low});
  }
  return {"peg with a bend", scene, bent_peg(), at(0, 0, -0.003), 0.0011};
}

// A hook of three plates hangs around a beam, close before a wall.
Puzzle bracket_behind_beam() {
  Mesh scene = empty(), hook = empty();
  add_box(scene, {-0.01, -0.1, -0.08}, {0, 0.1, 0.08});       // wall
  add_box(scene, {0.014, -0.1, -0.012}, {0.03, 0.1, 0.012});  // beam
  add_box(scene, {0, -0.11, -0.08}, {0.05, -0.1, 0.08});      // its posts
  add_box(scene, {0, 0.1, -0.08}, {0.05, 0.11, 0.08});
  add_box(scene, {0, -0.1, 0.0625}, {0.03, 0.1, 0.07});        // a shelf above
  add_box(hook, {0.004, -0.02, -0.02}, {0.009, 0.02, 0.025});  // behind the beam
  add_box(hook, {0.009, -0.02, 0.02}, {0.036, 0.02, 0.025});   // above it
  add_box(hook, {0.036, -0.02, -0.02}, {0.041, 0.02, 0.025});  // before it
  return {"bracket behind a beam", scene, hook, at(0, 0, 0), 0.0045};
}

// Holes a millimeter and a half wider than the bolt, and a roof that leaves it no way straight out.
Puzzle bolt_through_plates() {
  Mesh scene = empty();
  for (const double z : {-0.02, 0.0, 0.02}) {
    append(scene, stress::tube(0.0055, 0.04, 0.002, 4 * kSegments), at(0, 0, z));
  }
  add_box(scene, {-0.04, -0.04, 0.09}, {0.04, 0.04, 0.095});
  const std::vector<glm::dvec2> profile{{0, -0.03},     {0.004, -0.03}, {0.004, 0.026},
                                        {0.008, 0.026}, {0.008, 0.032}, {0, 0.032}};
  return {"bolt through three plates", scene, stress::revolved(profile, 2 * kSegments), at(0, 0, 0),
          0.0015};
}

// A ring of wire that is a full turn and more, its ends one above the other with a gap between.
std::vector<glm::dvec3> alpha_line(double radius_m, double rise_m) {
  std::vector<glm::dvec3> line;
  const int steps = 72;
  const double first = -M_PI * 1.15, last = M_PI * 1.15;
  const double per_rad = rise_m / (2 * M_PI);
  const auto on_ring = [&](double angle) {
    return glm::dvec3(radius_m * std::cos(angle), radius_m * std::sin(angle), per_rad * angle);
  };
  const glm::dvec3 before = glm::normalize(on_ring(first) - on_ring(first + 0.02));
  const glm::dvec3 behind = glm::normalize(on_ring(last) - on_ring(last - 0.02));
  line.push_back(on_ring(first) + before * (0.8 * radius_m));
  for (int n = 0; n <= steps; ++n) line.push_back(on_ring(first + (last - first) * n / steps));
  line.push_back(on_ring(last) + behind * (0.8 * radius_m));
  return line;
}

// The wire of one leads through the ring of the other. `scale`: of the gap between the legs, in
// diameters of the wire.
Puzzle alpha(double scale) {
  const double wire_m = 0.003, ring_m = 0.025;
  const Mesh piece = wire(alpha_line(ring_m, 2 * wire_m * (1 + scale)), wire_m);
  char name[40];
  std::snprintf(name, sizeof name, "alpha, gap %.1f", scale);
  const glm::dquat turned =
      glm::angleAxis(M_PI / 2, glm::dvec3(1, 0, 0)) * glm::angleAxis(M_PI, glm::dvec3(0, 0, 1));
  return {name, piece, piece, {{ring_m, 0, 0}, turned}, wire_m * (scale - 1)};
}

}  // namespace

std::vector<Puzzle> puzzles() {
  return {peg_with_bend(), bracket_behind_beam(), bolt_through_plates(), alpha(3.0), alpha(2.4),
          alpha(1.8)};
}

}  // namespace forcelayer::bench
