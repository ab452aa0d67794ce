#include "formats/voxinfo/surface.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <unordered_map>

#include "formats/voxinfo/occupied_boxes.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::voxinfo {
namespace {

// A fraction of an edge. A vertex so near to the center inside is moved outward, and a center
// outside that is so near to the surface counts as inside. So no two vertices are at one position.
constexpr double kNearCenter = 1.0 / 64;

using Block = std::array<std::int32_t, 3>;  // of 8^3 centers, counted from the directory's origin

Error unfit(const std::string& path, std::string what, const char* mend) {
  return {ErrorCode::kUsage, path, "", std::move(what), mend};
}

std::string in_mm(const char* format, double a_m, double b_m) {
  char text[200];
  std::snprintf(text, sizeof text, format, a_m * 1e3, b_m * 1e3);
  return text;
}

double largest_coordinate_m(const VoxmapHeader& h) {
  double largest = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const double low = static_cast<double>(h.origin_voxel[d]);
    largest = std::max(
        {largest, std::abs(low - 1), std::abs(low + static_cast<double>(h.dims_voxels[d]) + 1)});
  }
  return largest * h.voxel_size_m;
}

// V over the codes of a map, in squares of voxels, and which codes are inside.
struct CodeValues {
  static constexpr double kSurface = 0.75;
  std::array<double, kMaxDistanceCode + 1> value{};
  std::array<bool, kMaxDistanceCode + 1> is_inside{};

  CodeValues(const VoxmapHeader& h, double margin_m) {
    for (std::size_t code = 1; code < value.size(); ++code) {
      const double min_m =
          (static_cast<double>(code) - h.distance_zero_code) * h.distance_quantum_m - margin_m;
      value[code] = std::pow(std::max(0.0, min_m / h.voxel_size_m), 2);
    }
    for (std::size_t code = 0; code < value.size(); ++code) {
      is_inside[code] = value[code] <= kSurface * (1 + kNearCenter);
    }
  }
};

// The permutation of four numbers is even.
bool is_even(int a, int b, int c, int d) {
  return (((a > b) + (a > c) + (a > d) + (b > c) + (b > d) + (c > d)) & 1) == 0;
}

class Builder {
 public:
  Builder(const Voxmap& map, const CodeValues& values)
      : view_(*map.distances()), values_(values), voxel_size_m_(map.voxel_size_m()) {}

