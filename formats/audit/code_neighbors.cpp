#include <algorithm>
#include <optional>
#include <vector>

#include "formats/audit/code_rules.h"
#include "formats/audit/effort.h"
#include "formats/audit/neighborhoods.h"
#include "formats/audit/parts.h"
#include "formats/bricks/unpacked_distances.h"

namespace forcelayer::voxmap_audit {
namespace {

constexpr std::uint32_t kFarEntry = uniform_entry(kMaxDistanceCode);

// Units of effort.
constexpr std::uint64_t kBrickUnits = 5'000, kPairsUnits = 300'000, kDescentUnits = 10'000;

// The bricks whose surroundings were looked at last. Walls repeat themselves nearby, and memory
// stays small.
class LastSeen {
 public:
  LastSeen() : slots_(std::size_t{1} << kBits) {
    for (Around& slot : slots_) slot.fill(~0u);  // which no entry is
  }

  // Whether these surroundings are not among those that were seen last.
  bool is_new(const Around& around) {
    Around& slot = slots_[AroundHash()(around) >> (64 - kBits)];
    if (slot == around) return false;
    slot = around;
    return true;
  }

 private:
  static constexpr unsigned kBits = 14;
  std::vector<Around> slots_;
};

class NeighborAudit {
 public:
  NeighborAudit(const Voxmap& map, Effort& effort, std::string_view name)
      : name_(name),
        header_(map.header()),
        view_(*map.distances()),
        unpacked_(view_, kSlotBits),
        known_(known_box(header_)),
        rules_(header_),
        effort_(effort) {}

  bool ended() const { return bad_ || effort_.is_spent(); }

  bool cell(const Voxel& low, const Around& around) {
    return is_new(Span::cube(low, kUpperNodeEdge), around, cells_);
  }

  void node(const Voxel& low, const Around& around) {
    if (!is_new(Span::cube(low, kLowerNodeEdge), around, nodes_)) return;
    bricks_.fill(around, view_.lower_nodes);
    for (std::uint32_t n = 0; n < kNodeEntries && !ended(); ++n) {
      look(voxmap_walk::child_low(low, n, kBrickEdge), bricks_.around(n));
    }
  }

  Status status() const {
    if (bad_) return *bad_;
    return effort_.is_spent() ? Status(strewn(name_)) : Status();
  }

 private:
  static constexpr unsigned kSlotBits = 12;

  // Whether one code that no voxel needs to lead from is all that there is.
  bool is_even(const Around& around) const {
    const std::uint32_t entry = around[kCenter];
    if (!is_uniform(entry)) return false;
    const std::uint32_t code = uniform_wide_value(entry);
    return rules_.may_lead_to_mesh(code, code) &&
           std::all_of(around.begin(), around.end(), [&](std::uint32_t e) { return e == entry; });
  }

  bool is_known(const Span& box) const {
    return header_.cropped_sides == 0 || known_part(box, known_) == box;
  }

  // Whether a cube is to be looked at: some of it is known, it can break a rule, and its like was
  // not looked at before, in a place where all around is known.
  bool is_new(const Span& cube, const Around& around, AroundSet& seen) {
    if (is_even(around) || known_part(cube, known_).empty()) return false;
    return !is_known(grown(cube, CodeCube::kHalo)) || seen.is_new(around, effort_);
  }

  void look(const Voxel& low, const Around& around) {
    if (is_even(around)) return;
    const Span brick = Span::cube(low, kBrickEdge);
    const bool known = is_known(grown(brick, CodeCube::kHalo));
    if (known ? !seen_.is_new(around) : known_part(brick, known_).empty()) return;
    effort_.spend(kBrickUnits);
    fill_cube(around);
    if (!known) replace_unknown(low);
    if (!rules_.surely_beside_codes(cube_)) {
      effort_.spend(kPairsUnits);
      for_each_known(low, known, [&](int x, int y, int z) { check_pairs(low, x, y, z); });
    }
    if (!known || !rules_.lie_between(cube_)) {
      effort_.spend(kDescentUnits);
      for_each_known(low, known, [&](int x, int y, int z) { check_between(low, x, y, z, known); });
    }
    if (!known || !rules_.surely_lead_to_mesh(cube_)) {
      effort_.spend(kDescentUnits);
      for_each_known(low, known, [&](int x, int y, int z) { check_descent(low, x, y, z); });
    }
  }

  void fill_cube(const Around& around) {
    for (std::size_t n = 0; n < kDirections; ++n) {
      const Voxel d = direction(n);
      const auto at = [&](std::size_t axis) { return static_cast<int>(d[axis]); };
      if (is_uniform(around[n])) {
        uniform_.fill(static_cast<std::uint8_t>(uniform_wide_value(around[n])));
        cube_.put(at(0), at(1), at(2), uniform_);
      } else {
        cube_.put(at(0), at(1), at(2), unpacked_.brick(around[n]));
      }
    }
  }

