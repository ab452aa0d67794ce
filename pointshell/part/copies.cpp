#include "pointshell/part/copies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace forcelayer::part {
namespace {

using Bodies = std::vector<std::uint32_t>;

// In radii. A point covers surface of two bodies only where they are this near.
constexpr double kServed = 2;
constexpr double kMaxSlack = 1e-3;
constexpr double kFarthest = 5;  // of the distances that proofs speak of
// Groups of the same meshes that no motion takes into each other (other scales) are compared with
// so many at most.
constexpr int kMaxOriginals = 100;

std::array<Vec3, 3> rows_of(const mesh::Affine& placing) {
  const std::array<double, 9>& m = placing.linear;
  return {Vec3{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}};
}

Vec3 offset_of(const mesh::Affine& placing) {
  return {placing.translation[0], placing.translation[1], placing.translation[2]};
}

// The motion from where `from` puts a mesh to where `to` puts it; not finite where `from` is flat.
Motion motion_between(const mesh::Affine& from, const mesh::Affine& to) {
  const std::array<Vec3, 3> a = rows_of(from), b = rows_of(to);
  // The columns of the inverse are cross products of rows, over the determinant.
  const double inverse = 1 / dot(a[0], cross(a[1], a[2]));
  const std::array<Vec3, 3> columns{inverse * cross(a[1], a[2]), inverse * cross(a[2], a[0]),
                                    inverse * cross(a[0], a[1])};
  Motion motion;
  for (int n = 0; n < 3; ++n) {
    motion.rows[n] = b[n].x * Vec3{columns[0].x, columns[1].x, columns[2].x} +
                     b[n].y * Vec3{columns[0].y, columns[1].y, columns[2].y} +
                     b[n].z * Vec3{columns[0].z, columns[1].z, columns[2].z};
  }
  motion.offset = offset_of(to) - motion.turned(offset_of(from));
  return motion;
}

// By how much the motion stretches at most: it multiplies lengths by 1 + this or less.
double stretch_of(const Motion& motion) {
  double largest = 0;
  double sum = dot(motion.offset, {1, 1, 1});
  for (const Vec3& row : motion.rows) sum += length_squared(row);
  if (!std::isfinite(sum)) return std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      largest = std::max(largest, std::abs(dot(motion.rows[i], motion.rows[j]) - (i == j ? 1 : 0)));
    }
  }
  return 1.5 * largest;  // the norm of rows * rows^T - 1 is at most 3 times its largest element
}

bool is_mirror(const Motion& motion) {
  return dot(motion.rows[0], cross(motion.rows[1], motion.rows[2])) < 0;
}

std::vector<Bodies> groups_of(const std::vector<Box>& boxes, const Bodies& bodies, double reach) {
  Box of_lows;
  for (const std::uint32_t body : bodies) of_lows.grow(boxes[body].low);
  const int axis = of_lows.longest_axis();
  Bodies order = bodies;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return coordinate(boxes[a].low, axis) < coordinate(boxes[b].low, axis);
  });
  std::vector<std::uint32_t> parent(boxes.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t body) {
    while (parent[body] != body) body = parent[body] = parent[parent[body]];
    return body;
  };
  const auto near = [&](const Box& a, const Box& b) {
    bool all = true;
    for (int n = 0; n < 3; ++n) {
      all = all && coordinate(a.low, n) <= coordinate(b.high, n) + reach &&
            coordinate(b.low, n) <= coordinate(a.high, n) + reach;
    }
    return all;
  };
  Bodies passing;  // those that the sweep has not left behind
  for (const std::uint32_t body : order) {
    const double low = coordinate(boxes[body].low, axis);
    std::erase_if(passing, [&](std::uint32_t other) {
      return coordinate(boxes[other].high, axis) + reach < low;
    });
    for (const std::uint32_t other : passing) {
      if (near(boxes[body], boxes[other])) parent[root(body)] = root(other);
    }
    passing.push_back(body);
  }
  std::map<std::uint32_t, Bodies> by_root;
  for (const std::uint32_t body : bodies) by_root[root(body)].push_back(body);
  std::vector<Bodies> groups;
  for (auto& [first, group] : by_root) groups.push_back(std::move(group));
  return groups;
}

class CopyFinder {
 public:
  CopyFinder(const Part& part, double radius)
      : part_(part), radius_(radius), of_body_(triangles_by_body(part)) {
    for (const Vec3& v : part.vertices) box_.grow(v);
    for (Bodies& triangles : of_body_) {
      std::sort(triangles.begin(), triangles.end(),
                [&](std::uint32_t a, std::uint32_t b) { return part.source[a] < part.source[b]; });
    }
  }

  std::vector<CopiedGroup> find() const {
    using Key = std::vector<std::pair<std::uint32_t, std::size_t>>;  // mesh, triangles
    std::map<Key, std::vector<Bodies>> alike;
    for (Bodies& group : separate_groups(part_, kServed * radius_)) {
      Key key;
      for (const std::uint32_t body : group) {
        key.emplace_back(part_.placings[body].mesh, of_body_[body].size());
      }
      alike[key].push_back(std::move(group));
    }
    std::vector<CopiedGroup> copied;
    for (auto& [key, groups] : alike) choose_originals(std::move(groups), copied);
    std::sort(copied.begin(), copied.end(), [&](const CopiedGroup& a, const CopiedGroup& b) {
      return first_vertex(a.bodies) < first_vertex(b.bodies);
    });
    return copied;
  }

