#include "voxelize/distance/distance_codes.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "formats/lattice/brick_bits.h"
#include "formats/voxmap_format.h"
#include "voxelize/distance/inside_test.h"
#include "voxelize/distance/lines_of_sight.h"

namespace forcelayer::distance {
namespace {

// The largest distance that decides a code, of voxels outside the solid and of those inside.
float outer_reach(const CodeScale& scale) {
  return static_cast<float>(scale.min_of(kMaxDistanceCode)) + kKernelErrorVoxels;
}
float inner_reach(const CodeScale& scale) {
  return static_cast<float>(std::max(0.0, -scale.min_of(1)));
}

// Measures one 64^3 node at a time.
class NodeMeasurement {
 public:
  const NodeDistances& run(const SceneTriangles& triangles, const lattice::VoxelIndex& scene_origin,
                           const masks::MaskTree& geometry, const masks::MaskTree& interior,
                           const CodeScale& scale, const masks::KeptBox& kept,
                           const CenterGrowth* growth, std::span<const std::uint16_t> numbers,
                           const masks::Coord& origin) {
    scale_ = &scale;
    growth_ = growth;
    if (growth != nullptr) node_.grown = {};
    tells_objects_ = !numbers.empty();
    scene_ = &triangles;
    interior_ = &interior;
    geometry_ = &geometry;
    origin_ = origin;
    masks::node_rows(interior, origin, node_.solid);
    masks::node_rows(geometry, origin, surface_);
    node_.measured = {};
    for (std::size_t d = 0; d < 3; ++d) {
      index_[d] = (origin[static_cast<int>(d)] + scene_origin[d]) >> 6;
    }
    triangles.gather(index_, near_);
    sight_.begin_node();
    if (tells_objects_) choice_.begin(numbers, near_);
    const float outer = std::max(outer_reach(scale), inner_reach(scale));
    const float inner = inner_reach(scale);
    search_.run(
        near_,
        [&](const std::array<int, 3>& low, int edge) {
          return !masks::all_set(node_.solid, low, edge) ? outer : inner > 0 ? inner : kNoReach;
        },
        [&](const std::array<int, 3>& low, TriangleList list, TriangleList around) {
          measure(low, list, around, outer, inner);
        });
    if (kept.cropped()) crop(kept);
    if (tells_objects_) {
      node_.objects = &choice_.finish(node_.measured, node_.codes.data(), kept, origin);
    }
    return node_;
  }

 private:
  // Byte z is 255 where bit z of `bits` is set, and 0 elsewhere.
  static std::uint64_t bytes_of_bits(unsigned bits) {
    constexpr std::uint64_t kOnes = 0x0101010101010101;
    const std::uint64_t chosen = (bits * kOnes) & 0x8040201008040201;
    return ((chosen + 0x7f * kOnes) >> 7 & kOnes) * 0xff;
  }

  // The codes of brick n for writing. At first they read as if no surface were near.
  std::uint8_t* measured(unsigned n) {
    std::uint8_t* codes = node_.codes.data() + n * kBrickVoxels;
    if (test(node_.measured, n)) return codes;
    set(node_.measured, n);
    static_assert(kMaxDistanceCode == 0xff);
    for (unsigned row = 0; row < 64; ++row) {
      const std::uint64_t open = ~bytes_of_bits(node_.solid_row(n, row));
      std::memcpy(codes + 8 * row, &open, 8);
    }
    return codes;
  }

  // A cell of 4^3 voxels.
  void measure(const std::array<int, 3>& low, TriangleList list, TriangleList around, float outer,
               float inner) {
    const std::uint64_t solid = masks::cell_bits(node_.solid, low);
    std::array<float, kEighths> reach;
    for (unsigned n = 0; n < kEighths; ++n) {
      const bool all_solid = (solid & eighth(n)) == eighth(n);
      reach[n] = (!all_solid  ? outer
                  : inner > 0 ? inner
                              : kNoReach) *
                 static_cast<float>(lattice::kSnapUnits);
    }
    nearest_.find(list, low, reach);
    if (growth_ != nullptr) {
      masks::add_cell_bits(growth_->near(nearest_.smallest(), ~solid, list, index_, low), low,
                           node_.grown);
    }
    if (encode(low, solid, list, around) && tells_objects_) choice_.add(low, list, reach, nearest_);
  }

