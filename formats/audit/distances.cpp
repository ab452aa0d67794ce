#include <cmath>
#include <limits>
#include <optional>
#include <unordered_set>
#include <vector>

#include "formats/audit/layer_distance.h"
#include "formats/audit/parts.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::voxmap_audit {
namespace {

constexpr std::uint32_t kFarEntry = uniform_entry(kMostDistanceCode);
constexpr double kWriterErrorVoxels = 0.002;  // a code's distance may be lower than the true one
constexpr double kRoundingVoxels = 1e-9;      // of the header's doubles

// Which codes may stand beside which values and codes.
class CodeRules {
 public:
  explicit CodeRules(const VoxmapHeader& h) {
    const double n = force_layers(std::min(force_layer_voxels(h), 1e3));
    const double radius = interior_radius_m(h) / h.voxel_size_m;
    for (std::uint32_t code = 0; code < 256; ++code) {
      const double least = least_distance_m(h, code) / h.voxel_size_m - kRoundingVoxels;
      const double most =
          most_distance_m(h, code) / h.voxel_size_m + kWriterErrorVoxels + kRoundingVoxels;
      // In the order of VoxelValue: the steps from the interior that the value stands for.
      beside_value_[0][code] = most >= layer_distance_voxels(radius, n + 1);
      beside_value_[1][code] = least < radius;
      beside_value_[2][code] = most >= layer_distance_voxels(radius, 0) &&
                               least <= most_layer_distance_voxels(radius, n);
      beside_value_[3][code] = most >= layer_distance_voxels(radius, n) &&
                               least <= most_layer_distance_voxels(radius, n + 1);
      nearest_[code] = least > 0 ? least : most < 0 ? -most : 0;
      farthest_[code] = std::max(std::abs(least), std::abs(most));
    }
    for (std::uint32_t a = 0; a < 256; ++a) {
      for (std::uint32_t b = 0; b < 256; ++b) {
        beside_code_[a][b] = nearest_[a] <= farthest_[b] + 1 && nearest_[b] <= farthest_[a] + 1;
      }
    }
  }

  bool beside_value(std::uint32_t value, std::uint32_t code) const {
    return beside_value_[value][code];
  }
  bool beside_code(std::uint32_t a, std::uint32_t b) const { return beside_code_[a][b]; }

 private:
  std::array<double, 256> nearest_{}, farthest_{};  // of the unsigned distance, voxels
  std::array<std::array<bool, 256>, 4> beside_value_{};
  std::array<std::array<bool, 256>, 256> beside_code_{};
};

class DistanceAudit {
 public:
  DistanceAudit(const Voxmap& map, std::string_view name)
      : name_(name),
        header_(map.header()),
        values_(map.view()),
        distances_(*map.distances()),
        known_(known_box(header_)),
        rules_(header_) {}

  Status run() {
    const auto& dims = distances_.directory_dims;
    for (std::int64_t x = 0; x < dims[0]; ++x) {
      for (std::int64_t y = 0; y < dims[1]; ++y) {
        for (std::int64_t z = 0; z < dims[2]; ++z) visit_cell({x, y, z});
        if (bad_) return *bad_;
      }
    }
    return {};
  }

 private:
  void visit_cell(const Voxel& cell) {
    const Voxel low = world(cell);
    const std::uint32_t entry = entry_of(cell);
    compare(kUpperNodeEdge, low, value_entry(cell), entry);
    look_inside(kUpperNodeEdge, low, entry);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Voxel next = cell;
      ++next[axis];
      look_between(kUpperNodeEdge, axis, low, entry, entry_of(next));
      if (cell[axis] > 0) continue;
      next[axis] -= 2;  // outside, all is far
      look_between(kUpperNodeEdge, axis, world(next), kFarEntry, entry);
    }
  }

