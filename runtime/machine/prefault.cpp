#include "runtime/machine/prefault.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "formats/voxmap_walk.h"

namespace forcelayer::machine {
namespace {

// Pages of a mapping, by number.
class PageSet {
 public:
  explicit PageSet(std::span<const std::byte> mapping)
      : page_bytes_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))),
        first_(reinterpret_cast<std::uintptr_t>(mapping.data()) / page_bytes_),
        wanted_(mapping.size() / page_bytes_ + 2) {}

  void add(const void* begin, std::size_t bytes) {
    const auto address = reinterpret_cast<std::uintptr_t>(begin);
    const std::size_t last = (address + bytes - 1) / page_bytes_ - first_;
    for (std::size_t page = address / page_bytes_ - first_; page <= last; ++page) {
      wanted_[page] = true;
    }
  }

  // In ascending order, a byte of each: the order in which a disk is fastest.
  std::uint64_t read() const {
    std::uint64_t bytes = 0;
    for (std::size_t page = 0; page < wanted_.size(); ++page) {
      if (!wanted_[page]) continue;
      const auto* at = reinterpret_cast<const volatile char*>((first_ + page) * page_bytes_);
      static_cast<void>(*at);
      bytes += page_bytes_;
    }
    return bytes;
  }

 private:
  std::size_t page_bytes_;
  std::uintptr_t first_;
  std::vector<bool> wanted_;
};

using Index = std::array<std::int64_t, 3>;

struct IndexBox {
  Index min{}, max{};  // world voxels, inclusive

  bool meets(const Index& low, std::int64_t edge) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (low[axis] > max[axis] || low[axis] + edge <= min[axis]) return false;
    }
    return true;
  }
};

// Adds the bricks below one entry that meet `box`.
template <std::uint32_t kBits>
void add_bricks(const TreeView<kBits>& view, std::uint32_t entry, const Index& low,
                std::uint32_t edge, const IndexBox& box, PageSet& pages) {
  if (is_uniform(entry) || !box.meets(low, edge)) return;
  if (edge == kBrickEdge) {
    pages.add(view.brick_at(entry), most_brick_bytes(kBits));
    return;
  }
  const std::uint32_t* const nodes = edge == kUpperNodeEdge ? view.upper_nodes : view.lower_nodes;
  for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
    add_bricks(view, nodes[std::uint64_t{entry} * kNodeEntries + n],
               voxmap_walk::child_low(low, n, edge / 8), edge / 8, box, pages);
  }
}

// Adds the bricks of a tree that meet `box`.
template <std::uint32_t kBits>
void add_bricks(const TreeView<kBits>& view, const IndexBox& box, PageSet& pages) {
  const auto& dims = view.directory_dims;
  const std::uint32_t* entry = view.directory;
  for (std::int64_t x = 0; x < dims[0]; ++x)
    for (std::int64_t y = 0; y < dims[1]; ++y)
      for (std::int64_t z = 0; z < dims[2]; ++z) {
        const Index low{view.directory_origin[0] + x * kUpperNodeEdge,
                        view.directory_origin[1] + y * kUpperNodeEdge,
                        view.directory_origin[2] + z * kUpperNodeEdge};
        add_bricks(view, *entry++, low, kUpperNodeEdge, box, pages);
      }
}

// The voxels of `reach` and those of the bricks next to them. Anything far out is as good as the
// end of the lattice.
IndexBox voxels_of(const ReachBox& reach, double voxel_size_m) {
  constexpr double kFar = 1e15, kAround = 8;
  IndexBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = [&](double m, double more) {
      return static_cast<std::int64_t>(
          std::clamp(std::floor(m / voxel_size_m) + more, -kFar, kFar));
    };
    box.min[static_cast<std::size_t>(axis)] = at(reach.min_m[axis], -kAround);
    box.max[static_cast<std::size_t>(axis)] = at(reach.max_m[axis], kAround);
  }
  return box;
}

}  // namespace

std::uint64_t prefault(const Voxmap& voxmap, const ReachBox& reach) {
  const auto page_bytes = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto first = reinterpret_cast<std::uintptr_t>(voxmap.bytes().data());
  if (first % page_bytes == 0) {
    // Advice: where it is not taken, more than was asked for is read.
    static_cast<void>(::madvise(const_cast<std::byte*>(voxmap.bytes().data()),
                                voxmap.bytes().size(), MADV_RANDOM));
  }
  PageSet pages(voxmap.bytes());
  const IndexBox box = voxels_of(reach, voxmap.voxel_size_m());
  add_bricks(voxmap.view(), box, pages);
  if (const DistanceView* distances = voxmap.distances()) add_bricks(*distances, box, pages);
  if (const ObjectView* objects = voxmap.objects()) add_bricks(*objects, box, pages);
  return pages.read();
}

void let_go(const Voxmap& voxmap) {
  const auto page_bytes = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  auto* const bytes = const_cast<std::byte*>(voxmap.bytes().data());
  if (reinterpret_cast<std::uintptr_t>(bytes) % page_bytes != 0) return;
  static_cast<void>(::munlock(bytes, voxmap.bytes().size()));
  static_cast<void>(::madvise(bytes, voxmap.bytes().size(), MADV_DONTNEED));
}

std::uint64_t resident_bytes(std::span<const std::byte> mapping) {
  const auto begin = reinterpret_cast<std::uintptr_t>(mapping.data());
  const auto end = begin + mapping.size();
  std::ifstream smaps("/proc/self/smaps");
  std::uint64_t sum = 0;
  bool inside = false;
  for (std::string line; std::getline(smaps, line);) {
    std::uintptr_t from = 0, to = 0;
    std::uint64_t kib = 0;
    if (std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR " ", &from, &to) == 2) {
      inside = from < end && to > begin;
    } else if (inside && std::sscanf(line.c_str(), "Rss: %" SCNu64 " kB", &kib) == 1) {
      sum += kib * 1024;
    }
  }
  return sum;
}

}  // namespace forcelayer::machine