  // Whether one of the codes is measured.
  bool encode(const std::array<int, 3>& low, std::uint64_t solid, TriangleList list,
              TriangleList around) {
    std::uint64_t negative = solid;
    listed_ = kNotListed;
    for (std::uint64_t left = masks::cell_bits(surface_, low) & ~solid; left != 0;
         left &= left - 1) {
      const int n = std::countr_zero(left);
      const PreparedTriangle& nearest = *list[nearest_.which(static_cast<std::size_t>(n))];
      negative |= std::uint64_t{lies_inside(nearest, low, n, list, around)} << n;
    }
    std::array<std::uint8_t, kCubePoints> codes;
    codes_of_distances(nearest_.smallest(), negative, *scale_, codes.data());
    const auto brick = static_cast<unsigned>((low[0] >> 3) << 6 | (low[1] >> 3) << 3 | low[2] >> 3);
    std::uint8_t* out = measured(brick) + (low[0] & 7) * 64 + (low[1] & 7) * 8 + (low[2] & 7);
    for (int n = 0; n < 16; ++n) {
      std::memcpy(out + (n >> 2) * 64 + (n & 3) * 8, codes.data() + 4 * n, 4);
    }
    unsigned any = 0;  // not std::any_of: vectors take all at once
    for (const std::uint8_t code : codes) any |= is_measured(code);
    return any != 0;
  }

  // The side of the surface on which a voxel of the node, or beside it, lies.
  enum class Side { kSurface, kInside, kOutside };
  Side side_of(const std::array<int, 3>& voxel) const {
    const bool in_node = ((voxel[0] | voxel[1] | voxel[2]) & ~63) == 0;
    const masks::Coord at = origin_ + masks::Coord(voxel[0], voxel[1], voxel[2]);
    const auto row = static_cast<std::size_t>(voxel[0] * 64 + voxel[1]);
    const auto holds = [&](const masks::NodeRows& rows, const masks::MaskTree& tree) {
      return in_node ? (rows[row] >> voxel[2] & 1) != 0 : tree.isValueOn(at);
    };
    if (holds(node_.solid, *interior_)) return Side::kInside;
    return holds(surface_, *geometry_) ? Side::kSurface : Side::kOutside;
  }

  // Whether voxel n of a cell, through which the surface passes, has its center inside. The vector
  // from the surface's nearest point to the center leads to the center's side. 1.25 voxels further
  // along it lies a voxel that this piece of surface does not pass through: inside or outside. At
  // an edge it may lie in another piece; then the voxels decide that the center sees. A wall may be
  // so thin that it has no voxel inside. There a closed surface itself decides.
  bool lies_inside(const PreparedTriangle& nearest, const std::array<int, 3>& low, int n,
                   TriangleList list, TriangleList around) {
    constexpr double kOnwards = 1.25;
    const std::array<int, 3> voxel{low[0] + (n >> 4), low[1] + (n >> 2 & 3), low[2] + (n & 3)};
    std::array<double, 3> center;
    for (std::size_t d = 0; d < 3; ++d) center[d] = (voxel[d] + 0.5) * double{lattice::kSnapUnits};
    const std::array<double, 3> away = offset_from(nearest, center);
    const double length = std::sqrt(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]);
    if (!(length > 0)) return false;
    // A component of half a voxel or more leads to the next voxel along its axis.
    const double half = 0.5 / kOnwards * length;
    std::array<int, 3> onwards;
    for (std::size_t d = 0; d < 3; ++d) {
      onwards[d] = voxel[d] + (away[d] >= half) - (away[d] < -half);
    }
    const Side side = side_of(onwards);
    if (side == Side::kInside) return true;
    if (is_behind(*scene_, index_, center, away, nearest, near_voxel(n, list))) return true;
    if (side == Side::kOutside) return false;
    return has_inside_around(voxel) && sees_inside(voxel, low, around);
  }

