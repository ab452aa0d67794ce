// Layers are grown as bits: a node of 64^3 voxels and what lies around it at a time, 64 voxels
// along z in a word.
#include <optional>
#include <unordered_set>
#include <vector>

#include "formats/audit/parts.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::voxmap_audit {
namespace {

constexpr std::uint32_t kFreeEntry = uniform_entry(0);
constexpr std::uint32_t kInteriorEntry = uniform_entry(1);
constexpr std::int64_t kNode = kLowerNodeEdge;
constexpr std::int64_t kMostSteps = kNode - 1;  // of one growth: the node and those around it

// The entries of a cube and of its 26 neighbors, x slowest, without clearances.
using Around = std::array<std::uint32_t, 27>;
constexpr std::size_t kCenter = 13;

struct AroundHash {
  std::size_t operator()(const Around& around) const {
    std::uint64_t hash = 0;
    for (const std::uint32_t entry : around) {
      hash = (hash ^ entry) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

// The sets of values that are looked at; a value's bit is 1 << value.
constexpr unsigned kInterior = 2, kUpToSurface = 2 | 4, kUpToProximity = 2 | 4 | 8;

// One bit a voxel of a node, [x][y], z in a word.
using NodeBits = std::vector<std::uint64_t>;

class LayerAudit {
 public:
  LayerAudit(const Voxmap& map, std::string_view name)
      : name_(name), header_(map.header()), view_(map.view()), known_(known_box(header_)) {
    const bool euclidean = header_.metric == static_cast<std::uint32_t>(Metric::kEuclidean);
    const std::uint32_t layers =
        euclidean ? force_layers(std::min(force_layer_voxels(header_), 1e3)) : 1;
    steps_ = std::min<std::int64_t>(layers, kMostSteps);
    all_layers_ = layers <= kMostSteps;
    masks_.reserve(map.brick_count());
    for (std::uint32_t brick = 0; brick < map.brick_count(); ++brick) {
      masks_.push_back(masks_of(brick));
    }
  }

  Status run() {
    const auto& dims = view_.directory_dims;
    for (std::int64_t x = 0; x < dims[0] && !bad_; ++x) {
      for (std::int64_t y = 0; y < dims[1] && !bad_; ++y) {
        for (std::int64_t z = 0; z < dims[2] && !bad_; ++z) {
          Around around;
          for (std::size_t n = 0; n < around.size(); ++n) {
            const auto at = neighbor({x, y, z}, n);
            around[n] = cell(at);
          }
          visit(kUpperNodeEdge, world({x, y, z}), around);
        }
      }
    }
    return bad_ ? untrue(name_, voxel_text(bad_->at), bad_->what) : Status();
  }

 private:
  struct Masks {  // a word for each x, bit y*8 + z
    std::array<std::array<std::uint64_t, 8>, 3> of{};
  };
  struct Bad {
    Voxel at;
    const char* what;
  };

  static constexpr std::array<unsigned, 3> kSets{kInterior, kUpToSurface, kUpToProximity};

  Masks masks_of(std::uint32_t brick) const {
    Masks masks;
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const unsigned value = 1u << view_.brick_code(brick, n);
      for (std::size_t set = 0; set < kSets.size(); ++set) {
        masks.of[set][n >> 6] |= std::uint64_t{(kSets[set] & value) != 0} << (n & 63);
      }
    }
    return masks;
  }

  static Voxel neighbor(const Voxel& at, std::size_t n) {
    return {at[0] + static_cast<std::int64_t>(n / 9) - 1,
            at[1] + static_cast<std::int64_t>(n / 3 % 3) - 1,
            at[2] + static_cast<std::int64_t>(n % 3) - 1};
  }

  Voxel world(const Voxel& cell) const {
    Voxel low;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = header_.directory_origin[axis] + cell[axis] * kUpperNodeEdge;
    }
    return low;
  }

  static std::uint32_t without_clearance(std::uint32_t entry) {
    return is_uniform(entry) ? uniform_entry(uniform_value(entry)) : entry;
  }

  std::uint32_t cell(const Voxel& at) const {
    const auto& dims = view_.directory_dims;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (at[axis] < 0 || at[axis] >= dims[axis]) return kFreeEntry;
    }
    return without_clearance(view_.directory[(at[0] * dims[1] + at[1]) * dims[2] + at[2]]);
  }

  static bool is_certain(const Around& around) {
    if (around[kCenter] == kInteriorEntry) return true;
    return std::all_of(around.begin(), around.end(),
                       [](std::uint32_t entry) { return entry == kFreeEntry; });
  }

