#include "voxelize/sweep/motion_center.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <vector>

namespace forcelayer::sweep {
namespace {

using mesh::Vec3d;

Vec3d minus(const Vec3d& a, const Vec3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

struct Box {
  Vec3d low{}, high{};
  bool is_empty = true;

  void grow(const Vec3d& p) {
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = is_empty ? p[d] : std::min(low[d], p[d]);
      high[d] = is_empty ? p[d] : std::max(high[d], p[d]);
    }
    is_empty = false;
  }
  Vec3d middle() const {
    return {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};
  }
  double diagonal() const { return length(minus(high, low)); }
  bool holds(const Vec3d& p) const {
    for (std::size_t d = 0; d < 3; ++d) {
      if (!(p[d] >= low[d] && p[d] <= high[d])) return false;
    }
    return true;
  }
};

Box box_of(const mesh::Mesh& part) {
  Box box;
  for (const mesh::Triangle& corners : part.triangles) {
    for (const std::uint32_t corner : corners) box.grow(part.vertices[corner]);
  }
  return box;
}

// Sets of triangles that are joined over edges.
class Components {
 public:
  explicit Components(std::size_t triangles) : parent_(triangles) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t t) {
    while (parent_[t] != t) t = parent_[t] = parent_[parent_[t]];
    return t;
  }
  void join(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parent_;
};

enum class Form {
  kUnclear,
  kOutward,  // closed surfaces whose triangles all face outward
  kInward,   // the same the other way round
  kSheets,   // surfaces that all have a border
};

// Surfaces in which each edge has at most two triangles, in opposite directions where a surface is
// closed, and a volume that is more than rounding.
Form form_of(const mesh::Mesh& part) {
  std::map<Vec3d, std::uint32_t> number_of;
  std::vector<std::uint32_t> merged;
  merged.reserve(part.vertices.size());
  for (const auto& [x, y, z] : part.vertices) {
    const Vec3d place{x + 0.0, y + 0.0, z + 0.0};  // -0 becomes +0
    merged.push_back(
        number_of.emplace(place, static_cast<std::uint32_t>(number_of.size())).first->second);
  }
  struct Side {
    std::uint32_t low, high;
    std::size_t triangle;
    bool is_forward;
  };
  std::vector<Side> sides;
  // A triangle with two corners at one position has no area, and its two sides cancel.
  const auto is_line = [&](const mesh::Triangle& t) {
    return merged[t[0]] == merged[t[1]] || merged[t[1]] == merged[t[2]] ||
           merged[t[2]] == merged[t[0]];
  };
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    if (is_line(part.triangles[t])) continue;
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t from = merged[part.triangles[t][n]],
                          to = merged[part.triangles[t][(n + 1) % 3]];
      sides.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  });
  const auto is_same_edge = [](const Side& a, const Side& b) {
    return a.low == b.low && a.high == b.high;
  };
  Components components(part.triangles.size());
  std::vector<std::size_t> at_border, at_twist;  // triangles
  for (std::size_t n = 0; n < sides.size();) {
    std::size_t end = n + 1;
    while (end < sides.size() && is_same_edge(sides[n], sides[end])) ++end;
    if (end - n > 2) return Form::kUnclear;
    if (end - n == 1) {
      at_border.push_back(sides[n].triangle);
    } else {
      components.join(sides[n].triangle, sides[n + 1].triangle);
      if (sides[n].is_forward == sides[n + 1].is_forward) at_twist.push_back(sides[n].triangle);
    }
    n = end;
  }
  struct Surface {
    bool has_border = false;
    double volume = 0, area = 0;
    Vec3d origin{};
  };
  std::map<std::size_t, Surface> surfaces;
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    if (is_line(part.triangles[t])) continue;
    const auto& [na, nb, nc] = part.triangles[t];
    const auto [found, is_new] = surfaces.try_emplace(components.find(t));
    Surface& surface = found->second;
    if (is_new) surface.origin = part.vertices[na];
    const Vec3d a = minus(part.vertices[na], surface.origin),
                b = minus(part.vertices[nb], surface.origin),
                c = minus(part.vertices[nc], surface.origin);
    surface.volume += dot(a, cross(b, c)) / 6;
    surface.area += length(cross(minus(b, a), minus(c, a))) / 2;
  }
  for (const std::size_t t : at_border) surfaces.at(components.find(t)).has_border = true;
  std::array<std::size_t, 4> count{};  // [Form]
  for (const auto& [component, surface] : surfaces) {
    const double rounding = 1e-9 * std::pow(surface.area, 1.5);
    const Form form = surface.has_border           ? Form::kSheets
                      : surface.volume > rounding  ? Form::kOutward
                      : surface.volume < -rounding ? Form::kInward
                                                   : Form::kUnclear;
    ++count[static_cast<std::size_t>(form)];
  }
  for (const Form form : {Form::kOutward, Form::kInward, Form::kSheets}) {
    const bool is_form = count[static_cast<std::size_t>(form)] == surfaces.size();
    if (is_form && (form == Form::kSheets || at_twist.empty())) return form;
  }
  return Form::kUnclear;
}

