#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "formats/audit/code_rules.h"
#include "formats/audit/effort.h"
#include "formats/audit/neighborhoods.h"
#include "formats/audit/parts.h"
#include "formats/bricks/unpacked_distances.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::voxmap_audit {
namespace {

// A coarser step would say too little about the interior, and about neighbors.
constexpr double kMaxQuantumVoxels = 0.25;

// Units of effort: a pair that is asked for; a pair of nodes and one of bricks that is looked at.
constexpr std::uint64_t kPairUnits = 20, kNodesUnits = 8'000, kBricksUnits = 400,
                        kOneByOneUnits = 8'000;

// A set of numbers, in one piece of memory.
class SeenPairs {
 public:
  // Whether the pair is new.
  bool insert(std::uint32_t a, std::uint32_t b) {
    if (2 * (count_ + 1) > slots_.size()) grow();
    const std::uint64_t pair = std::uint64_t{a} << 32 | b;
    std::uint64_t& slot = find(pair + 1);
    if (slot != 0) return false;
    slot = pair + 1;
    ++count_;
    return true;
  }

 private:
  // No pair is UINT64_MAX: an entry that is uniform has zeros in it.
  std::uint64_t& find(std::uint64_t key) {
    std::size_t at = key * 0x9e3779b97f4a7c15u >> shift_;
    while (slots_[at] != 0 && slots_[at] != key) at = (at + 1) & (slots_.size() - 1);
    return slots_[at];
  }
  void grow() {
    std::vector<std::uint64_t> old = std::exchange(slots_, {});
    slots_.resize(std::max<std::size_t>(1024, 2 * old.size()));
    shift_ = 64 - std::countr_zero(slots_.size());
    for (const std::uint64_t key : old) {
      if (key != 0) find(key) = key;
    }
  }

  std::vector<std::uint64_t> slots_;
  std::size_t count_ = 0;
  int shift_ = 0;
};

class DistanceAudit {
 public:
  DistanceAudit(const Voxmap& map, Effort& effort, std::string_view name)
      : name_(name),
        header_(map.header()),
        values_(map.view()),
        distances_(*map.distances()),
        unpacked_(distances_, kSlotBits),
        known_(known_box(header_)),
        rules_(header_),
        effort_(effort) {}

  Status run() {
    const auto& dims = distances_.directory_dims;
    for (std::int64_t x = 0; x < dims[0]; ++x) {
      for (std::int64_t y = 0; y < dims[1]; ++y) {
        for (std::int64_t z = 0; z < dims[2]; ++z) {
          const Voxel cell{x, y, z};
          compare(kUpperNodeEdge, world(cell), value_entry(cell),
                  distances_.directory[index(cell)]);
        }
        if (bad_) return *bad_;
        if (effort_.is_spent()) return strewn(name_);
      }
    }
    return {};
  }

 private:
  static constexpr unsigned kSlotBits = 12;

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
  std::uint32_t value_entry(const Voxel& cell) const {
    return without_clearance(values_.directory[index(cell)]);
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

  // The value of voxel n of a brick, or of a uniform box; its code.
  std::uint32_t value(std::uint32_t entry, std::uint32_t n) const {
    return is_uniform(entry) ? uniform_value(entry) : values_.brick_code(entry, n);
  }
  std::uint32_t code(std::uint32_t entry, std::uint32_t n) {
    return is_uniform(entry) ? uniform_wide_value(entry) : unpacked_.brick(entry)[n];
  }

  static std::size_t level(std::int64_t edge) {
    return edge == kUpperNodeEdge ? 0 : edge == kLowerNodeEdge ? 1 : 2;
  }

  // Whether a box is to be looked at: not where nothing of it is known, and once where all is.
  bool is_new(const Span& box, SeenPairs& seen, std::uint32_t a, std::uint32_t b,
              std::uint64_t units) {
    if (bad_ || effort_.is_spent()) return false;
    effort_.spend(kPairUnits);
    bool once = true;
    if (header_.cropped_sides != 0) {
      const Span known = known_part(box, known_);
      if (known.empty()) return false;
      once = known == box;
    }
    if (once && !seen.insert(a, b)) return false;
    effort_.spend(units);
    return true;
  }

  // The codes of a brick or of a uniform box of its size.
  BrickCodes codes_of(std::uint32_t entry) {
    if (!is_uniform(entry)) return unpacked_.brick(entry);
    BrickCodes codes;
    codes.fill(static_cast<std::uint8_t>(uniform_wide_value(entry)));
    return codes;
  }
  bool surely_beside_values(std::uint32_t values, std::uint32_t codes) {
    std::array<std::uint8_t, 128> bytes;
    if (is_uniform(values)) {
      bytes.fill(static_cast<std::uint8_t>(uniform_value(values) * 0x55));
    } else {
      std::memcpy(bytes.data(), values_.bricks + std::uint64_t{values} * 16 * kValueBits,
                  bytes.size());
    }
    return rules_.surely_beside_values(bytes.data(), codes_of(codes));
  }

  // Values beside the codes of the same voxels.
  void compare(std::int64_t edge, const Voxel& low, std::uint32_t values, std::uint32_t codes) {
    const bool uniform = is_uniform(values) && is_uniform(codes);
    if (uniform && rules_.beside_value(uniform_value(values), uniform_wide_value(codes))) return;
    const Span box = Span::cube(low, edge);
    if (uniform) {
      const Span known = known_part(box, known_);
      if (!known.empty()) check_value(known.low, uniform_value(values), uniform_wide_value(codes));
      return;
    }
    const bool nodes = edge > kBrickEdge;
    if (!is_new(box, compared_[level(edge)], values, codes, nodes ? kNodesUnits : kBricksUnits)) {
      return;
    }
    if (!nodes && surely_beside_values(values, codes)) return;
    if (!nodes) effort_.spend(kOneByOneUnits);
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const Voxel at = voxmap_walk::child_low(low, n, edge / 8);
      if (nodes) {
        compare(edge / 8, at, child(values_, edge, values, n), child(distances_, edge, codes, n));
      } else if (!known_part(Span::cube(at, 1), known_).empty()) {
        check_value(at, value(values, n), code(codes, n));
      }
    }
  }