  // The cube at `low`, with an edge of 512 or 64 voxels.
  void visit(std::int64_t edge, const Voxel& low, const Around& around) {
    if (bad_ || is_certain(around)) return;
    const Span cube = Span::cube(low, edge);
    const Span known = known_part(cube, known_);
    if (known.empty()) return;
    const std::int64_t reach = steps_ + 1;
    const Span halo{{low[0] - reach, low[1] - reach, low[2] - reach},
                    {cube.high[0] + reach, cube.high[1] + reach, cube.high[2] + reach}};
    auto& seen = edge == kNode ? seen_nodes_ : seen_cells_;
    if (known_part(halo, known_) == halo && !seen.insert(around).second) return;
    if (edge == kNode) {
      check_node(low, around);
    } else {
      visit_children(low, around);
    }
  }

  void visit_children(const Voxel& low, const Around& around) {
    std::vector<std::uint32_t> children(1000);  // 10^3: the 8^3 of the cube, and one around them
    const auto index = [](std::int64_t x, std::int64_t y, std::int64_t z) {
      return static_cast<std::size_t>((x * 10 + y) * 10 + z);
    };
    for (std::int64_t x = 0; x < 10; ++x) {
      for (std::int64_t y = 0; y < 10; ++y) {
        for (std::int64_t z = 0; z < 10; ++z) {
          // Child 0 of the cube stands at index 1: (i + 7) / 8 is its cube's place in `around`.
          const std::uint32_t entry =
              around[static_cast<std::size_t>(((x + 7) / 8 * 3 + (y + 7) / 8) * 3 + (z + 7) / 8)];
          const std::int64_t slot = ((x + 7) % 8 * 8 + (y + 7) % 8) * 8 + (z + 7) % 8;
          children[index(x, y, z)] =
              is_uniform(entry)
                  ? entry
                  : without_clearance(view_.upper_nodes[std::int64_t{entry} * kNodeEntries + slot]);
        }
      }
    }
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const Voxel at = voxmap_walk::child_low({1, 1, 1}, n, 1);
      Around child_around;
      for (std::size_t i = 0; i < child_around.size(); ++i) {
        const Voxel beside = neighbor(at, i);
        child_around[i] = children[index(beside[0], beside[1], beside[2])];
      }
      visit(kNode, voxmap_walk::child_low(low, n, kNode), child_around);
    }
  }

  // The bricks first to last along z of row (x, y) of a cube of 64^3, as bits of `set`.
  std::uint64_t row(std::uint32_t entry, std::int64_t x, std::int64_t y, std::size_t set,
                    std::uint32_t first = 0, std::uint32_t last = 7) const {
    if (is_uniform(entry)) {
      return (kSets[set] >> uniform_value(entry)) & 1u ? ~std::uint64_t{0} : 0;
    }
    const std::uint32_t* bricks =
        view_.lower_nodes + std::uint64_t{entry} * kNodeEntries + (x >> 3) * 64 + (y >> 3) * 8;
    std::uint64_t bits = 0;
    for (std::uint32_t z = first; z <= last; ++z) {
      const std::uint32_t brick = bricks[z];
      std::uint64_t byte = 0;
      if (is_uniform(brick)) {
        byte = (kSets[set] >> uniform_value(brick)) & 1u ? 0xff : 0;
      } else {
        byte = masks_[brick].of[set][static_cast<std::size_t>(x & 7)] >> (8 * (y & 7)) & 0xff;
      }
      bits |= byte << (8 * z);
    }
    return bits;
  }

  // Row (x, y) from -63 to 126 of the cubes around, grown by `steps` along z.
  std::uint64_t grown_row(const Around& around, std::int64_t x, std::int64_t y, std::size_t set,
                          std::int64_t steps) const {
    const std::size_t column =
        static_cast<std::size_t>(((x + kNode) / kNode * 3 + (y + kNode) / kNode) * 3);
    const std::int64_t inner_x = x & (kNode - 1), inner_y = y & (kNode - 1);
    const auto side_bricks = static_cast<std::uint32_t>((steps + 7) / 8);
    const std::uint64_t below = row(around[column], inner_x, inner_y, set, 8 - side_bricks, 7);
    const std::uint64_t middle = row(around[column + 1], inner_x, inner_y, set);
    const std::uint64_t above = row(around[column + 2], inner_x, inner_y, set, 0, side_bricks - 1);
    std::uint64_t grown = middle;
    for (std::int64_t step = 1; step <= steps; ++step) {
      grown |= middle << step | middle >> step | below >> (64 - step) | above << (64 - step);
    }
    return grown;
  }