  // Codes that are not known become those of the nearest known voxels: where codes may be apart by
  // a step, they surely may by less.
  void replace_unknown(const Voxel& low) {
    const Span cube = known_part(grown(Span::cube(low, kBrickEdge), CodeCube::kHalo), known_);
    const CodeCube stored = cube_;
    const auto nearest = [&](std::size_t axis, int at) {
      return static_cast<int>(
          std::clamp<std::int64_t>(low[axis] + at, cube.low[axis], cube.high[axis] - 1) -
          low[axis]);
    };
    for (int x = -CodeCube::kHalo; x < 8 + CodeCube::kHalo; ++x) {
      for (int y = -CodeCube::kHalo; y < 8 + CodeCube::kHalo; ++y) {
        for (int z = -CodeCube::kHalo; z < 8 + CodeCube::kHalo; ++z) {
          cube_.set(x, y, z, stored.at(nearest(0, x), nearest(1, y), nearest(2, z)));
        }
      }
    }
  }

  bool is_known_at(const Voxel& low, int x, int y, int z) const {
    return is_known(Span::cube({low[0] + x, low[1] + y, low[2] + z}, 1));
  }

  template <class Check>
  void for_each_known(const Voxel& low, bool all_known, Check check) const {
    for (int x = 0; x < 8 && !bad_; ++x) {
      for (int y = 0; y < 8; ++y) {
        for (int z = 0; z < 8; ++z) {
          if (all_known || is_known_at(low, x, y, z)) check(x, y, z);
        }
      }
    }
  }

  void check_between(const Voxel& low, int x, int y, int z, bool all_known) {
    const std::uint32_t code = cube_.at(x, y, z);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int dx = axis == 0, dy = axis == 1, dz = axis == 2;
      const std::uint32_t a = cube_.at(x - dx, y - dy, z - dz),
                          b = cube_.at(x + dx, y + dy, z + dz);
      if (rules_.may_lie_between(code, a, b)) continue;
      if (!all_known &&
          !(is_known_at(low, x - dx, y - dy, z - dz) && is_known_at(low, x + dx, y + dy, z + dz))) {
        continue;
      }
      return refuse(low, x, y, z,
                    " contradicts the codes " + code_text(a) + " and " + code_text(b) +
                        " of two opposite neighbors: at least one of these neighbors must be "
                        "nearer to the mesh");
    }
  }

  void check_pairs(const Voxel& low, int x, int y, int z) {
    const std::uint32_t code = cube_.at(x, y, z);
    for (const Step& step : kNearSteps) {
      const int to[3] = {x + step.x, y + step.y, z + step.z};
      const std::uint32_t other = cube_.at(to[0], to[1], to[2]);
      if (rules_.beside_code(step, code, other) || !is_known_at(low, to[0], to[1], to[2])) continue;
      return refuse(low, x, y, z,
                    " differs from code " + code_text(other) + " of " +
                        voxel_text({low[0] + to[0], low[1] + to[1], low[2] + to[2]}) +
                        " by more than the distance between the two voxels");
    }
  }

  void check_descent(const Voxel& low, int x, int y, int z) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        int to[3] = {x, y, z};
        to[axis] += side;
        if (!is_known_at(low, to[0], to[1], to[2])) return;
        if (rules_.may_lead_to_mesh(cube_.at(x, y, z), cube_.at(to[0], to[1], to[2]))) return;
      }
    }
    refuse(low, x, y, z,
           " contradicts the codes of its neighbors: at least one neighbor must be nearer to the "
           "mesh");
  }

  void refuse(const Voxel& low, int x, int y, int z, const std::string& why) {
    bad_ = untrue(name_, voxel_text({low[0] + x, low[1] + y, low[2] + z}),
                  "the code " + code_text(cube_.at(x, y, z)) + why);
  }

  std::string code_text(std::uint32_t code) const {
    return std::to_string(code) + " (" + range_text(header_, code) + ")";
  }

  std::string_view name_;
  const VoxmapHeader& header_;
  const DistanceView& view_;
  UnpackedDistances unpacked_;
  KnownBox known_;
  CodeRules rules_;
  Effort& effort_;
  AroundSet cells_, nodes_;
  LastSeen seen_;
  ChildGrid bricks_;
  CodeCube cube_;
  BrickCodes uniform_{};
  std::optional<Error> bad_;
};

}  // namespace

Status audit_code_neighbors(const Voxmap& map, Effort& effort, std::string_view name) {
  NeighborAudit audit(map, effort, name);
  // One cell more on each side: voxels outside of the directory have neighbors in it.
  NeighborhoodWalk walk(*map.distances(), audit, effort, kFarEntry, 1);
  walk.run();
  return audit.status();
}

}  // namespace forcelayer::voxmap_audit
