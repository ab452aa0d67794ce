#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <vector>

#include "formats/audit/contents.h"
#include "formats/audit/effort.h"
#include "formats/audit/neighborhoods.h"
#include "formats/audit/node_rows.h"
#include "formats/audit/parts.h"

namespace forcelayer::voxmap_audit {
namespace {

constexpr std::int64_t kNode = NodeRows::kNode;
// A node and what lies around it are looked at, up to 63 voxels away.
constexpr std::uint32_t kMaxLayers = 32;

// The voxels that k layers make of one voxel of the mesh, or of one that the mesh encloses
// (voxmap_format.md, section 13.6): all within `cube`, and along each axis within `line`, is
// interior. No interior voxel is farther than `reach` from such a one.
struct Core {
  std::int64_t cube, line, reach;
};

Core core_of(const VoxmapHeader& h) {
  const std::int64_t k = h.offset_layers;
  if (h.metric == static_cast<std::uint32_t>(Metric::kChebyshev)) return {k - 1, k - 1, k - 1};
  constexpr double kRounding = 1e-6;
  const double radius = interior_radius_voxels(h.offset_layers) - kRounding;
  return {static_cast<std::int64_t>(std::floor(radius / std::sqrt(3.0) - 0.5)),
          static_cast<std::int64_t>(std::floor(std::sqrt(radius * radius - 0.5) - 0.5)), k};
}

// A set of voxels: rows of 192 along z, from 64 below a node to 64 above it, and `margin` rows on
// each side of its 64 along x and y.
class Set {
 public:
  using Row = std::array<std::uint64_t, 3>;

  explicit Set(std::int64_t margin)
      : margin_(margin),
        width_(kNode + 2 * margin),
        rows_(static_cast<std::size_t>(width_ * width_)) {}

  std::int64_t margin() const { return margin_; }
  std::uint64_t words() const { return 3 * rows_.size(); }
  Row& row(std::int64_t x, std::int64_t y) { return rows_[index(x, y)]; }
  const Row& row(std::int64_t x, std::int64_t y) const { return rows_[index(x, y)]; }

  // The voxels that lie within `steps`, below 64, of one of the set along an axis.
  Set grown(std::size_t axis, std::int64_t steps) const {
    Set more = *this;
    for (std::int64_t x = -margin_; x < kNode + margin_; ++x) {
      for (std::int64_t y = -margin_; y < kNode + margin_; ++y) {
        Row& to = more.row(x, y);
        for (std::int64_t step = 1; step <= steps; ++step) {
          if (axis == 2) {
            unite(to, shifted(row(x, y), static_cast<unsigned>(step)));
            continue;
          }
          for (const std::int64_t side : {-step, step}) {
            const std::int64_t from_x = axis == 0 ? x + side : x, from_y = axis == 1 ? y + side : y;
            if (holds(from_x) && holds(from_y)) unite(to, row(from_x, from_y));
          }
        }
      }
    }
    return more;
  }
  Set grown(std::int64_t steps) const { return grown(2, steps).grown(1, steps).grown(0, steps); }
  Set others() const {
    Set others = *this;
    for (Row& row : others.rows_) {
      for (std::uint64_t& word : row) word = ~word;
    }
    return others;
  }
  void add(const Set& other) {
    for (std::size_t i = 0; i < rows_.size(); ++i) unite(rows_[i], other.rows_[i]);
  }

 private:
  std::size_t index(std::int64_t x, std::int64_t y) const {
    return static_cast<std::size_t>((x + margin_) * width_ + y + margin_);
  }
  bool holds(std::int64_t at) const { return at >= -margin_ && at < kNode + margin_; }
  static void unite(Row& to, const Row& from) {
    for (std::size_t i = 0; i < 3; ++i) to[i] |= from[i];
  }
  // Up and down by a step.
  static Row shifted(const Row& row, unsigned step) {
    const auto& [a, b, c] = row;
    return {a << step | a >> step | b << (64 - step),
            b << step | b >> step | a >> (64 - step) | c << (64 - step),
            c << step | c >> step | b >> (64 - step)};
  }

  std::int64_t margin_, width_;
  std::vector<Row> rows_;
};

class LayerCountAudit {
 public:
  LayerCountAudit(const Voxmap& map, const Contents& contents, Effort& effort,
                  std::string_view name)
      : name_(name),
        header_(map.header()),
        known_(known_box(header_)),
        core_(core_of(header_)),
        margin_(core_.reach + core_.line),
        rows_(contents.planes(), map.view(), margin_),
        effort_(effort) {}

  bool ended() const { return bad_ || effort_.is_spent(); }

