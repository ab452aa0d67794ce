#include "formats/mesh/mesh_facts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

namespace forcelayer::mesh {
namespace {

// For each vertex, the first vertex of the same coordinates.
class Weld {
 public:
  explicit Weld(const std::vector<Vec3d>& vertices) : vertices_(vertices) {
    slots_.assign(std::bit_ceil(2 * vertices.size() + 1), kEmpty);
    first_.reserve(vertices.size());
    for (std::uint32_t i = 0; i < vertices.size(); ++i) first_.push_back(find_or_add(i));
  }

  std::uint32_t operator[](std::uint32_t vertex) const { return first_[vertex]; }
  std::uint64_t distinct() const { return distinct_; }

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffff;

  static std::uint64_t hash(const Vec3d& vertex) {
    std::uint64_t h = 0;
    for (const double coordinate : vertex) {
      h ^= std::bit_cast<std::uint64_t>(coordinate + 0.0);  // -0 is 0
      h *= 0x9e3779b97f4a7c15;
      h ^= h >> 32;
    }
    return h;
  }

  std::uint32_t find_or_add(std::uint32_t vertex) {
    const std::uint64_t mask = slots_.size() - 1;
    for (std::uint64_t slot = hash(vertices_[vertex]) & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] == kEmpty) {
        slots_[slot] = vertex;
        ++distinct_;
        return vertex;
      }
      if (vertices_[slots_[slot]] == vertices_[vertex]) return slots_[slot];
    }
  }

  const std::vector<Vec3d>& vertices_;
  std::vector<std::uint32_t> slots_;  // open addressing, at most half full
  std::vector<std::uint32_t> first_;
  std::uint64_t distinct_ = 0;
};

// Lists by vertex, one behind the other.
template <class Item>
struct Lists {
  std::vector<std::uint64_t> ends;  // [vertices]
  std::vector<Item> items;

  std::span<Item> of(std::size_t vertex) {
    const std::uint64_t begin = vertex == 0 ? 0 : ends[vertex - 1];
    return std::span(items).subspan(begin, ends[vertex] - begin);
  }
};

// `for_each(add)` calls add(vertex, item) for every item; it is called twice.
template <class Item, class ForEach>
Lists<Item> lists_of(std::size_t vertices, ForEach&& for_each) {
  Lists<Item> lists;
  lists.ends.resize(vertices + 1);
  for_each([&](std::uint32_t vertex, const Item&) { ++lists.ends[vertex + 1]; });
  std::partial_sum(lists.ends.begin(), lists.ends.end(), lists.ends.begin());
  lists.items.resize(lists.ends.back());
  // Filling a list moves its begin to its end.
  for_each(
      [&](std::uint32_t vertex, const Item& item) { lists.items[lists.ends[vertex]++] = item; });
  lists.ends.pop_back();
  return lists;
}

Vec3d minus(const Vec3d& a, const Vec3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

void measure_box(const Mesh& mesh, MeshFacts& facts) {
  if (mesh.vertices.empty()) return;
  facts.min = facts.max = mesh.vertices[0];
  for (const Vec3d& vertex : mesh.vertices) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      facts.min[axis] = std::min(facts.min[axis], vertex[axis]);
      facts.max[axis] = std::max(facts.max[axis], vertex[axis]);
    }
  }
}

// Area, volume (about the box's corner, where the numbers are small) and triangles of no area.
void measure_triangles(const Mesh& mesh, MeshFacts& facts) {
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d& a = mesh.vertices[i];
    const Vec3d normal = cross(minus(mesh.vertices[j], a), minus(mesh.vertices[k], a));
    const double doubled_area = std::hypot(normal[0], normal[1], normal[2]);
    const Vec3d offset = minus(a, facts.min);
    facts.area += doubled_area / 2;
    facts.signed_volume +=
        (offset[0] * normal[0] + offset[1] * normal[1] + offset[2] * normal[2]) / 6;
    if (doubled_area == 0) ++facts.degenerate_triangles;
  }
}

Triangle welded(const Triangle& triangle, const Weld& weld) {
  return {weld[triangle[0]], weld[triangle[1]], weld[triangle[2]]};
}

void count_duplicates(const Mesh& mesh, const Weld& weld, MeshFacts& facts) {
  using Others = std::array<std::uint32_t, 2>;  // the two higher corners, the lower one first
  auto by_lowest = lists_of<Others>(mesh.vertices.size(), [&](auto&& add) {
    for (const Triangle& triangle : mesh.triangles) {
      Triangle sorted = welded(triangle, weld);
      std::sort(sorted.begin(), sorted.end());
      add(sorted[0], Others{sorted[1], sorted[2]});
    }
  });
  for (std::size_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
    const std::span<Others> others = by_lowest.of(vertex);
    std::sort(others.begin(), others.end());
    for (std::size_t i = 1; i < others.size(); ++i) {
      if (others[i] == others[i - 1]) ++facts.duplicate_triangles;
    }
  }
}

// One triangle's passage along an edge.
struct EdgeUse {
  std::uint32_t high;  // vertex
  bool upwards;        // from the low one to the high one
};

// The uses of all edges that begin at one vertex.
void count_edges(std::span<EdgeUse> uses, MeshFacts& facts) {
  std::sort(uses.begin(), uses.end(),
            [](const EdgeUse& a, const EdgeUse& b) { return a.high < b.high; });
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t last = first, upwards = 0;
    for (; last < uses.size() && uses[last].high == uses[first].high; ++last) {
      upwards += uses[last].upwards ? 1 : 0;
    }
    const std::size_t count = last - first;
    if (count == 1) ++facts.boundary_edges;
    if (count > 2) ++facts.non_manifold_edges;
    if (count == 2 && upwards != 1) ++facts.flipped_edges;
    facts.closed = facts.closed && count % 2 == 0;
    facts.consistently_oriented =
        facts.consistently_oriented && (count == 1 || 2 * upwards == count);
    first = last;
  }
}

void count_edges(const Mesh& mesh, const Weld& weld, MeshFacts& facts) {
  auto by_low = lists_of<EdgeUse>(mesh.vertices.size(), [&](auto&& add) {
    for (const Triangle& triangle : mesh.triangles) {
      const Triangle corners = welded(triangle, weld);
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
        continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t from = corners[i], to = corners[(i + 1) % 3];
        add(std::min(from, to), EdgeUse{std::max(from, to), from < to});
      }
    }
  });
  facts.closed = facts.consistently_oriented = !by_low.items.empty();
  for (std::size_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
    count_edges(by_low.of(vertex), facts);
  }
}

}  // namespace

double area_of(const Mesh& mesh) {
  double area = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d& a = mesh.vertices[i];
    const Vec3d normal = cross(minus(mesh.vertices[j], a), minus(mesh.vertices[k], a));
    area += std::hypot(normal[0], normal[1], normal[2]) / 2;
  }
  return area;
}

MeshFacts mesh_facts(const Mesh& mesh) {
  MeshFacts facts;
  facts.triangles = mesh.triangles.size();
  facts.vertices = mesh.vertices.size();
  const Weld weld(mesh.vertices);
  facts.distinct_vertices = weld.distinct();
  measure_box(mesh, facts);
  measure_triangles(mesh, facts);
  count_duplicates(mesh, weld, facts);
  count_edges(mesh, weld, facts);
  return facts;
}

}  // namespace forcelayer::mesh