  // All blocks that have cells with a corner inside and one outside, and some others.
  Status find_blocks(const TreeCounts& counts, const std::string& path) {
    const OccupiedBoxes<kDistanceBits> occupied(view_, counts, kMaxDistanceCode);
    const double steps = occupied.steps([&](std::uint32_t code, std::uint32_t edge) {
      return values_.is_inside[code] ? 48.0 * edge * edge : 0;
    });
    if (Status s = check_walk(8 * steps, path); !s) return s;
    for_each_region_where(view_, occupied, [&](const VoxmapRegion& region) {
      Block low;
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = static_cast<std::int32_t>((region.low[d] - view_.directory_origin[d]) / 8);
      }
      if (region.is_brick) {
        const auto codes = view_.brick_codes(region.entry);
        if (std::none_of(codes.begin(), codes.end(),
                         [&](std::uint16_t code) { return values_.is_inside[code]; })) {
          return;
        }
        add_blocks(low, 1);
      } else if (values_.is_inside[DistanceView::uniform(region.entry, 1).code]) {
        add_blocks(low, static_cast<std::int32_t>(region.edge_voxels / 8));
      }
    });
    std::sort(blocks_.begin(), blocks_.end());
    blocks_.erase(std::unique(blocks_.begin(), blocks_.end()), blocks_.end());
    return {};
  }

  // False as soon as there are too many triangles.
  bool build() {
    for (std::size_t n = 0; n < blocks_.size(); ++n) {
      build_block(n);
      if (surface_.triangles.size() > kMaxTriangles) return false;
    }
    return true;
  }

  SolidSurface& surface() { return surface_; }

 private:
  static constexpr std::size_t kMaxTriangles = 500'000'000;
  static constexpr int kEdge = 9;  // corners of a block's cells along an axis

  // The blocks whose cells have a corner in a box of equal blocks, but for those that lie in it.
  void add_blocks(const Block& low, std::int32_t edge) {
    const auto is_on_side = [&](std::int32_t n) { return n == -1 || n == edge - 1; };
    for (std::int32_t x = -1; x < edge; ++x) {
      for (std::int32_t y = -1; y < edge; ++y) {
        const std::int32_t step = is_on_side(x) || is_on_side(y) ? 1 : edge;
        for (std::int32_t z = -1; z < edge; z += step) {
          blocks_.push_back({low[0] + x, low[1] + y, low[2] + z});
        }
      }
    }
  }

  static std::size_t corner(int x, int y, int z) {
    return static_cast<std::size_t>((x * kEdge + y) * kEdge + z);
  }

  // The codes of all corners of a block's cells.
  void read_corners(const Block& block) {
    for (int part = 0; part < 8; ++part) {
      const int px = part >> 2, py = part >> 1 & 1, pz = part & 1;
      const std::int32_t x = (block[0] + px) * 8, y = (block[1] + py) * 8, z = (block[2] + pz) * 8;
      std::array<std::uint16_t, kNodeEntries> codes;
      if (view_.contains(x, y, z)) {
        codes = view_.brick_codes(view_.entry(x, y, z));
      } else {
        codes.fill(kMaxDistanceCode);
      }
      for (int i = 0; i < (px ? 1 : 8); ++i) {
        for (int j = 0; j < (py ? 1 : 8); ++j) {
          for (int k = 0; k < (pz ? 1 : 8); ++k) {
            codes_[corner(8 * px + i, 8 * py + j, 8 * pz + k)] =
                codes[static_cast<std::size_t>(i << 6 | j << 3 | k)];
          }
        }
      }
    }
  }

  void build_block(std::size_t n) {
    block_ = blocks_[n];
    read_corners(block_);
    for (int part = 0; part < 8; ++part) {
      const Block next{block_[0] + (part >> 2), block_[1] + (part >> 1 & 1),
                       block_[2] + (part & 1)};
      const auto found =
          std::lower_bound(blocks_.begin() + static_cast<std::ptrdiff_t>(n), blocks_.end(), next);
      number_of_[static_cast<std::size_t>(part)] =
          static_cast<std::uint64_t>(found - blocks_.begin());
    }
    for (int x = 0; x < 8; ++x) {
      for (int y = 0; y < 8; ++y) {
        for (int z = 0; z < 8; ++z) build_cell({x, y, z});
      }
    }
  }

  // Corners of a cell have numbers of three bits: x, y, z.
  void build_cell(const std::array<int, 3>& at) {
    unsigned inside = 0;
    for (int n = 0; n < 8; ++n) {
      if (values_.is_inside[code(at, n)]) inside |= 1u << n;
    }
    if (inside == 0 || inside == 0xff) return;
    constexpr int kOrders[6][4] = {{0, 4, 6, 7}, {0, 2, 3, 7}, {0, 1, 5, 7},   // right-handed
                                   {0, 6, 2, 7}, {0, 3, 1, 7}, {0, 5, 4, 7}};  // the middle swapped
    for (const auto& tetrahedron : kOrders) build_tetrahedron(at, tetrahedron, inside);
  }

  // `corners`: right-handed.
  void build_tetrahedron(const std::array<int, 3>& at, const int (&corners)[4], unsigned inside) {
    int in[4], out[4], count = 0, outside = 0;
    for (int n = 0; n < 4; ++n) {
      if (inside >> corners[n] & 1) {
        in[count++] = n;
      } else {
        out[outside++] = n;
      }
    }
    const auto vertex = [&](int from, int to) { return vertex_on(at, corners[from], corners[to]); };
    // Seen from outside the triangles run anticlockwise where (in, out) is an even order.
    if (count == 1) {
      if (!is_even(in[0], out[0], out[1], out[2])) std::swap(out[1], out[2]);
      add(vertex(in[0], out[0]), vertex(in[0], out[1]), vertex(in[0], out[2]));
    } else if (count == 3) {
      if (!is_even(in[0], in[1], in[2], out[0])) std::swap(in[1], in[2]);
      add(vertex(in[0], out[0]), vertex(in[1], out[0]), vertex(in[2], out[0]));
    } else if (count == 2) {
      if (!is_even(in[0], in[1], out[0], out[1])) std::swap(out[0], out[1]);
      const std::uint32_t a = vertex(in[0], out[0]), b = vertex(in[0], out[1]),
                          c = vertex(in[1], out[1]), d = vertex(in[1], out[0]);
      add(a, b, c);
      add(a, c, d);
    }
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    surface_.triangles.push_back({a, b, c});
  }

  std::uint16_t code(const std::array<int, 3>& at, int n) const {
    return codes_[corner(at[0] + (n >> 2), at[1] + (n >> 1 & 1), at[2] + (n & 1))];
  }

  // The vertex between two corners of a cell, one inside and one outside.
  std::uint32_t vertex_on(const std::array<int, 3>& at, int in, int out) {
    // The edge belongs to its lower corner, and is numbered by the step to the higher one.
    const int low = in & out, step = in ^ out;
    const std::array<int, 3> base{at[0] + (low >> 2), at[1] + (low >> 1 & 1), at[2] + (low & 1)};
    const auto block =
        static_cast<std::size_t>((base[0] >> 3) << 2 | (base[1] >> 3) << 1 | base[2] >> 3);
    const auto place = static_cast<std::uint64_t>((base[0] & 7) << 9 | (base[1] & 7) << 6 |
                                                  (base[2] & 7) << 3 | step);
    const auto [found, is_new] = vertices_.try_emplace(
        number_of_[block] << 12 | place, static_cast<std::uint32_t>(surface_.vertices_m.size()));
    if (!is_new) return found->second;
    const double from = values_.value[code(at, in)], to = values_.value[code(at, out)];
    const double fraction = std::max(kNearCenter, (CodeValues::kSurface - from) / (to - from));
    std::array<double, 3> position_m;
    for (std::size_t d = 0; d < 3; ++d) {
      const int bit = 2 - static_cast<int>(d);
      const double moved = static_cast<double>((out >> bit & 1) - (in >> bit & 1)) * fraction;
      const std::int64_t voxel =
          view_.directory_origin[d] + std::int64_t{block_[d]} * 8 + at[d] + (in >> bit & 1);
      position_m[d] = (static_cast<double>(voxel) + 0.5 + moved) * voxel_size_m_;
    }
    surface_.vertices_m.push_back(position_m);
    return found->second;
  }

  const DistanceView& view_;
  const CodeValues& values_;
  double voxel_size_m_;
  std::vector<Block> blocks_;  // ascending
  SolidSurface surface_;
  std::unordered_map<std::uint64_t, std::uint32_t> vertices_;  // number of block, corner and step
  // The block whose cells are built, and of it and the seven above it the numbers in `blocks_`.
  Block block_{};
  std::array<std::uint64_t, 8> number_of_{};
  std::array<std::uint16_t, kEdge * kEdge * kEdge> codes_{};
};

}  // namespace

