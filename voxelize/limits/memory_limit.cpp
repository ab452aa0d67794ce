#include "voxelize/limits/memory_limit.h"

#include <sys/resource.h>
#include <sys/sysinfo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <unordered_set>

#include "voxelize/masks/mask_tree.h"

namespace forcelayer::limits {
namespace {

// A brick of 512 bits with its place in the tree takes 96 bytes, and holds 64 voxels of a plane.
constexpr double kBrickBytes = 96;
constexpr double kBytesPerVoxelOfAPlane = kBrickBytes / 64;
// Along a line a brick holds 8 voxels, and a node of the tree, with room for 512 bricks, 64.
constexpr double kBytesPerVoxelOfALine = kBrickBytes / 8 + sizeof(masks::LowerMaskNode) / 64.0;

// A lower bound of the voxels that a triangle touches: the area of its largest projection along an
// axis, and its length along an axis.
struct Extent {
  double area_voxels = 0, length_voxels = 0;

  double bytes() const {
    return std::max(kBytesPerVoxelOfAPlane * area_voxels, kBytesPerVoxelOfALine * length_voxels);
  }
  double voxels() const { return std::max(area_voxels, length_voxels); }
  // By how much larger voxels must be for `available` bytes.
  double excess(double available) const {
    return std::max(std::sqrt(kBytesPerVoxelOfAPlane * area_voxels / available),
                    kBytesPerVoxelOfALine * length_voxels / available);
  }
};

Extent extent_of(const lattice::LatticeTriangle& triangle) {
  constexpr double kVoxelUnits = 1 << lattice::kSnapBits;
  Extent extent;
  double edges[2][3];
  for (std::size_t d = 0; d < 3; ++d) {
    edges[0][d] = static_cast<double>(triangle[1][d] - triangle[0][d]) / kVoxelUnits;
    edges[1][d] = static_cast<double>(triangle[2][d] - triangle[0][d]) / kVoxelUnits;
    const auto [smallest, largest] = std::minmax({0.0, edges[0][d], edges[1][d]});
    extent.length_voxels = std::max(extent.length_voxels, largest - smallest);
  }
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
    const double area = std::abs(edges[0][e] * edges[1][f] - edges[0][f] * edges[1][e]) / 2;
    extent.area_voxels = std::max(extent.area_voxels, area);
  }
  return extent;
}

// No triangle in the box can be larger.
Extent largest_extent(const masks::VoxelBox& box) {
  std::array<double, 3> edges;
  for (std::size_t d = 0; d < 3; ++d) edges[d] = static_cast<double>(box.high[d] - box.low[d] + 1);
  std::sort(edges.begin(), edges.end());
  return {edges[1] * edges[2] / 2, edges[2]};
}

// The text "KEY:   1234 kB" of /proc/meminfo as bytes; 0 where there is none.
double meminfo_bytes(std::string_view key) {
  std::ifstream file("/proc/meminfo");
  for (std::string word; file >> word;) {
    double kilobytes = 0;
    if (word == key && file >> kilobytes) return 1024 * kilobytes;
  }
  return 0;
}

// A vertex so many times as far away as half of the others is taken for a mistake.
constexpr double kFarAway = 100;

// "correct the stray vertex at (0, 4.3e+06, 0) m, ..., or ": where one corner of the object's
// triangles lies far away from half of them; else what may be wrong.
std::string culprit_of(const scan::SnappedObject& object, double voxel_size_m) {
  const double unit_m = voxel_size_m / static_cast<double>(lattice::kSnapUnits);
  std::vector<lattice::LatticePoint> corners;
  for (std::size_t i = 0; i < object.triangles.size(); ++i) {
    for (const lattice::LatticePoint& corner : object.triangle(i)) corners.push_back(corner);
  }
  lattice::LatticePoint middle{};
  std::vector<std::int64_t> along(corners.size());
  const auto median = [](auto& list) {
    const auto half = list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2);
    std::nth_element(list.begin(), half, list.end());
    return *half;
  };
  for (std::size_t d = 0; d < 3; ++d) {
    for (std::size_t i = 0; i < corners.size(); ++i) along[i] = corners[i][d];
    middle[d] = median(along);
  }
  const auto away_m = [&](const lattice::LatticePoint& corner) {
    double square = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      const double side = static_cast<double>(corner[d] - middle[d]) * unit_m;
      square += side * side;
    }
    return std::sqrt(square);
  };
  std::vector<double> distances_m;
  for (const lattice::LatticePoint& corner : corners) distances_m.push_back(away_m(corner));
  const auto farthest = std::max_element(distances_m.begin(), distances_m.end());
  const auto& at = corners[static_cast<std::size_t>(farthest - distances_m.begin())];
  const double max_m = *farthest, half_m = median(distances_m);
  if (!(max_m > kFarAway * half_m)) return "look for a stray vertex, check the units, or ";
  char text[240];
  std::snprintf(
      text, sizeof text,
      "correct the stray vertex at (%.6g, %.6g, %.6g) m (it is %.4g m from the object's middle, "
      "but half of the vertices are within %.4g m), or ",
      static_cast<double>(at[0]) * unit_m, static_cast<double>(at[1]) * unit_m,
      static_cast<double>(at[2]) * unit_m, max_m, half_m);
  return text;
}

