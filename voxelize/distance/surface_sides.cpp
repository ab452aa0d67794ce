#include "voxelize/distance/surface_sides.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>

namespace forcelayer::distance {
namespace {

__extension__ typedef __int128 Int128;
__extension__ typedef unsigned __int128 UInt128;

using lattice::LatticePoint;
using lattice::LatticeTriangle;

// Differences of coordinates below 2^41 have products of three that Int128 holds.
constexpr std::int64_t kMaxVoxels = std::int64_t{1} << 30;
// And those up to 2^20 have products of three that 64 bits hold.
constexpr std::int64_t kNarrowVoxels = std::int64_t{1} << 10;

struct Component {
  std::uint64_t open = 0;    // a sum of hashes of edges; 0: each is run along both ways
  UInt128 volume_6 = 0;      // six times the volume; the sum is exact, although its parts may wrap
  std::uint32_t corner = 0;  // a vertex
  int side = 0;              // 1: outside is where the normals point; -1: reversed; 0: open

  Int128 volume() const { return static_cast<Int128>(volume_6); }
  Int128 size() const { return volume() < 0 ? -volume() : volume(); }
  bool is_closed() const { return open == 0 && volume_6 != 0; }
};

std::uint64_t mixed(std::uint64_t h) {
  h ^= h >> 32;
  h *= 0xd6e8feb86659fd93;
  h ^= h >> 32;
  h *= 0xd6e8feb86659fd93;
  return h ^ h >> 32;
}

// Six times the volume that a triangle spans with the origin.
template <class Int>
Int volume_6(const std::array<std::array<std::int64_t, 3>, 3>& t) {
  const auto minor = [&](std::size_t u, std::size_t w) {
    return Int{t[1][u]} * t[2][w] - Int{t[1][w]} * t[2][u];
  };
  return t[0][0] * minor(1, 2) + t[0][1] * minor(2, 0) + t[0][2] * minor(0, 1);
}

std::array<std::array<std::int64_t, 3>, 3> relative(const LatticeTriangle& triangle,
                                                    const LatticePoint& origin) {
  std::array<std::array<std::int64_t, 3>, 3> from;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) from[k][d] = triangle[k][d] - origin[d];
  }
  return from;
}

// The components of an object.
class Components {
 public:
  explicit Components(const scan::SnappedObject& object) : object_(object) {
    corners_.resize(object.vertices.size());
    std::iota(corners_.begin(), corners_.end(), 0u);
    find();
    if (std::all_of(list_.begin(), list_.end(), [](const Component& c) { return c.open == 0; })) {
      return;
    }
    weld_open();
    find();
  }