Result<SolidSurface> solid_surface(const Voxmap& map, double offset_m, bool single_precision,
                                   const std::string& path) {
  const VoxmapHeader& h = map.header();
  if (map.distances() == nullptr) {
    return unfit(path, "stores no distances, from which the surface is made",
                 "bake it without --kind, or export .csv");
  }
  if (h.cropped_sides != 0) {
    return unfit(path, "is cropped, and the solid beyond a cropped side is not known",
                 "bake it without --roi");
  }
  double margin_m = h.static_deviation_m + offset_m;
  if (single_precision) {
    const auto largest = static_cast<float>(largest_coordinate_m(h));
    const double step_m = std::nextafter(largest, std::numeric_limits<float>::infinity()) - largest;
    if (step_m > h.voxel_size_m / 512) {
      return unfit(path, "is too far from the origin for the 32-bit coordinates of .stl and .glb",
                   "export .ply");
    }
    margin_m += std::sqrt(3.0) * step_m;
  }
  const double reach_m =
      (static_cast<double>(kMaxDistanceCode) - h.distance_zero_code) * h.distance_quantum_m;
  const double largest_m = reach_m - (margin_m - offset_m) - 0.9 * h.voxel_size_m;
  if (!(offset_m <= largest_m)) {
    return unfit(path,
                 in_mm("stores distances up to %.4g mm, which allows an offset of at most %.4g mm",
                       reach_m, std::max(0.0, largest_m)),
                 "use a smaller --offset, or bake with a larger --standoff");
  }
  const CodeValues values(h, margin_m);
  Builder builder(map, values);
  if (Status s = builder.find_blocks(map.distance_counts(), path); !s) return s.error();
  if (!builder.build()) {
    return unfit(path, "has a surface of more than 500 million triangles", "use larger voxels");
  }
  if (builder.surface().triangles.empty()) {
    return unfit(path, "holds no solid, so it has no surface", "check the scene");
  }
  return std::move(builder.surface());
}

}  // namespace forcelayer::voxinfo