  Voxel world(const Voxel& cell) const {
    Voxel low;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = header_.directory_origin[axis] + cell[axis] * kUpperNodeEdge;
    }
    return low;
  }
  std::size_t index(const Voxel& cell) const {
    const auto& dims = distances_.directory_dims;
    return static_cast<std::size_t>((cell[0] * dims[1] + cell[1]) * dims[2] + cell[2]);
  }
  std::uint32_t entry_of(const Voxel& cell) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (cell[axis] < 0 || cell[axis] >= distances_.directory_dims[axis]) return kFarEntry;
    }
    return distances_.directory[index(cell)];
  }
  std::uint32_t value_entry(const Voxel& cell) const {
    return without_clearance(values_.directory[index(cell)]);
  }
  static std::uint32_t without_clearance(std::uint32_t entry) {
    return is_uniform(entry) ? uniform_entry(uniform_value(entry)) : entry;
  }

  // Child n of an entry whose cube has this edge; a uniform entry is its own child.
  template <std::uint32_t kBits>
  static std::uint32_t child(const TreeView<kBits>& tree, std::int64_t edge, std::uint32_t entry,
                             std::uint32_t n) {
    if (is_uniform(entry)) return entry;
    const std::uint32_t* nodes = edge == kUpperNodeEdge ? tree.upper_nodes : tree.lower_nodes;
    const std::uint32_t found = nodes[std::uint64_t{entry} * kNodeEntries + n];
    return kBits == kValueBits ? without_clearance(found) : found;
  }

  // The element of voxel n of a brick, or of a uniform box.
  template <std::uint32_t kBits>
  static std::uint32_t element(const TreeView<kBits>& tree, std::uint32_t entry, std::uint32_t n) {
    return is_uniform(entry) ? uniform_wide_value(entry) : tree.brick_code(entry, n);
  }

  static std::size_t level(std::int64_t edge) {
    return edge == kUpperNodeEdge ? 0 : edge == kLowerNodeEdge ? 1 : 2;
  }

  // Whether a box is to be looked at: not where nothing of it is known, and once where all is.
  bool is_new(const Span& box, const Span& known, std::unordered_set<std::uint64_t>& seen,
              std::uint32_t a, std::uint32_t b) {
    if (bad_ || known.empty()) return false;
    return !(known == box) || seen.insert(std::uint64_t{a} << 32 | b).second;
  }

  // Values beside the codes of the same voxels.
  void compare(std::int64_t edge, const Voxel& low, std::uint32_t values, std::uint32_t codes) {
    const Span box = Span::cube(low, edge), known = known_part(box, known_);
    if (is_uniform(values) && is_uniform(codes)) {
      if (!known.empty()) check_value(known.low, uniform_value(values), uniform_wide_value(codes));
      return;
    }
    if (!is_new(box, known, compared_[level(edge)], values, codes)) return;
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const Voxel at = voxmap_walk::child_low(low, n, edge / 8);
      if (edge > kBrickEdge) {
        compare(edge / 8, at, child(values_, edge, values, n), child(distances_, edge, codes, n));
      } else if (!known_part(Span::cube(at, 1), known_).empty()) {
        check_value(at, element(values_, values, n), element(distances_, codes, n));
      }
    }
  }

  void check_value(const Voxel& at, std::uint32_t value, std::uint32_t code) {
    if (bad_ || rules_.beside_value(value, code)) return;
    bad_ = untrue(name_, voxel_text(at),
                  "its code " + std::to_string(code) + " (" + range_text(code) +
                      ") is not a distance that value " + std::to_string(value) + " can have");
  }

  // Neighbors over faces, both in one entry's cube.
  void look_inside(std::int64_t edge, const Voxel& low, std::uint32_t entry) {
    if (is_uniform(entry)) return;
    const Span box = Span::cube(low, edge), known = known_part(box, known_);
    if (!is_new(box, known, inside_[level(edge)], entry, 0)) return;
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const Voxel at = voxmap_walk::child_low(low, n, edge / 8);
      if (edge > kBrickEdge) look_inside(edge / 8, at, child(distances_, edge, entry, n));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::uint32_t step = 64u >> (3 * axis);
        if ((n / step & 7) == 7) continue;
        if (edge > kBrickEdge) {
          look_between(edge / 8, axis, at, child(distances_, edge, entry, n),
                       child(distances_, edge, entry, n + step));
        } else {
          check_codes(axis, at, distances_.brick_code(entry, n),
                      distances_.brick_code(entry, n + step));
        }
      }
    }
  }

  // Neighbors over the face between the cube at `low` and the next one along `axis`.
  void look_between(std::int64_t edge, std::size_t axis, const Voxel& low, std::uint32_t a,
                    std::uint32_t b) {
    Span box = Span::cube(low, edge);  // the last layer of one and the first of the other
    box.low[axis] = box.high[axis] - 1;
    box.high[axis] += 1;
    Span known = known_part(box, known_);
    if (known.high[axis] - known.low[axis] < 2) return;
    if (is_uniform(a) && is_uniform(b)) {
      if (!known.empty())
        check_codes(axis, known.low, uniform_wide_value(a), uniform_wide_value(b));
      return;
    }
    if (!is_new(box, known, between_[axis][level(edge)], a, b)) return;
    const std::uint32_t step = 64u >> (3 * axis);
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      if ((n / step & 7) != 7) continue;
      const std::uint32_t opposite = n - 7 * step;
      const Voxel at = voxmap_walk::child_low(low, n, edge / 8);
      if (edge > kBrickEdge) {
        look_between(edge / 8, axis, at, child(distances_, edge, a, n),
                     child(distances_, edge, b, opposite));
      } else {
        check_codes(axis, at, element(distances_, a, n), element(distances_, b, opposite));
      }
    }
  }

  void check_codes(std::size_t axis, const Voxel& at, std::uint32_t a, std::uint32_t b) {
    if (bad_ || rules_.beside_code(a, b)) return;
    Span pair = Span::cube(at, 1);
    ++pair.high[axis];
    if (!(known_part(pair, known_) == pair)) return;
    Voxel next = at;
    ++next[axis];
    bad_ = untrue(name_, voxel_text(at),
                  "its code " + std::to_string(a) + " (" + range_text(a) + ") and code " +
                      std::to_string(b) + " (" + range_text(b) + ") of its neighbor " +
                      voxel_text(next) + " differ by more than a voxel");
  }

  std::string range_text(std::uint32_t code) const {
    const auto voxels = [&](double meters) {
      return std::to_string(meters / header_.voxel_size_m) + " voxels";
    };
    if (code == 0) return "below " + voxels(most_distance_m(header_, code));
    const std::string least = voxels(least_distance_m(header_, code));
    return code == kMostDistanceCode ? least + " or more" : "from " + least;
  }

  std::string_view name_;
  const VoxmapHeader& header_;
  const VoxmapView& values_;
  const DistanceView& distances_;
  KnownBox known_;
  CodeRules rules_;
  std::array<std::unordered_set<std::uint64_t>, 3> compared_, inside_;  // by level
  std::array<std::array<std::unordered_set<std::uint64_t>, 3>, 3> between_;
  std::optional<Error> bad_;
};