  // The voxels of the middle cube that lie within `steps` of one in `set`.
  NodeBits grown(const Around& around, std::size_t set, std::int64_t steps) const {
    const std::int64_t wide = kNode + 2 * steps;
    NodeBits along_z(static_cast<std::size_t>(wide));  // of one x
    NodeBits along_y(static_cast<std::size_t>(wide * kNode));
    for (std::int64_t x = 0; x < wide; ++x) {
      for (std::int64_t y = 0; y < wide; ++y) {
        along_z[static_cast<std::size_t>(y)] = grown_row(around, x - steps, y - steps, set, steps);
      }
      or_windows(along_z.data(), 1, steps, along_y.data() + x * kNode, 1);
    }
    NodeBits bits(static_cast<std::size_t>(kNode * kNode));
    for (std::int64_t y = 0; y < kNode; ++y) {
      or_windows(along_y.data() + y, kNode, steps, bits.data() + y, kNode);
    }
    return bits;
  }

  // to[i] = from[i] | ... | from[i + 2 steps], for 64 of them.
  static void or_windows(const std::uint64_t* from, std::int64_t from_stride, std::int64_t steps,
                         std::uint64_t* to, std::int64_t to_stride) {
    for (std::int64_t i = 0; i < kNode; ++i) {
      std::uint64_t any = 0;
      for (std::int64_t j = i; j <= i + 2 * steps; ++j) any |= from[j * from_stride];
      to[i * to_stride] = any;
    }
  }

  // The known voxels of the node at `low` that are at least `steps` from a cropped side.
  Span far_from_crop(const Voxel& low, std::int64_t steps) const {
    KnownBox inner = known_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (header_.cropped_sides >> (2 * axis) & 1u) inner.low[axis] += steps;
      if (header_.cropped_sides >> (2 * axis + 1) & 1u) inner.high[axis] -= steps;
    }
    return known_part(Span::cube(low, kNode), inner);
  }

  void check_node(const Voxel& low, const Around& around) {
    if (header_.offset_layers > 0 || has_standoff(header_)) {
      const NodeBits near = grown(around, 0, steps_);
      expect_none(
          low, far_from_crop(low, 0),
          [&](std::int64_t x, std::int64_t y) {
            return near[index(x, y)] & ~row(around[kCenter], x, y, 1);
          },
          "is neither interior nor surface, though it is within the force layers of an interior "
          "one");
      if (all_layers_) {
        expect_none(
            low, far_from_crop(low, steps_),
            [&](std::int64_t x, std::int64_t y) {
              return row(around[kCenter], x, y, 1) & ~near[index(x, y)];
            },
            "is surface, though no interior one is within the force layers of it");
      }
    }
    const NodeBits near = grown(around, 1, 1);
    expect_none(
        low, far_from_crop(low, 0),
        [&](std::int64_t x, std::int64_t y) {
          return near[index(x, y)] & ~row(around[kCenter], x, y, 2);
        },
        "is free, though it touches one that is interior or surface");
    expect_none(
        low, far_from_crop(low, 1),
        [&](std::int64_t x, std::int64_t y) {
          return row(around[kCenter], x, y, 2) & ~near[index(x, y)];
        },
        "is proximity, though it touches none that is interior or surface");
  }

  static std::size_t index(std::int64_t x, std::int64_t y) {
    return static_cast<std::size_t>(x * kNode + y);
  }

  // No bit of bits(x, y) may be set in `part` of the node at `low`.
  template <typename Bits>
  void expect_none(const Voxel& low, const Span& part, Bits bits, const char* what) {
    if (bad_ || part.empty()) return;
    const auto first = static_cast<unsigned>(part.low[2] - low[2]);
    const auto count = static_cast<unsigned>(part.high[2] - part.low[2]);
    const std::uint64_t in_part = (~std::uint64_t{0} >> (64 - count)) << first;
    for (std::int64_t x = part.low[0] - low[0]; x < part.high[0] - low[0]; ++x) {
      for (std::int64_t y = part.low[1] - low[1]; y < part.high[1] - low[1]; ++y) {
        const std::uint64_t wrong = bits(x, y) & in_part;
        if (wrong == 0) continue;
        bad_ = Bad{{low[0] + x, low[1] + y, low[2] + __builtin_ctzll(wrong)}, what};
        return;
      }
    }
  }

  std::string_view name_;
  const VoxmapHeader& header_;
  const VoxmapView& view_;
  KnownBox known_;
  std::int64_t steps_ = 1;  // force layers
  bool all_layers_ = true;  // steps_ is all of them
  std::vector<Masks> masks_;
  std::unordered_set<Around, AroundHash> seen_cells_, seen_nodes_;
  std::optional<Bad> bad_;
};

}  // namespace

Status audit_layers(const Voxmap& map, std::string_view name) {
  return LayerAudit(map, name).run();
}

}  // namespace forcelayer::voxmap_audit