  // The triangles of a cell that may be the nearest to its voxel n. All of the cell's where they
  // are of one component, which alone can hold the voxel's center then.
  NearTriangles near_voxel(int n, TriangleList list) {
    if (listed_ == kNotListed) listed_ = are_mixed(list) ? 0 : kNotMixed;
    if (listed_ == kNotMixed) return {list, false};
    const auto number = static_cast<unsigned>((n >> 5) * 4 + (n >> 3 & 1) * 2 + (n >> 1 & 1));
    std::vector<const PreparedTriangle*>& near = in_eighths_[number];
    if ((listed_ >> number & 1) == 0) {
      listed_ |= 1u << number;
      near.clear();
      for (std::size_t i = 0; i < list.size(); ++i) {
        if ((nearest_.measured_in(i) >> number & 1) != 0) near.push_back(list[i]);
      }
      mixed_ = are_mixed(near) ? mixed_ | 1u << number : mixed_ & ~(1u << number);
    }
    return {near, (mixed_ >> number & 1) != 0};
  }

  // Whether one of the voxels that sees_inside() looks at lies inside.
  bool has_inside_around(const std::array<int, 3>& voxel) const {
    constexpr int kFar = LinesOfSight::kFar;
    std::array<int, 3> low, high;  // of those in the node
    bool in_node = true;
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::max(voxel[d] - kFar, 0);
      high[d] = std::min(voxel[d] + kFar, 63);
      in_node &= high[d] - low[d] == 2 * kFar;
    }
    std::uint64_t any = 0;
    for (int x = low[0]; x <= high[0]; ++x) {
      for (int y = low[1]; y <= high[1]; ++y)
        any |= node_.solid[static_cast<std::size_t>(x * 64 + y)];
    }
    if ((any >> low[2] & ((std::uint64_t{2} << (high[2] - low[2])) - 1)) != 0) return true;
    return !in_node && has_inside_beside(voxel);
  }

  // The same of those that lie in other nodes.
  bool has_inside_beside(const std::array<int, 3>& voxel) const {
    constexpr int kFar = LinesOfSight::kFar;
    for (int x = voxel[0] - kFar; x <= voxel[0] + kFar; ++x) {
      for (int y = voxel[1] - kFar; y <= voxel[1] + kFar; ++y) {
        for (int z = voxel[2] - kFar; z <= voxel[2] + kFar; ++z) {
          if (((x | y | z) & ~63) == 0) continue;
          if (interior_->isValueOn(origin_ + masks::Coord(x, y, z))) return true;
        }
      }
    }
    return false;
  }

  // Whether the nearest voxels without surface that a voxel's center sees all lie inside.
  bool sees_inside(const std::array<int, 3>& voxel, const std::array<int, 3>& low,
                   TriangleList around) {
    sight_.begin(low, around, voxel);
    for (const Ring& ring : rings()) {
      std::array<LinesOfSight::Offset, LinesOfSight::kMaxLines> lines;
      std::size_t count = 0;
      std::uint32_t inside = 0;
      for (const LinesOfSight::Offset& offset : ring) {
        const Side side =
            side_of({voxel[0] + offset[0], voxel[1] + offset[1], voxel[2] + offset[2]});
        if (side == Side::kSurface) continue;
        if (side == Side::kInside) inside |= 1u << count;
        lines[count++] = offset;
      }
      if (count == 0) continue;
      const std::uint32_t seen = sight_.free({lines.data(), count});
      if (seen != 0) return (seen & ~inside) == 0;
    }
    return false;
  }

  // The voxels at one distance around a voxel; from near to far.
  using Ring = std::vector<LinesOfSight::Offset>;
  static const std::vector<Ring>& rings() {
    static const std::vector<Ring> rings = [] {
      constexpr int kFar = LinesOfSight::kFar;
      std::map<int, Ring> by_square;
      for (int x = -kFar; x <= kFar; ++x) {
        for (int y = -kFar; y <= kFar; ++y) {
          for (int z = -kFar; z <= kFar; ++z) {
            by_square[x * x + y * y + z * z].push_back({static_cast<std::int8_t>(x),
                                                        static_cast<std::int8_t>(y),
                                                        static_cast<std::int8_t>(z)});
          }
        }
      }
      by_square.erase(0);
      std::vector<Ring> ordered;
      for (auto& [square, ring] : by_square) ordered.push_back(std::move(ring));
      return ordered;
    }();
    return rings;
  }