// Of layers. A standoff is what the two lengths say; opening the file has checked its bounds.
Status audit_lengths(const VoxmapHeader& h, std::string_view name) {
  if (has_standoff(h)) return {};
  const double expected_m =
      interior_radius_voxels(h.offset_layers) * h.voxel_size_m + h.force_depth_m;
  if (std::abs(h.zero_force_m - expected_m) <= 1e-6 * h.voxel_size_m) return {};
  return untrue(name, "header (zero_force_m)",
                "says " + std::to_string(h.zero_force_m) + ", the layers and force_depth_m say " +
                    std::to_string(expected_m));
}

}  // namespace

Status audit_distances(const Voxmap& map, std::string_view name) {
  if (map.header().metric == static_cast<std::uint32_t>(Metric::kEuclidean)) {
    if (Status s = audit_lengths(map.header(), name); !s) return s;
  }
  return map.distances() == nullptr ? Status() : DistanceAudit(map, name).run();
}

Status audit_objects(const Voxmap& map, std::string_view name) {
  if (map.objects() == nullptr) return {};
  for (std::uint32_t brick = 0; brick < map.object_counts().bricks; ++brick) {
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const std::uint32_t object = map.objects()->brick_code(brick, n);
      if (object <= map.header().object_count) continue;
      return untrue(name, "object brick " + std::to_string(brick) + " voxel " + std::to_string(n),
                    "names object " + std::to_string(object) + " of " +
                        std::to_string(map.header().object_count));
    }
  }
  return {};
}

}  // namespace forcelayer::voxmap_audit