  bool cell(const Voxel& low, const Around& around) {
    return is_new(Span::cube(low, kUpperNodeEdge), around, cells_);
  }

  void node(const Voxel& low, const Around& around) {
    if (is_new(Span::cube(low, kNode), around, nodes_)) check_node(low, around);
  }

  Status status() const {
    if (bad_) {
      return untrue(name_, voxel_text(*bad_),
                    "is interior, but " + std::to_string(header_.offset_layers) +
                        " offset layers require a wider interior around this voxel");
    }
    return effort_.is_spent() ? Status(strewn(name_)) : Status();
  }

 private:
  // Uniform cubes are as wide as the most layers.
  bool is_new(const Span& cube, const Around& around, AroundSet& seen) {
    if (is_uniform(around[kCenter]) || known_part(cube, known_).empty()) return false;
    const Span halo = grown(cube, margin_);
    return !(known_part(halo, known_) == halo) || seen.is_new(around, effort_);
  }

  void check_node(const Voxel& low, const Around& around) {
    rows_.fill(around);
    const Set interior = interior_at(low);
    const std::uint64_t growths = static_cast<std::uint64_t>(
        3 * core_.line + 3 * std::max<std::int64_t>(core_.cube, 0) + 3 * core_.reach);
    effort_.spend(interior.words() * (20 + growths));
    const Set outside = interior.others();
    Set no_core = outside.grown(core_.cube);
    for (std::size_t axis = 0; axis < 3; ++axis) no_core.add(outside.grown(axis, core_.line));
    const Set near_core = no_core.others().grown(core_.reach);
    const Span part = known_part(Span::cube(low, kNode), known_);
    for (std::int64_t x = part.low[0] - low[0]; x < part.high[0] - low[0]; ++x) {
      for (std::int64_t y = part.low[1] - low[1]; y < part.high[1] - low[1]; ++y) {
        const std::uint64_t own = rows_.plane(NodeRows::kInterior, x)[y];
        const std::uint64_t wrong =
            own & ~near_core.row(x, y)[1] & bits(part.low[2] - low[2], part.high[2] - low[2]);
        if (wrong == 0) continue;
        bad_ = Voxel{low[0] + x, low[1] + y, low[2] + std::countr_zero(wrong)};
        return;
      }
    }
  }

  // Voxels that are not known may be interior.
  Set interior_at(const Voxel& low) const {
    Set set(margin_);
    const auto known = [&](std::size_t axis, std::int64_t at) {
      return low[axis] + at >= known_.low[axis] && low[axis] + at < known_.high[axis];
    };
    std::array<std::uint64_t, 3> unknown{};
    for (std::int64_t z = -kNode; z < 2 * kNode; ++z) {
      if (!known(2, z)) unknown[static_cast<std::size_t>((z + kNode) / kNode)] |= 1ull << (z & 63);
    }
    for (std::int64_t x = -margin_; x < kNode + margin_; ++x) {
      for (std::int64_t y = -margin_; y < kNode + margin_; ++y) {
        const bool in = known(0, x) && known(1, y);
        const NodeRows::Column column = rows_.column(NodeRows::kInterior, x, y);
        for (std::size_t i = 0; i < 3; ++i) {
          set.row(x, y)[i] = in ? column[i] | unknown[i] : ~std::uint64_t{0};
        }
      }
    }
    return set;
  }

  // From `begin` to below `end`, 0 to 64.
  static std::uint64_t bits(std::int64_t begin, std::int64_t end) {
    return (~std::uint64_t{0} >> (64 - (end - begin))) << begin;
  }

  std::string_view name_;
  const VoxmapHeader& header_;
  KnownBox known_;
  Core core_;
  std::int64_t margin_;
  NodeRows rows_;
  Effort& effort_;
  AroundSet cells_, nodes_;
  std::optional<Voxel> bad_;
};

}  // namespace

Status audit_layer_count(const Voxmap& map, const Contents& contents, Effort& effort,
                         std::string_view name) {
  const VoxmapHeader& h = map.header();
  if (h.offset_layers < 2) return {};  // promises nothing
  if (h.offset_layers > kMaxLayers) {
    return untrue(name, "header (offset_layers)",
                  "is " + std::to_string(h.offset_layers) +
                      ", but without stored distances at most " + std::to_string(kMaxLayers) +
                      " layers can be checked");
  }
  LayerCountAudit audit(map, contents, effort, name);
  NeighborhoodWalk walk(map.view(), audit, effort);
  walk.run();
  return audit.status();
}

}  // namespace forcelayer::voxmap_audit
