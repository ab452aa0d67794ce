#include <algorithm>
#include <bit>
#include <optional>
#include <vector>

#include "formats/audit/contents.h"
#include "formats/audit/neighborhoods.h"
#include "formats/audit/node_rows.h"
#include "formats/audit/parts.h"

namespace forcelayer::voxmap_audit {
namespace {

// Units of effort: a node, and more for each step of its growth.
constexpr std::uint64_t kNodeUnits = 300'000, kStepUnits = 50'000;

constexpr std::int64_t kNode = NodeRows::kNode;
constexpr std::int64_t kMaxSteps = kNode - 1;  // of one growth: the node and those around it

class LayerAudit {
 public:
  LayerAudit(const Voxmap& map, const Contents& contents, Effort& effort, std::string_view name)
      : name_(name),
        header_(map.header()),
        contents_(contents),
        known_(known_box(header_)),
        steps_(std::min<std::int64_t>(layers_of(header_), kMaxSteps)),
        all_layers_(layers_of(header_) <= kMaxSteps),
        rows_(contents.planes(), map.view(), steps_),
        effort_(effort) {}

  bool ended() const { return bad_ || effort_.is_spent(); }

  bool cell(const Voxel& low, const Around& around) {
    return is_new(Span::cube(low, kUpperNodeEdge), around, cells_);
  }

  void node(const Voxel& low, const Around& around) {
    if (is_new(Span::cube(low, kNode), around, nodes_)) check_node(low, around);
  }

  Status status() const {
    if (bad_) return untrue(name_, voxel_text(bad_->at), bad_->what);
    return effort_.is_spent() ? Status(strewn(name_)) : Status();
  }

 private:
  struct Bad {
    Voxel at;
    const char* what;
  };

  static std::uint32_t layers_of(const VoxmapHeader& h) {
    const bool euclidean = h.metric == static_cast<std::uint32_t>(Metric::kEuclidean);
    return euclidean ? force_layers(std::min(force_layer_voxels(h), 1e3)) : 1;
  }

  static bool is_certain(const Around& around) {
    if (around[kCenter] == kInteriorEntry) return true;
    return std::all_of(around.begin(), around.end(),
                       [](std::uint32_t entry) { return entry == kFreeEntry; });
  }

  // Whether a cube is to be looked at: it can break a rule, some of it is known, and its like was
  // not looked at before, in a place where all around is known.
  bool is_new(const Span& cube, const Around& around, AroundSet& seen) {
    if (is_certain(around) || known_part(cube, known_).empty()) return false;
    const Span halo = grown(cube, steps_ + 1);
    return !(known_part(halo, known_) == halo) || seen.is_new(around, effort_);
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

  static auto rows_of(const NodeRows::Rows& rows) {
    return [&rows](std::int64_t x) { return &rows[static_cast<std::size_t>(x * kNode)]; };
  }

  // Whether a free node lies farther than the layers reach from all that is not free.
  bool is_far(const Around& around) const {
    if (around[kCenter] != kFreeEntry) return false;
    for (std::size_t d = 0; d < kDirections; ++d) {
      if (around[d] == kFreeEntry) continue;
      // The neighbor's gap towards the middle.
      if (is_uniform(around[d]) || contents_.node_gaps(around[d])[kDirections - 1 - d] < steps_) {
        return false;
      }
    }
    return true;
  }

  void check_node(const Voxel& low, const Around& around) {
    if (is_far(around)) return;
    effort_.spend(kNodeUnits + kStepUnits * static_cast<std::uint64_t>(steps_));
    rows_.fill(around);
    const auto row = [&](NodeRows::Set set) {
      return [this, set](std::int64_t x) { return rows_.plane(set, x); };
    };
    if (header_.offset_layers > 0 || has_standoff(header_)) {
      const NodeRows::Rows& near = rows_.grown(NodeRows::kInterior, steps_);
      expect_within(
          low, far_from_crop(low, 0), rows_of(near), row(NodeRows::kUpToSurface),
          "is proximity or free, but so near an interior voxel that it must be in the force layer");
      if (all_layers_) {
        expect_within(low, far_from_crop(low, steps_), row(NodeRows::kUpToSurface), rows_of(near),
                      "is in the force layer, but no interior voxel is near enough");
      }
    }
    const NodeRows::Rows& near = rows_.grown(NodeRows::kUpToSurface, 1);
    expect_within(low, far_from_crop(low, 0), rows_of(near), row(NodeRows::kUpToProximity),
                  "is free, but lies beside an interior or force layer voxel");
    expect_within(low, far_from_crop(low, 1), row(NodeRows::kUpToProximity), rows_of(near),
                  "is proximity, but lies beside no interior or force layer voxel");
  }

  // Every bit of the rows one(x) in `part` of the node at `low` must be one of other(x).
  template <typename One, typename Other>
  void expect_within(const Voxel& low, const Span& part, One one, Other other, const char* what) {
    if (bad_ || part.empty()) return;
    const auto first = static_cast<unsigned>(part.low[2] - low[2]);
    const auto count = static_cast<unsigned>(part.high[2] - part.low[2]);
    const std::uint64_t in_part = (~std::uint64_t{0} >> (64 - count)) << first;
    const std::int64_t begin = part.low[1] - low[1], end = part.high[1] - low[1];
    for (std::int64_t x = part.low[0] - low[0]; x < part.high[0] - low[0]; ++x) {
      const std::uint64_t *wanted = one(x), *there = other(x);
      std::uint64_t wrong = 0;
      for (std::int64_t y = begin; y < end; ++y) wrong |= wanted[y] & ~there[y];
      if ((wrong & in_part) == 0) continue;
      std::int64_t y = begin;
      while ((wanted[y] & ~there[y] & in_part) == 0) ++y;
      const int z = std::countr_zero(wanted[y] & ~there[y] & in_part);
      bad_ = Bad{{low[0] + x, low[1] + y, low[2] + z}, what};
      return;
    }
  }

  std::string_view name_;
  const VoxmapHeader& header_;
  const Contents& contents_;
  KnownBox known_;
  std::int64_t steps_;  // force layers
  bool all_layers_;     // steps_ is all of them
  NodeRows rows_;
  Effort& effort_;
  AroundSet cells_, nodes_;
  std::optional<Bad> bad_;
};

}  // namespace

Status audit_layers(const Voxmap& map, const Contents& contents, Effort& effort,
                    std::string_view name) {
  LayerAudit audit(map, contents, effort, name);
  // One cell more on each side: voxels outside of the directory are free, and touch those in it.
  NeighborhoodWalk walk(map.view(), audit, effort, kFreeEntry, 1);
  walk.run();
  return audit.status();
}

}  // namespace forcelayer::voxmap_audit