  void crop(const masks::KeptBox& kept) {
    for (unsigned n = 0; n < 512; ++n) {
      const masks::Coord brick = masks::entry_origin(origin_, n, 8);
      if (kept.box.isInside(openvdb::CoordBBox::createCube(brick, 8))) continue;
      std::uint8_t* codes = measured(n);
      for (unsigned v = 0; v < kBrickVoxels; ++v) {
        if (!kept.box.isInside(masks::entry_origin(brick, v, 1))) codes[v] = kMaxDistanceCode;
      }
    }
  }

  const CodeScale* scale_ = nullptr;
  const SceneTriangles* scene_ = nullptr;
  const masks::MaskTree *interior_ = nullptr, *geometry_ = nullptr;
  const CenterGrowth* growth_ = nullptr;
  masks::Coord origin_;
  scan::NodeIndex index_;
  NodeDistances node_;
  masks::NodeRows surface_;
  std::vector<PreparedTriangle> near_;
  LinesOfSight sight_;
  CellSearch search_;
  NearestTriangles nearest_;
  // For near_voxel(): lists for the cell's eighths. As bits, the eighths whose list is made, and
  // those whose list has more than one component.
  std::array<std::vector<const PreparedTriangle*>, kEighths> in_eighths_;
  static constexpr unsigned kNotListed = 1u << kEighths, kNotMixed = kNotListed << 1;
  unsigned listed_ = kNotListed, mixed_ = 0;
  bool tells_objects_ = false;
  ObjectChoice choice_;
};

}  // namespace

class DistanceCodes::Scratch {
 public:
  tbb::enumerable_thread_specific<NodeMeasurement> nodes;
};

int DistanceCodes::reach(const CodeScale& scale) {
  // A surface point lies within half a voxel of its voxel's center along every axis.
  return static_cast<int>(std::ceil(std::max(outer_reach(scale), inner_reach(scale)) + 0.5f));
}

DistanceCodes::DistanceCodes(std::vector<const scan::SnappedObject*> objects,
                             const lattice::VoxelIndex& scene_origin,
                             const masks::MaskTree& geometry, const masks::MaskTree& interior,
                             const CodeScale& scale, const masks::KeptBox& kept,
                             std::int64_t growth_units, std::vector<std::uint16_t> numbers,
                             scan::SpillFile* spill)
    : scene_origin_(scene_origin),
      geometry_(geometry),
      interior_(interior),
      scale_(scale),
      kept_(kept),
      triangles_(std::move(objects), reach(scale), spill, true),
      numbers_(std::move(numbers)),
      scratch_(std::make_unique<Scratch>()) {
  if (growth_units > 0) growth_.emplace(triangles_, growth_units);
}

DistanceCodes::~DistanceCodes() = default;

scan::NodeIndex DistanceCodes::node_at(const masks::Coord& origin) const {
  scan::NodeIndex node;
  for (std::size_t d = 0; d < 3; ++d) {
    node[d] = (origin[static_cast<int>(d)] + scene_origin_[d]) >> 6;
  }
  return node;
}

std::vector<std::uint32_t> DistanceCodes::objects_near(const masks::Coord& origin) const {
  return triangles_.objects_near(node_at(origin));
}

std::vector<std::uint32_t> DistanceCodes::numbers_near(const masks::Coord& origin) const {
  if (!tells_objects()) return {};
  std::vector<std::uint32_t> near = objects_near(origin);
  for (std::uint32_t& object : near) object = numbers_[object];
  return near;
}

const NodeDistances& DistanceCodes::codes(const masks::Coord& origin) const {
  return scratch_->nodes.local().run(triangles_, scene_origin_, geometry_, interior_, scale_, kept_,
                                     growth_ ? &*growth_ : nullptr, numbers_, origin);
}

}  // namespace forcelayer::distance