 private:
  std::uint32_t first_vertex(const Bodies& bodies) const {
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
    for (const std::uint32_t body : bodies) {
      for (const std::uint32_t t : of_body_[body]) first = std::min(first, part_.triangles[t][0]);
    }
    return first;
  }

  void choose_originals(std::vector<Bodies> groups, std::vector<CopiedGroup>& copied) const {
    std::map<std::uint32_t, Bodies> left;  // by their first vertex
    for (Bodies& group : groups) left.emplace(first_vertex(group), std::move(group));
    for (int tried = 0; left.size() > 1 && tried < kMaxOriginals; ++tried) {
      CopiedGroup own;
      own.bodies = std::move(left.begin()->second);
      left.erase(left.begin());
      for (auto other = left.begin(); other != left.end();) {
        const Motion motion = motion_between(part_.placings[own.bodies[0]].part_from_mesh,
                                             part_.placings[other->second[0]].part_from_mesh);
        const std::optional<double> slack = slack_between(own.bodies, other->second, motion);
        if (slack) {
          own.slack_m = std::max(own.slack_m, *slack);
          own.copies.push_back({motion, std::move(other->second)});
          other = left.erase(other);
        } else {
          ++other;
        }
      }
      if (!own.copies.empty()) copied.push_back(std::move(own));
    }
  }

  // Nothing where `to` is not `from`, moved.
  std::optional<double> slack_between(const Bodies& from, const Bodies& to,
                                      const Motion& motion) const {
    const double largest = kMaxSlack * radius_, across = length(box_.high - box_.low);
    double slack = kFarthest * radius_ * stretch_of(motion) +
                   std::ldexp(across + 2 * radius_, -24) +  // points rounded to floats
                   std::ldexp(part_.largest_coordinate + across, -40);
    if (!(slack <= largest)) return {};
    const double max_off = largest - slack;
    double off = 0;
    for (std::size_t n = 0; n < from.size(); ++n) {
      for (std::size_t k = 0; k < of_body_[from[n]].size(); ++k) {
        const std::uint32_t a = of_body_[from[n]][k], b = of_body_[to[n]][k];
        if (part_.source[a] != part_.source[b]) return {};
        off = std::max(off, distance_between(a, b, motion));
        if (!(off <= max_off)) return {};
      }
    }
    return slack + off;
  }

  // The farthest that a place of triangle `b` is from its place of `a`, moved. Both start at their
  // own lowest corner.
  double distance_between(std::uint32_t a, std::uint32_t b, const Motion& motion) const {
    Piece moved = triangle_piece(part_, a);
    for (Vec3& corner : moved) corner = motion.moved(corner);
    if (is_mirror(motion)) std::swap(moved[1], moved[2]);
    const Piece own = triangle_piece(part_, b);
    double smallest = std::numeric_limits<double>::infinity();
    for (int shift = 0; shift < 3; ++shift) {
      double squared = 0;
      for (int n = 0; n < 3; ++n) {
        squared = std::max(squared, length_squared(moved[(n + shift) % 3] - own[n]));
      }
      smallest = std::min(smallest, squared);
    }
    return std::sqrt(smallest);
  }

  const Part& part_;
  const double radius_;
  std::vector<Bodies> of_body_;  // its triangles, in the order of its mesh
  Box box_;
};

// Whether any mesh is there twice.
bool has_instances(const Part& part) {
  std::vector<std::uint32_t> meshes;
  for (const Placing& placing : part.placings) meshes.push_back(placing.mesh);
  std::sort(meshes.begin(), meshes.end());
  return std::adjacent_find(meshes.begin(), meshes.end()) != meshes.end();
}

}  // namespace

Motion relative_to(const Motion& motion, const Vec3& origin) {
  return {motion.rows, motion.moved(origin) - origin};
}

std::vector<Bodies> separate_groups(const Part& part, double reach) {
  const std::vector<Bodies> of_body = triangles_by_body(part);
  std::vector<Box> boxes;
  Bodies bodies;
  for (std::uint32_t body = 0; body < of_body.size(); ++body) {
    boxes.push_back(box_of(part, of_body[body]));
    if (!of_body[body].empty()) bodies.push_back(body);
  }
  return groups_of(boxes, bodies, reach);
}

std::vector<CopiedGroup> find_copies(const Part& part, double radius) {
  if (!has_instances(part)) return {};
  return CopyFinder(part, radius).find();
}

std::vector<std::uint32_t> original_triangles(const Part& part,
                                              std::span<const CopiedGroup> groups) {
  std::vector<std::uint32_t> original(part.triangles.size());
  std::iota(original.begin(), original.end(), 0u);
  if (groups.empty()) return original;
  std::vector<Bodies> of_body = triangles_by_body(part);
  const auto by_source = [&](std::uint32_t a, std::uint32_t b) {
    return part.source[a] < part.source[b];
  };
  for (const CopiedGroup& group : groups) {
    for (std::size_t n = 0; n < group.bodies.size(); ++n) {
      Bodies& own = of_body[group.bodies[n]];
      std::sort(own.begin(), own.end(), by_source);
      for (const Copy& copy : group.copies) {
        Bodies& others = of_body[copy.bodies[n]];
        std::sort(others.begin(), others.end(), by_source);
        for (std::size_t k = 0; k < own.size(); ++k) original[others[k]] = own[k];
      }
    }
  }
  return original;
}

}  // namespace forcelayer::part