// "use --voxel-size 0.13m or more"
std::string larger_voxels(double voxel_size_m) {
  char text[60];
  std::snprintf(text, sizeof text, "use --voxel-size %.3gm or more", voxel_size_m);
  return text;
}

// The nodes that surfaces touch and reach, each once.
class NodeCount {
 public:
  NodeCount(int reach, const NodeBytes& bytes, double available)
      : reach_(reach),
        bytes_(bytes),
        available_(available),
        steps_left_(2 * available / (bytes.touched + bytes.reached)) {}

  double bytes() const {
    return bytes_.touched * static_cast<double>(touched_.size()) +
           bytes_.reached * static_cast<double>(reached_.size());
  }
  bool is_too_much() const { return bytes() > available_; }

  // The nodes along a triangle's edges. Of an edge that is shorter than two nodes, and of each once
  // counting takes seconds, the node of one end alone.
  void add(const lattice::LatticeTriangle& triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      const lattice::LatticePoint &from = triangle[k], &to = triangle[(k + 1) % 3];
      double extent = 0;
      for (std::size_t d = 0; d < 3; ++d) {
        extent = std::max(extent, std::abs(static_cast<double>(to[d] - from[d])));
      }
      const double steps = std::ceil(extent / kNodeUnits);
      const bool is_long = steps > 2;
      if (is_long && !edges_.insert(masks::IndexHash()(from) + masks::IndexHash()(to)).second) {
        continue;  // another triangle's, counted already
      }
      const double counted = is_long ? std::clamp(steps_left_, 1.0, steps) : 1;
      if (is_long) steps_left_ -= counted;
      for (double step = 0; step < counted && !is_too_much(); ++step) {
        lattice::LatticePoint point;
        for (std::size_t d = 0; d < 3; ++d) {
          point[d] = from[d] + std::llround(static_cast<double>(to[d] - from[d]) * (step / steps));
        }
        add_nodes_around(point);
      }
    }
  }

 private:
  using Nodes = std::unordered_set<lattice::VoxelIndex, masks::IndexHash>;
  static constexpr int kLog2NodeUnits = lattice::kSnapBits + 6;
  static constexpr double kNodeUnits = 1 << kLog2NodeUnits;

  void add_nodes_around(const lattice::LatticePoint& point) {
    lattice::VoxelIndex at, low, high;
    for (std::size_t d = 0; d < 3; ++d) {
      at[d] = point[d] >> kLog2NodeUnits;
      low[d] = (point[d] - reach_ * lattice::kSnapUnits) >> kLog2NodeUnits;
      high[d] = (point[d] + reach_ * lattice::kSnapUnits) >> kLog2NodeUnits;
    }
    if (at == last_ && low == last_low_ && high == last_high_) return;
    last_ = at, last_low_ = low, last_high_ = high;
    touched_.insert(at);
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) reached_.insert({x, y, z});
      }
    }
  }

  const int reach_;
  const NodeBytes bytes_;
  const double available_;
  Nodes touched_, reached_;
  lattice::VoxelIndex last_{INT64_MAX, 0, 0}, last_low_{}, last_high_{};
  std::unordered_set<std::size_t> edges_;  // those of more than one node, by a hash
  double steps_left_;                      // along them
};