  void check_value(const Voxel& at, std::uint32_t value, std::uint32_t code) {
    if (bad_ || rules_.beside_value(value, code)) return;
    bad_ = untrue(name_, voxel_text(at),
                  "the code " + std::to_string(code) + " (" + range_text(header_, code) +
                      ") is not a possible distance of a voxel of value " + std::to_string(value));
  }

  std::string_view name_;
  const VoxmapHeader& header_;
  const VoxmapView& values_;
  const DistanceView& distances_;
  UnpackedDistances unpacked_;
  KnownBox known_;
  CodeRules rules_;
  std::array<SeenPairs, 3> compared_;  // by level
  Effort& effort_;
  std::optional<Error> bad_;
};

// The numbers of the bricks that a tree's lower nodes name, each once.
template <std::uint32_t kBits>
std::vector<std::uint32_t> stored_bricks(const TreeView<kBits>& tree, const TreeCounts& counts) {
  std::vector<std::uint32_t> bricks;
  std::copy_if(tree.lower_nodes, tree.lower_nodes + counts.lower_nodes * kNodeEntries,
               std::back_inserter(bricks), [](std::uint32_t entry) { return !is_uniform(entry); });
  std::sort(bricks.begin(), bricks.end());
  bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
  return bricks;
}

Status audit_packing(const Voxmap& map, std::string_view name) {
  const DistanceView& distances = *map.distances();
  for (const std::uint32_t brick : stored_bricks(distances, map.distance_counts())) {
    const char* const fault = packed_distances_fault(distances.brick_at(brick));
    if (fault != nullptr) return untrue(name, "distance brick " + std::to_string(brick), fault);
  }
  return {};
}

// Checks what the header says about lengths. With a standoff the lengths define it, and opening the
// file has checked their bounds.
Status audit_lengths(const VoxmapHeader& h, std::string_view name) {
  if (has_distances(h)) {
    if (h.distance_quantum_m > kMaxQuantumVoxels * h.voxel_size_m) {
      return untrue(name, "header (distance_quantum_m)",
                    "is " + std::to_string(h.distance_quantum_m) +
                        ", which is more than a quarter of a voxel");
    }
    if (min_distance_m(h, kMaxDistanceCode) < interior_radius_m(h)) {
      return untrue(name, "header (distance_quantum_m, distance_zero_code)",
                    "stored distances end at " +
                        std::to_string(min_distance_m(h, kMaxDistanceCode)) +
                        " m, but interior voxels lie up to " +
                        std::to_string(interior_radius_m(h)) + " m from the mesh");
    }
  }
  if (has_standoff(h)) return {};
  const double expected_m =
      interior_radius_voxels(h.offset_layers) * h.voxel_size_m + h.force_depth_m;
  if (std::abs(h.zero_force_m - expected_m) <= 1e-6 * h.voxel_size_m) return {};
  return untrue(name, "header (zero_force_m)",
                "is " + std::to_string(h.zero_force_m) +
                    ", but offset_layers and force_depth_m give " + std::to_string(expected_m));
}

}  // namespace

std::string range_text(const VoxmapHeader& h, std::uint32_t code) {
  const auto voxels = [&](double meters) {
    return std::to_string(meters / h.voxel_size_m) + " voxels";
  };
  if (code == 0) return "below " + voxels(max_distance_m(h, code));
  const std::string smallest = voxels(min_distance_m(h, code));
  return code == kMaxDistanceCode ? smallest + " or more" : "from " + smallest;
}

Status audit_distances(const Voxmap& map, Effort& effort, std::string_view name) {
  if (map.header().metric == static_cast<std::uint32_t>(Metric::kEuclidean)) {
    if (Status s = audit_lengths(map.header(), name); !s) return s;
  }
  if (map.distances() == nullptr) return {};
  if (Status s = audit_packing(map, name); !s) return s;
  return DistanceAudit(map, effort, name).run();
}

Status audit_objects(const Voxmap& map, std::string_view name) {
  if (map.objects() == nullptr) return {};
  const ObjectView& objects = *map.objects();
  for (const std::uint32_t brick : stored_bricks(objects, map.object_counts())) {
    const char* const fault =
        packed_objects_fault(objects.brick_at(brick), map.header().object_count);
    if (fault != nullptr) return untrue(name, "object brick " + std::to_string(brick), fault);
  }
  return {};
}

}  // namespace forcelayer::voxmap_audit
