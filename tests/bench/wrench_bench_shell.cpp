#include "tests/bench/wrench_bench_shell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <map>

namespace forcelayer::bench {
namespace {

using Polygon = std::vector<glm::dvec2>;

// The part of a convex polygon with n . x <= limit.
Polygon clip(const Polygon& polygon, const glm::dvec2& n, double limit) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double fa = glm::dot(n, a) - limit, fb = glm::dot(n, b) - limit;
    if (fa <= 0) kept.push_back(a);
    if ((fa < 0 && fb > 0) || (fa > 0 && fb < 0)) kept.push_back(a + (b - a) * (fa / (fa - fb)));
  }
  return kept;
}

double area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::max(twice / 2, 0.0);
}

struct FlatShell {
  std::vector<glm::dvec2> points;
  std::vector<double> areas;
};

// A convex region of the plane, or a strip that closes on itself along x.
struct Region {
  Polygon polygon;
  glm::dvec2 low, high;
  std::function<glm::dvec2(glm::dvec2)> nearest;  // projection on the region
  bool closes = false;
};

// The cells of the points nearest to each, clipped to the region: their areas.
void weigh(const Region& region, double reach, FlatShell& shell) {
  const double around = region.high.x - region.low.x;
  std::multimap<double, std::size_t> by_y;
  for (std::size_t i = 0; i < shell.points.size(); ++i) by_y.emplace(shell.points[i].y, i);
  for (const glm::dvec2& a : shell.points) {
    Polygon cell = region.polygon;
    if (region.closes) {
      cell = {{a.x - around / 2, region.low.y},
              {a.x + around / 2, region.low.y},
              {a.x + around / 2, region.high.y},
              {a.x - around / 2, region.high.y}};
    }
    const auto end = by_y.upper_bound(a.y + reach);
    for (auto it = by_y.lower_bound(a.y - reach); it != end; ++it) {
      glm::dvec2 b = shell.points[it->second];
      if (region.closes) b.x -= around * std::round((b.x - a.x) / around);
      if (b == a || std::abs(b.x - a.x) > reach) continue;
      cell = clip(cell, b - a, glm::dot(b - a, (a + b) * 0.5));
    }
    shell.areas.push_back(area(cell));
  }
}

// A triangular lattice of covering radius rho, its points projected on the convex region, which
// moves none away from what it covers. `step` is its spacing along x.
FlatShell cover(const Region& region, double rho, double step) {
  const double rise = rho + std::sqrt(std::max(0.0, rho * rho - step * step / 4));
  const double height = region.high.y - region.low.y;
  const int rows = static_cast<int>(std::ceil((height + 2 * rho) / rise)) + 1;
  const int columns = static_cast<int>(std::lround((region.high.x - region.low.x) / step));
  const double first = region.low.y + (height - (rows - 1) * rise) / 2;
  FlatShell shell;
  std::vector<glm::dvec2> projected;
  for (int j = 0; j < rows; ++j) {
    const int spill = region.closes ? 0 : 3;
    for (int i = -spill; i < columns + spill; ++i) {
      const glm::dvec2 at(region.low.x + (i + (j & 1) * 0.5) * step, first + j * rise);
      const glm::dvec2 on = region.nearest(at);
      if (glm::distance(on, at) > rho) continue;
      if (on != at) {  // only projected points can fall together
        const bool known = std::any_of(projected.begin(), projected.end(),
                                       [&](auto& p) { return glm::distance(p, on) < 1e-9; });
        if (known) continue;
        projected.push_back(on);
      }
      shell.points.push_back(on);
    }
  }
  weigh(region, 4.2 * rho, shell);
  return shell;
}

void finish(AnalyticShell& shell, double rho) {
  shell.covering_radius_m = rho;
  for (std::size_t i = 0; i < shell.points_m.size(); ++i) {
    shell.radius_m = std::max(shell.radius_m, glm::length(shell.points_m[i]));
    shell.area_m2 += shell.areas_m2[i];
  }
}

void add(AnalyticShell& shell, const glm::dvec3& point, const glm::dvec3& normal, double area_m2) {
  shell.points_m.push_back(point);
  shell.normals.push_back(normal);
  shell.areas_m2.push_back(area_m2);
}

// A disc about the origin: triangular lattice, exact areas but for the polygon of equal area that
// stands for the circle where cells are clipped.
FlatShell disc(double radius, double rho) {
  constexpr int kSides = 128;
  const double a = 2 * M_PI / kSides, corner = radius * std::sqrt(a / std::sin(a));
  const glm::dvec2 r(radius);
  Region region{
      {},
      -r,
      r,
      [=](glm::dvec2 p) { return glm::length(p) > radius ? p * (radius / glm::length(p)) : p; },
      false};
  for (int i = 0; i < kSides; ++i) {
    region.polygon.push_back(corner * glm::dvec2(std::cos(a * i), std::sin(a * i)));
  }
  return cover(region, rho, std::sqrt(3.0) * rho);
}