// The object that most nodes are of, where they are too many; else null.
const NamedObject* too_large(std::span<const NamedObject> objects, int reach,
                             const NodeBytes& bytes, double available) {
  NodeCount count(reach, bytes, available);
  const NamedObject* culprit = nullptr;
  double largest = -1;
  for (const NamedObject& named : objects) {
    const double before = count.bytes();
    for (std::size_t i = 0; i < named.object->triangles.size() && !count.is_too_much(); ++i) {
      count.add(named.object->triangle(i));
    }
    if (count.bytes() - before > largest) largest = count.bytes() - before, culprit = &named;
    if (count.is_too_much()) return culprit;
  }
  return nullptr;
}

// Nodes of the box of the objects, with what is in reach.
double nodes_of_box(std::span<const NamedObject> objects, int reach) {
  masks::VoxelBox box;
  for (const NamedObject& named : objects) box.include(named.object->box);
  if (box.empty()) return 0;
  double nodes = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    nodes *= static_cast<double>(((box.high[d] + reach) >> 6) - ((box.low[d] - reach) >> 6) + 1);
  }
  return nodes;
}

}  // namespace

double available_bytes() {
  double bytes = meminfo_bytes("MemAvailable:") + meminfo_bytes("SwapFree:");
  if (bytes == 0) {
    struct sysinfo machine {};
    ::sysinfo(&machine);
    bytes = (static_cast<double>(machine.totalram) + static_cast<double>(machine.totalswap)) *
            machine.mem_unit;
  }
  for (const char* const path :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    double largest = 0;
    if (std::ifstream(path) >> largest && largest > 0) bytes = std::min(bytes, largest);
  }
  rlimit own{};
  if (::getrlimit(RLIMIT_AS, &own) == 0 && own.rlim_cur != RLIM_INFINITY) {
    bytes = std::min(bytes, static_cast<double>(own.rlim_cur));
  }
  return bytes;
}

Status fit_memory(const scan::SnappedObject& object, const std::string& name, double voxel_size_m,
                  double available) {
  if (object.box.empty() || largest_extent(object.box).bytes() <= available) return {};
  Extent largest;
  std::size_t largest_triangle = 0;
  for (std::size_t i = 0; i < object.triangles.size(); ++i) {
    const Extent extent = extent_of(object.triangle(i));
    if (extent.bytes() <= largest.bytes()) continue;
    largest = extent;
    largest_triangle = i;
  }
  if (largest.bytes() <= available) return {};
  char what[200];
  std::snprintf(what, sizeof what,
                "passes through at least %.3g voxels, which take %.3g GB of memory, but this "
                "process can have %.3g GB",
                largest.voxels(), largest.bytes() * 1e-9, available * 1e-9);
  return Error{ErrorCode::kBakeTooLarge, "",
               "triangle " + std::to_string(largest_triangle) + " of " + name, what,
               culprit_of(object, voxel_size_m) +
                   larger_voxels(voxel_size_m * largest.excess(available) * 1.01)};
}

Status fit_nodes(std::span<const NamedObject> objects, int reach, const NodeBytes& bytes,
                 double voxel_size_m, double available) {
  if (nodes_of_box(objects, reach) * (bytes.touched + bytes.reached) <= available) return {};
  const NamedObject* const largest = too_large(objects, reach, bytes, available);
  if (largest == nullptr) return {};
  char what[200];
  std::snprintf(what, sizeof what,
                "with voxels of %.4g mm, the scene needs more than the %.3g GB of memory that this "
                "process can have, and this object needs the most",
                voxel_size_m * 1e3, available * 1e-9);
  return Error{ErrorCode::kBakeTooLarge, "", largest->name, what,
               culprit_of(*largest->object, voxel_size_m) + "use larger voxels"};
}

}  // namespace forcelayer::limits
