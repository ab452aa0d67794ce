#include "voxelize/offset.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "voxelize/brick_bits.h"

namespace forcelayer {
namespace {

constexpr int kEdge = 64;  // voxels of a node
constexpr int kRadii = 3;  // of the dilations: k-1, k and k+1

static_assert(std::endian::native == std::endian::little, "rows are filled byte by byte");

// Writes a brick's eight-bit rows into 64-bit rows: the row of voxel (x, y) goes to
// row[x * stride + y], byte `byte`, for x in [x0, x1) and y in [y0, y1).
struct RowWindow {
  int x0 = 0, x1 = 8, y0 = 0, y1 = 8;
};
void write_rows(const std::uint64_t* words, std::uint64_t* rows, std::ptrdiff_t stride, int byte,
                const RowWindow& window) {
  auto* bytes = reinterpret_cast<unsigned char*>(rows) + byte;
  for (int x = window.x0; x < window.x1; ++x) {
    for (int y = window.y0; y < window.y1; ++y) {
      bytes[(x * stride + y) * 8] = static_cast<unsigned char>(words[x] >> (8 * y));
    }
  }
}

// The geometry of a node and of a halo of `halo` voxels around it: rows along z of three words,
// below, here and above; width x width rows.
class Halo {
 public:
  Halo(const MaskTree& geometry, int halo, LayerOffset::Scratch& scratch)
      : reader_(geometry), halo_(halo), width_(kEdge + 2 * halo), scratch_(scratch) {}

  // Whether there is anything.
  bool gather(const Coord& origin) {
    const auto rows = static_cast<std::size_t>(width_ * width_);
    for (auto* part : {&scratch_.below, &scratch_.here, &scratch_.above}) part->assign(rows, 0);
    scratch_.occupied.assign(static_cast<std::size_t>(width_), 0);
    bool any = false;
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        for (int k = -1; k <= 1; ++k) {
          const Coord at = origin.offsetBy(i * kEdge, j * kEdge, k * kEdge);
          if (const auto* node = reader_.probeConstNode<LowerMaskNode>(at)) {
            any |= add(*node, i, j, k);
          }
        }
      }
    }
    return any;
  }

 private:
  bool add(const LowerMaskNode& node, int i, int j, int k) {
    std::uint64_t* rows = (k < 0 ? scratch_.below : k > 0 ? scratch_.above : scratch_.here).data();
    bool any = false;
    for_each_set(mask_of(node.getChildMask()), [&](unsigned n) {
      const int x = i * kEdge + static_cast<int>(n >> 6) * 8 + halo_;
      const int y = j * kEdge + static_cast<int>(n >> 3 & 7) * 8 + halo_;
      const int z = k * kEdge + static_cast<int>(n & 7) * 8 + halo_;
      if (x <= -8 || x >= width_ || y <= -8 || y >= width_ || z <= -8 || z >= width_) return;
      const RowWindow window = {std::max(0, -x), std::min(8, width_ - x), std::max(0, -y),
                                std::min(8, width_ - y)};
      write_rows(words_of(*node.getTable()[n].getChild()), rows + (x * width_ + y), width_,
                 static_cast<int>(n & 7), window);
      for (int p = window.x0; p < window.x1; ++p) {
        scratch_.occupied[static_cast<std::size_t>(x + p)] = 1;
      }
      any = true;
    });
    return any;
  }

  MaskReader reader_;
  int halo_, width_;
  LayerOffset::Scratch& scratch_;
};

// Box dilation by the radii k-1, k, k+1 (none where the radius is negative), one axis at a time.
class Dilation {
 public:
  Dilation(int layers, LayerOffset::Scratch& scratch)
      : layers_(layers), halo_(layers + 1), width_(kEdge + 2 * halo_), scratch_(scratch) {
    scratch_.along_z.resize(static_cast<std::size_t>(kRadii * width_));
    scratch_.along_y.resize(static_cast<std::size_t>(kRadii * width_ * kEdge));
  }

  // After Halo::gather().
  void run() {
    for (int plane = 0; plane < width_; ++plane) {
      if (!scratch_.occupied[static_cast<std::size_t>(plane)]) continue;
      along_z(plane);
      along_y(plane);
    }
  }

  // Row (x, 0..63) of the dilation by the r-th radius.
  void along_x(int r, int x, std::uint64_t (&row)[kEdge]) const {
    std::fill(std::begin(row), std::end(row), 0);
    const int radius = layers_ - 1 + r;
    for (int plane = x + halo_ - radius; plane <= x + halo_ + radius; ++plane) {
      if (!scratch_.occupied[static_cast<std::size_t>(plane)]) continue;
      const std::uint64_t* from = y_rows(r, plane);
      for (int y = 0; y < kEdge; ++y) row[y] |= from[y];
    }
  }

 private:
  void along_z(int plane) {
    const auto first = static_cast<std::size_t>(plane * width_);
    const std::uint64_t* below = scratch_.below.data() + first;
    const std::uint64_t* here = scratch_.here.data() + first;
    const std::uint64_t* above = scratch_.above.data() + first;
    std::uint64_t* out[kRadii];
    for (int r = 0; r < kRadii; ++r) out[r] = scratch_.along_z.data() + r * width_;
    for (int y = 0; y < width_; ++y) {
      std::uint64_t row = layers_ == 0 ? 0 : here[y];
      for (int step = 1; step < layers_; ++step)
        row |= stepped_row(below[y], here[y], above[y], step);
      out[0][y] = row;
      row |= layers_ == 0 ? here[y] : stepped_row(below[y], here[y], above[y], layers_);
      out[1][y] = row;
      out[2][y] = row | stepped_row(below[y], here[y], above[y], layers_ + 1);
    }
  }