// The sector of a disc about the origin between the angles -half and half, at most a right one: the
// side of a cone, unrolled. Of its arc, a polygon of equal area.
FlatShell sector(double radius, double half, double rho) {
  constexpr int kSides = 128;
  const glm::dvec2 edge(std::cos(half), std::sin(half));
  const auto nearest = [=](glm::dvec2 p) {
    const glm::dvec2 q(p.x, std::abs(p.y));  // mirrored into the upper half
    glm::dvec2 on = q;
    if (glm::dot(glm::dvec2(-edge.y, edge.x), q) > 0) {  // beyond the straight edge
      on = std::clamp(glm::dot(q, edge), 0.0, radius) * edge;
    } else if (glm::length(q) > radius) {
      on = q * (radius / glm::length(q));
    }
    return glm::dvec2(on.x, p.y < 0 ? -on.y : on.y);
  };
  Region region{{{0, 0}}, {0, -radius * edge.y}, {radius, radius * edge.y}, nearest, false};
  const double a = 2 * half / kSides, corner = radius * std::sqrt(a / std::sin(a));
  for (int i = 0; i <= kSides; ++i) {
    const double angle = -half + a * i;
    region.polygon.push_back(corner * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return cover(region, rho, std::sqrt(3.0) * rho);
}

constexpr std::array<std::array<int, 3>, 20> kIcosahedron{
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

// Triangles of an icosahedron's faces, each edge in `parts`, on the unit sphere.
std::vector<std::array<glm::dvec3, 3>> sphere_triangles(int parts) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::array<glm::dvec3, 12> corner{{{-1, g, 0},
                                     {1, g, 0},
                                     {-1, -g, 0},
                                     {1, -g, 0},
                                     {0, -1, g},
                                     {0, 1, g},
                                     {0, -1, -g},
                                     {0, 1, -g},
                                     {g, 0, -1},
                                     {g, 0, 1},
                                     {-g, 0, -1},
                                     {-g, 0, 1}}};
  for (auto& c : corner) c = glm::normalize(c);
  const double edge = std::acos(glm::dot(corner[0], corner[11]));
  std::vector<std::array<glm::dvec3, 3>> triangles;
  for (const auto& face : kIcosahedron) {
    const auto at = [&](int i, int j) {
      const auto fraction = [&](int n) { return std::sin(edge * n / parts); };
      return glm::normalize(corner[face[0]] * fraction(parts - i - j) +
                            corner[face[1]] * fraction(i) + corner[face[2]] * fraction(j));
    };
    for (int i = 0; i < parts; ++i)
      for (int j = 0; i + j < parts; ++j) {
        triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < parts) {
          triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
      }
  }
  return triangles;
}

// How far the spherical triangle reaches from its corners: the pole of its circle, at the farthest.
double reach(const std::array<glm::dvec3, 3>& t) {
  const glm::dvec3 pole = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
  return glm::distance(glm::dot(pole, t[0]) < 0 ? -pole : pole, t[0]);
}

}  // namespace

AnalyticShell sphere_shell(double radius_m, double rho) {
  int parts = std::max(1, static_cast<int>(0.6 * radius_m / rho));
  std::vector<std::array<glm::dvec3, 3>> triangles;
  double largest = 2;
  for (; largest * radius_m > rho; ++parts) {
    triangles = sphere_triangles(parts);
    largest = 0;
    for (const auto& t : triangles) largest = std::max(largest, reach(t));
  }
  std::map<std::array<long, 3>, std::pair<glm::dvec3, double>> corners;
  double sum = 0;
  for (const auto& t : triangles) {
    const double third = glm::length(glm::cross(t[1] - t[0], t[2] - t[0])) / 6;
    for (const auto& c : t) {
      auto& known =
          corners[{std::lround(c.x * 1e7), std::lround(c.y * 1e7), std::lround(c.z * 1e7)}];
      known.first = c;
      known.second += third;
      sum += third;
    }
  }
  AnalyticShell shell;
  for (const auto& [key, c] : corners) {
    add(shell, c.first * radius_m, -c.first, c.second * 4 * M_PI * radius_m * radius_m / sum);
  }
  finish(shell, largest * radius_m);
  return shell;
}

AnalyticShell box_shell(const glm::dvec3& half, double rho) {
  AnalyticShell shell;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const glm::dvec2 h(half[u], half[v]);
    const Region face{{{-h.x, -h.y}, {h.x, -h.y}, {h.x, h.y}, {-h.x, h.y}},
                      -h,
                      h,
                      [h](glm::dvec2 p) { return glm::clamp(p, -h, h); },
                      false};
    const FlatShell flat = cover(face, rho, std::sqrt(3.0) * rho);
    for (const double side : {-1.0, 1.0})
      for (std::size_t i = 0; i < flat.points.size(); ++i) {
        glm::dvec3 point(0), normal(0);
        point[axis] = side * half[axis], point[u] = flat.points[i].x, point[v] = flat.points[i].y;
        normal[axis] = -side;
        add(shell, point, normal, flat.areas[i]);
      }
  }
  finish(shell, rho);
  return shell;
}