  std::vector<Component>& list() { return list_; }
  std::uint32_t of(const mesh::Triangle& triangle) { return numbers_[root(corners_[triangle[0]])]; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  std::uint32_t root(std::uint32_t corner) {
    while (parents_[corner] != corner) {
      parents_[corner] = parents_[parents_[corner]];
      corner = parents_[corner];
    }
    return corner;
  }

  void join(const mesh::Triangle& triangle) {
    const std::uint32_t a = root(corners_[triangle[0]]), b = root(corners_[triangle[1]]),
                        c = root(corners_[triangle[2]]);
    const std::uint32_t first = std::min({a, b, c});
    parents_[a] = parents_[b] = parents_[c] = first;
  }

  void find() {
    parents_.resize(corners_.size());
    std::iota(parents_.begin(), parents_.end(), 0u);
    for (const mesh::Triangle& triangle : object_.triangles) join(triangle);
    list_.clear();
    numbers_.assign(corners_.size(), kNone);
    LatticePoint origin;
    bool is_narrow = true;
    for (std::size_t d = 0; d < 3; ++d) {
      origin[d] = object_.box.low[d] * lattice::kSnapUnits;
      is_narrow &= object_.box.high[d] - object_.box.low[d] < kNarrowVoxels;
    }
    for (const mesh::Triangle& triangle : object_.triangles) {
      const mesh::Triangle at{corners_[triangle[0]], corners_[triangle[1]], corners_[triangle[2]]};
      std::uint32_t& number = numbers_[root(at[0])];
      if (number == kNone) {
        number = static_cast<std::uint32_t>(list_.size());
        list_.emplace_back().corner = triangle[0];
      }
      Component& component = list_[number];
      component.open += edge(at[0], at[1]) + edge(at[1], at[2]) + edge(at[2], at[0]);
      std::array<std::array<std::int64_t, 3>, 3> from;
      for (std::size_t k = 0; k < 3; ++k) {
        const LatticePoint& corner = object_.vertices[triangle[k]];
        for (std::size_t d = 0; d < 3; ++d) from[k][d] = corner[d] - origin[d];
      }
      component.volume_6 += static_cast<UInt128>(is_narrow ? Int128{volume_6<std::int64_t>(from)}
                                                           : volume_6<Int128>(from));
    }
  }

  // An edge there and an edge back add up to 0.
  static std::uint64_t edge(std::uint64_t from, std::uint64_t to) {
    if (from == to) return 0;
    const std::uint64_t hash = mixed(std::min(from, to) << 32 | std::max(from, to));
    return from < to ? hash : -hash;
  }

  // Corners of open components that are at the same place become one.
  void weld_open() {
    std::vector<std::uint32_t> slots(std::bit_ceil(2 * corners_.size() + 1), kNone);
    const std::uint64_t mask = slots.size() - 1;
    const std::span<const LatticePoint> points = object_.vertices;
    for (std::uint32_t i = 0; i < corners_.size(); ++i) {
      const std::uint32_t number = numbers_[root(i)];
      if (number == kNone || list_[number].open == 0) continue;
      const auto& [x, y, z] = points[i];
      std::uint64_t slot = mixed(static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15 +
                                 static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4f +
                                 static_cast<std::uint64_t>(z) * 0x165667b19e3779f9) &
                           mask;
      while (slots[slot] != kNone && points[slots[slot]] != points[i]) slot = (slot + 1) & mask;
      if (slots[slot] == kNone) slots[slot] = i;
      corners_[i] = slots[slot];
    }
  }

  const scan::SnappedObject& object_;
  std::vector<std::uint32_t> corners_;  // [vertices] the first vertex of the same corner
  std::vector<std::uint32_t> parents_;  // [vertices] towards the root of the component
  std::vector<std::uint32_t> numbers_;  // [vertices] of roots: the component's number
  std::vector<Component> list_;
};

// Whether a triangle, or a segment or point that it has shrunk to, holds the origin, seen along an
// axis.
bool shadow_holds(const std::array<std::array<std::int64_t, 3>, 3>& t, std::size_t u,
                  std::size_t w) {
  bool left = false, right = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto &a = t[k], &b = t[(k + 1) % 3];
    const Int128 area = Int128{a[u]} * b[w] - Int128{a[w]} * b[u];
    left |= area > 0, right |= area < 0;
  }
  return !(left && right);
}

// Sorted by the y of its start.
struct Ray {
  LatticePoint from;
  std::uint32_t component;
};

// A component's part in the enclosure of a ray's start.
struct Crossing {
  std::uint32_t of, by;
  int winding;  // 0: the start lies on a triangle
};

// How a triangle crosses the ray along x from the origin: 1 if it leaves there through a surface
// that is wound outwards, -1 if it enters, 0 if it misses. The triangle's edges are half-open, so a
// closed surface's crossings add up to the winding number around the origin.
int crossing_of(const std::array<std::array<std::int64_t, 3>, 3>& t) {
  int around = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto &a = t[k], &b = t[(k + 1) % 3];
    if ((a[2] <= 0) == (b[2] <= 0)) continue;
    const Int128 area = Int128{a[1]} * b[2] - Int128{a[2]} * b[1];
    if (a[2] <= 0 ? area > 0 : area < 0) around += a[2] <= 0 ? 1 : -1;
  }
  if (around == 0) return 0;
  const Int128 volume = volume_6<Int128>(t);
  return (around > 0) == (volume > 0) ? around : 0;
}