// pointshell counts objects with the same triangles as one. Their boxes are the same, up to the
// rounding of a transform.
bool are_distinct(std::span<const Box> boxes) {
  std::vector<std::size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return boxes[a].low[0] < boxes[b].low[0]; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Box& box = boxes[order[i]];
    const double near = 1e-6 * box.diagonal();
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Box& other = boxes[order[j]];
      if (other.low[0] - box.low[0] > near) break;
      if (length(minus(other.low, box.low)) <= near && length(minus(other.high, box.high)) <= near)
        return false;
    }
  }
  return true;
}

// The centroid of the volume. Not where pointshell may find that the moments are those of no mass,
// as those of a surface that crosses itself, and takes the area: this test is a little stricter.
bool find_volume_center(std::span<const mesh::Mesh> parts, std::span<const Form> forms,
                        const Box& box, Vec3d& center) {
  const Vec3d origin = box.middle();
  double volume = 0, area = 0;
  Vec3d first{};
  double second[3][3]{};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double sign = forms[i] == Form::kInward ? -1 : 1;
    for (const mesh::Triangle& t : parts[i].triangles) {
      const Vec3d a = minus(parts[i].vertices[t[0]], origin),
                  b = minus(parts[i].vertices[t[1]], origin),
                  c = minus(parts[i].vertices[t[2]], origin);
      const double piece = sign * dot(a, cross(b, c)) / 6;
      volume += piece;
      area += length(cross(minus(b, a), minus(c, a))) / 2;
      for (std::size_t d = 0; d < 3; ++d) {
        first[d] += piece * (a[d] + b[d] + c[d]) / 4;
        // The mean of x x^T over a tetrahedron with a corner at 0.
        for (std::size_t e = 0; e < 3; ++e) {
          second[d][e] += piece / 20 *
                          (a[d] * a[e] + b[d] * b[e] + c[d] * c[e] +
                           (a[d] + b[d] + c[d]) * (a[e] + b[e] + c[e]));
        }
      }
    }
  }
  if (!(volume > 2e-9 * std::pow(area, 1.5))) return false;
  double m[3][3];
  for (std::size_t d = 0; d < 3; ++d) {
    for (std::size_t e = 0; e < 3; ++e) {
      m[d][e] = second[d][e] / volume - first[d] / volume * (first[e] / volume);
    }
    center[d] = origin[d] + first[d] / volume;
  }
  const double size = std::abs(m[0][0]) + std::abs(m[1][1]) + std::abs(m[2][2]);
  const double rounding = 0.5e-12 * size;
  const auto minor = [&](int d, int e) { return m[d][d] * m[e][e] - m[d][e] * m[d][e]; };
  const double determinant = m[0][0] * minor(1, 2) -
                             m[0][1] * (m[0][1] * m[2][2] - m[1][2] * m[0][2]) +
                             m[0][2] * (m[0][1] * m[1][2] - m[1][1] * m[0][2]);
  return box.holds(center) && std::min({m[0][0], m[1][1], m[2][2]}) >= -rounding &&
         std::min({minor(0, 1), minor(0, 2), minor(1, 2)}) >= -rounding * size &&
         determinant >= -rounding * size * size;
}

Vec3d area_center(const mesh::Mesh& part, const Vec3d& origin) {
  double area = 0;
  Vec3d first{};
  for (const mesh::Triangle& t : part.triangles) {
    const Vec3d a = minus(part.vertices[t[0]], origin), b = minus(part.vertices[t[1]], origin),
                c = minus(part.vertices[t[2]], origin);
    const double face = length(cross(minus(b, a), minus(c, a))) / 2;
    area += face;
    for (std::size_t d = 0; d < 3; ++d) first[d] += face * (a[d] + b[d] + c[d]) / 3;
  }
  if (!(area > 0)) return origin;
  return {origin[0] + first[0] / area, origin[1] + first[1] / area, origin[2] + first[2] / area};
}

}  // namespace

MotionCenter motion_center(std::span<const mesh::Mesh> parts) {
  std::vector<Form> forms;
  std::vector<Box> boxes;  // of the objects that have triangles
  Box box;
  for (const mesh::Mesh& part : parts) {
    forms.push_back(form_of(part));
    const Box own = box_of(part);
    if (own.is_empty) continue;
    boxes.push_back(own);
    box.grow(own.low);
    box.grow(own.high);
  }
  const bool is_solid = std::all_of(forms.begin(), forms.end(), [](Form form) {
    return form == Form::kOutward || form == Form::kInward;
  });
  mesh::Vec3d of_volume_m{};
  if (is_solid && are_distinct(boxes) && find_volume_center(parts, forms, box, of_volume_m)) {
    return {of_volume_m, 0};
  }
  const auto sheets = std::find(forms.begin(), forms.end(), Form::kSheets);
  if (boxes.size() == 1 && sheets != forms.end()) {
    const auto i = static_cast<std::size_t>(sheets - forms.begin());
    return {area_center(parts[i], box.middle()), 0};
  }
  return {box.middle(), box.diagonal() / 2};
}

}  // namespace forcelayer::sweep