AnalyticShell cylinder_shell(double radius_m, double half_length_m, double rho) {
  AnalyticShell shell;
  const double around = 2 * M_PI * radius_m;
  const Region side{
      {},
      {0, -half_length_m},
      {around, half_length_m},
      [=](glm::dvec2 p) { return glm::dvec2(p.x, std::clamp(p.y, -half_length_m, half_length_m)); },
      true};
  const FlatShell rolled = cover(side, rho, around / std::ceil(around / (std::sqrt(3.0) * rho)));
  for (std::size_t i = 0; i < rolled.points.size(); ++i) {
    const double a = rolled.points[i].x / radius_m;
    const glm::dvec3 out(std::cos(a), std::sin(a), 0);
    add(shell, out * radius_m + glm::dvec3(0, 0, rolled.points[i].y), -out, rolled.areas[i]);
  }
  const FlatShell flat = disc(radius_m, rho);
  for (const double end : {-1.0, 1.0})
    for (std::size_t i = 0; i < flat.points.size(); ++i) {
      add(shell, {flat.points[i].x, flat.points[i].y, end * half_length_m}, {0, 0, -end},
          flat.areas[i]);
    }
  finish(shell, rho);
  return shell;
}

AnalyticShell cone_shell(double radius_m, double height_m, double rho) {
  AnalyticShell shell;
  const double slant = std::hypot(radius_m, height_m), base = -height_m / 4;
  const double half = M_PI * radius_m / slant;  // of the unrolled side's angle
  // Unrolling only lengthens chords: what is covered in the plane is covered on the cone.
  const FlatShell side = sector(slant, half, rho);
  for (std::size_t i = 0; i < side.points.size(); ++i) {
    const double from_tip = glm::length(side.points[i]);
    const double turn = std::atan2(side.points[i].y, side.points[i].x) * slant / radius_m;
    const glm::dvec3 out(std::cos(turn), std::sin(turn), 0);
    add(shell,
        out * (from_tip * radius_m / slant) +
            glm::dvec3(0, 0, base + height_m * (1 - from_tip / slant)),
        -(out * height_m + glm::dvec3(0, 0, radius_m)) / slant, side.areas[i]);
  }
  const FlatShell flat = disc(radius_m, rho);
  for (std::size_t i = 0; i < flat.points.size(); ++i) {
    add(shell, {flat.points[i].x, flat.points[i].y, base}, {0, 0, 1}, flat.areas[i]);
  }
  finish(shell, rho);
  return shell;
}

// Rings of points, each the middle of a cell. A point of the cell whose distance from the axis is
// a, at angles du and dv from the cell's middle (distance b), lies within sqrt((tube dv)^2 + a b
// du^2) of it: a chord is shorter than its arc.
AnalyticShell torus_shell(double ring_m, double tube_m, double rho) {
  AnalyticShell shell;
  const int rings = static_cast<int>(std::ceil(M_PI * tube_m * std::sqrt(2.0) / rho));
  const double dv = 2 * M_PI / rings;
  for (int j = 0; j < rings; ++j) {
    const double v = j * dv, b = ring_m + tube_m * std::cos(v);
    // The farthest from the axis that the cell reaches.
    const double nearest_v = std::clamp(0.0, std::min(v, 2 * M_PI - v) - dv / 2, M_PI);
    const double a = ring_m + tube_m * std::cos(nearest_v);
    const double half_v = tube_m * dv / 2;
    const double half_u = std::sqrt((rho * rho - half_v * half_v) / (a * b));
    const int points = static_cast<int>(std::ceil(M_PI / half_u));
    const double du = 2 * M_PI / points;
    const double area =
        du * tube_m * (ring_m * dv + tube_m * (std::sin(v + dv / 2) - std::sin(v - dv / 2)));
    for (int i = 0; i < points; ++i) {
      const double u = (i + 0.5 * (j & 1)) * du;
      const glm::dvec3 radial(std::cos(u), std::sin(u), 0);
      const glm::dvec3 out = std::cos(v) * radial + glm::dvec3(0, 0, std::sin(v));
      add(shell, ring_m * radial + tube_m * out, -out, area);
    }
  }
  finish(shell, rho);
  return shell;
}

}  // namespace forcelayer::bench