// Lists what crosses the rays from a corner of each closed component; false if that takes too long.
bool find_crossings(const scan::SnappedObject& object, Components& components,
                    std::vector<Crossing>& crossings) {
  const std::vector<Component>& list = components.list();
  std::vector<Ray> rays;
  for (std::uint32_t n = 0; n < list.size(); ++n) {
    if (list[n].is_closed()) rays.push_back({object.vertices[list[n].corner], n});
  }
  std::sort(rays.begin(), rays.end(),
            [](const Ray& a, const Ray& b) { return a.from[1] < b.from[1]; });
  constexpr std::uint64_t kMaxStepsEach =
      64;  // a triangle, on average: below the cost of binning it
  std::uint64_t steps = (std::uint64_t{1} << 22) + kMaxStepsEach * object.triangles.size();
  for (std::size_t n = 0; n < object.triangles.size(); ++n) {
    const std::uint32_t by = components.of(object.triangles[n]);
    if (!list[by].is_closed()) continue;
    const LatticeTriangle triangle = object.triangle(n);
    LatticePoint low, high;
    for (std::size_t d = 0; d < 3; ++d) {
      std::tie(low[d], high[d]) = std::minmax({triangle[0][d], triangle[1][d], triangle[2][d]});
    }
    auto ray = std::lower_bound(rays.begin(), rays.end(), low[1],
                                [](const Ray& a, std::int64_t y) { return a.from[1] < y; });
    for (; ray != rays.end() && ray->from[1] <= high[1]; ++ray) {
      if (--steps == 0) return false;
      const auto& [x, y, z] = ray->from;
      if (ray->component == by || z < low[2] || z > high[2] || x > high[0]) continue;
      const auto from = relative(triangle, ray->from);
      if (x >= low[0] && volume_6<Int128>(from) == 0 && shadow_holds(from, 0, 1) &&
          shadow_holds(from, 1, 2) && shadow_holds(from, 2, 0)) {
        crossings.push_back({ray->component, by, 0});
      } else if (const int winding = crossing_of(from); winding != 0) {
        crossings.push_back({ray->component, by, winding});
      }
    }
  }
  return true;
}

// Decides the sides of closed components, some of which enclose a negative volume: from the largest
// to the smallest, as only a larger one encloses another.
void decide_sides(std::vector<Component>& list, std::vector<Crossing>& crossings) {
  std::vector<std::uint32_t> order(list.size()), places(list.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return list[a].size() > list[b].size();
  });
  for (std::uint32_t n = 0; n < order.size(); ++n) places[order[n]] = n;
  // For each component, the larger ones around it come first.
  std::sort(crossings.begin(), crossings.end(), [&](const Crossing& a, const Crossing& b) {
    return a.of != b.of ? a.of < b.of : places[a.by] < places[b.by];
  });
  for (const std::uint32_t of : order) {
    Component& component = list[of];
    if (!component.is_closed()) continue;
    auto at = std::lower_bound(crossings.begin(), crossings.end(), of,
                               [](const Crossing& c, std::uint32_t n) { return c.of < n; });
    int material = 0;                   // how many bodies hold it, less cavities
    const Component* around = nullptr;  // the smallest that encloses it
    while (at != crossings.end() && at->of == of && places[at->by] < places[of]) {
      const std::uint32_t by = at->by;
      int winding = 0;
      bool touches = false;
      for (; at != crossings.end() && at->of == of && at->by == by; ++at) {
        winding += at->winding;
        touches |= at->winding == 0;
      }
      if (touches || winding == 0) continue;
      material += list[by].side * winding;
      around = &list[by];
    }
    component.side = material > 0 ? around->side : component.volume() > 0 ? 1 : -1;
  }
}

}  // namespace

SurfaceSides::SurfaceSides(const scan::SnappedObject& object, scan::SpillFile* spill) {
  if (object.triangles.empty()) return;
  for (std::size_t d = 0; d < 3; ++d) {
    if (object.box.high[d] - object.box.low[d] >= kMaxVoxels) return;
  }
  Components components(object);
  std::vector<Component>& list = components.list();
  if (std::any_of(list.begin(), list.end(),
                  [](const Component& c) { return c.is_closed() && c.volume() < 0; })) {
    std::vector<Crossing> crossings;
    if (list.size() > 1 && !find_crossings(object, components, crossings)) return;
    decide_sides(list, crossings);
  } else {
    for (Component& component : list) component.side = component.is_closed() ? 1 : 0;
  }
  const auto side_of = [&](std::uint32_t n) {
    return list[n].side == 0 ? TriangleSide() : TriangleSide(n, list[n].side < 0);
  };
  side_ = side_of(0);
  bool is_uniform = true;
  for (std::uint32_t n = 1; n < list.size(); ++n) is_uniform &= side_of(n) == side_;
  if (is_uniform) return;
  const std::size_t count = object.triangles.size();
  if (spill == nullptr) {
    own_sides_.resize(count);
    sides_ = own_sides_;
  } else {
    sides_ = spill->array<TriangleSide>(count);
    spill->touched(object.bytes() + count * sizeof(TriangleSide));
  }
  for (std::size_t n = 0; n < count; ++n) sides_[n] = side_of(components.of(object.triangles[n]));
}

}  // namespace forcelayer::distance