  // A row moved by `step` voxels (1..63) both ways.
  static std::uint64_t stepped_row(std::uint64_t below, std::uint64_t here, std::uint64_t above,
                                   int step) {
    return here << step | below >> (64 - step) | here >> step | above << (64 - step);
  }

  void along_y(int plane) {
    for (int r = 0; r < kRadii; ++r) {
      const std::uint64_t* from = scratch_.along_z.data() + r * width_ + halo_;
      std::uint64_t* to = y_rows(r, plane);
      std::fill(to, to + kEdge, 0);
      const int radius = layers_ - 1 + r;
      for (int dy = -radius; dy <= radius; ++dy) {
        for (int y = 0; y < kEdge; ++y) to[y] |= from[y + dy];
      }
    }
  }

  std::uint64_t* y_rows(int r, int plane) const {
    return scratch_.along_y.data() + (r * width_ + plane) * kEdge;
  }

  int layers_, halo_, width_;
  LayerOffset::Scratch& scratch_;
};

// Rows of a node of `interior`.
void interior_rows(const MaskTree& interior, const Coord& origin,
                   std::array<std::uint64_t, 4096>& rows) {
  MaskReader reader(interior);
  const auto* node = reader.probeConstNode<LowerMaskNode>(origin);
  if (node == nullptr) {
    rows.fill(reader.isValueOn(origin) ? kAllBits : 0);
    return;
  }
  rows.fill(0);
  static constexpr std::uint64_t kFullBrick[8] = {kAllBits, kAllBits, kAllBits, kAllBits,
                                                  kAllBits, kAllBits, kAllBits, kAllBits};
  const BrickMask leaves = mask_of(node->getChildMask());
  for_each_set(leaves | mask_of(node->getValueMask()), [&](unsigned n) {
    const std::uint64_t* words =
        test(leaves, n) ? words_of(*node->getTable()[n].getChild()) : kFullBrick;
    write_rows(words, rows.data() + (n >> 6) * 8 * kEdge + (n >> 3 & 7) * 8, kEdge,
               static_cast<int>(n & 7), {});
  });
}

}  // namespace

LayerOffset::LayerOffset(const MaskTree& geometry, const MaskTree& interior, unsigned layers,
                         const openvdb::CoordBBox& box)
    : geometry_(geometry), interior_(interior), layers_(static_cast<int>(layers)), box_(box) {}

std::vector<Coord> LayerOffset::nodes() const {
  const int reach = layers_ + 1;
  std::vector<Coord> origins;
  for (auto block = geometry_.root().cbeginChildOn(); block; ++block) {
    for (auto node = block->cbeginChildOn(); node; ++node) {
      // The box of its bricks tells which neighbours it can reach.
      openvdb::CoordBBox box;
      for_each_set(mask_of(node->getChildMask()), [&](unsigned n) {
        box.expand(openvdb::CoordBBox::createCube(entry_origin(node->origin(), n, 8), 8));
      });
      box.expand(reach);
      box.intersect(box_);
      for (int x = box.min().x() >> 6; x <= box.max().x() >> 6; ++x) {
        for (int y = box.min().y() >> 6; y <= box.max().y() >> 6; ++y) {
          for (int z = box.min().z() >> 6; z <= box.max().z() >> 6; ++z) {
            origins.emplace_back(x * kEdge, y * kEdge, z * kEdge);
          }
        }
      }
    }
  }
  std::sort(origins.begin(), origins.end());
  origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
  return origins;
}

ValueCounts LayerOffset::codes(const Coord& node_origin, Scratch& scratch, NodeCodes& codes) const {
  ValueCounts counts;
  interior_rows(interior_, node_origin, codes.low);
  Halo halo(geometry_, layers_ + 1, scratch);
  Dilation dilation(layers_, scratch);
  if (halo.gather(node_origin)) dilation.run();
  std::uint64_t within[kRadii][kEdge];
  for (int x = 0; x < kEdge; ++x) {
    for (int r = 0; r < kRadii; ++r) dilation.along_x(r, x, within[r]);
    for (int y = 0; y < kEdge; ++y) {
      const auto row = static_cast<std::size_t>(x * kEdge + y);
      const std::uint64_t solid = codes.low[row];
      const std::uint64_t interior = solid | within[0][y];
      const std::uint64_t surface = within[1][y] & ~interior;
      const std::uint64_t proximity = within[2][y] & ~(within[1][y] | solid);
      codes.low[row] = interior | proximity;
      codes.high[row] = surface | proximity;
      counts.interior += static_cast<std::uint64_t>(std::popcount(interior));
      counts.surface += static_cast<std::uint64_t>(std::popcount(surface));
      counts.proximity += static_cast<std::uint64_t>(std::popcount(proximity));
    }
  }
  return counts;
}

}  // namespace forcelayer
