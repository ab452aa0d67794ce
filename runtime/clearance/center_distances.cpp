#include "runtime/clearance/center_distances.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "runtime/clearance/front_kernel.h"

namespace forcelayer::clearance {
namespace {

// Fronts at the far end of what is stored must be so far from the mesh, in voxels (front.h).
constexpr double kFarEnough = 2.7;
constexpr double kInterpolated = 0.5;  // voxels: a distance is no farther below that of its place

// Blocks with and without distances that are searched for: 100 MB, 50 MB. Beyond that all are read
// anew.
constexpr std::size_t kMaxSearched = 1 << 14, kMaxStored = 1 << 16;
constexpr float kRoundDown = 1 - 0x1p-20f;  // exceeds the rounding of a squared distance
constexpr double kSumRounding = 1e-5;       // voxels^2, of the interpolation, from floats
// Places as integers, and those whose bricks have a key.
constexpr double kMaxInteger = 1 << 30, kMaxVoxel = 1 << 23;

// floor(), of what an integer holds: without the call that it is on the least of x86.
std::int32_t floor_of(double x) {
  const auto whole = static_cast<std::int32_t>(x);
  return whole - (x < whole ? 1 : 0);
}

bool is_within(const glm::dvec3& p, double largest) {
  return std::abs(p.x) < largest && std::abs(p.y) < largest && std::abs(p.z) < largest;
}

int in_block(int x, int y, int z) { return (x * 9 + y) * 9 + z; }

std::uint32_t in_brick(int x, int y, int z) {
  return static_cast<std::uint32_t>((x & 7) << 6 | (y & 7) << 3 | (z & 7));
}

// The least distance between a center of a block (0.5 to 8.5) and one of the brick `offset` away.
float min_between(const BrickIndex& offset) {
  float squared = 0;
  for (const std::int32_t o : offset) {
    const int gap = std::max({0, 8 * o - 8, -8 * o - 7});
    squared += static_cast<float>(gap) * static_cast<float>(gap);
  }
  return std::sqrt(squared);
}

glm::dvec3 to_vec(const std::array<std::int64_t, 3>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

}  // namespace

CenterDistances::CenterDistances(const Voxmap& voxmap, const LeftOut& left_out, double cap_voxels)
    : voxmap_(voxmap),
      left_out_(left_out),
      leaves_out_(std::any_of(left_out.begin(), left_out.end(), [](auto out) { return out != 0; })),
      cap_(std::max(cap_voxels, reach_voxels(voxmap.header()))),
      searches_(leaves_out_ || cap_ > reach_voxels(voxmap.header())),
      quantum_(voxmap.header().distance_quantum_m / voxmap.voxel_size_m()),
      free_(free_distance_m(voxmap.header()) / voxmap.voxel_size_m()),
      known_(known_box(voxmap.header(), voxmap.header().directory_origin)),
      cropped_(voxmap.header().cropped_sides != 0),
      all_free_(voxmap.header().dims_voxels[0] == 0),
      fronts_(voxmap, left_out,
              leaves_out_ || reach_voxels(voxmap.header()) < kFarEnough ? Fronts::Window::kMesh
                                                                        : Fronts::Window::kReach),
      mesh_fronts_(voxmap, left_out, Fronts::Window::kMesh) {
  const VoxmapHeader& h = voxmap.header();
  const auto reach = static_cast<float>(reach_voxels(h)) * kRoundDown;
  static_assert(kMaxDistanceCode == 255);
  for (std::uint32_t code = 0; code <= kMaxDistanceCode; ++code) {
    const double low = (static_cast<std::int32_t>(code) - h.distance_zero_code) * quantum_;
    const auto smallest = static_cast<float>(code == 0 ? 0 : std::max(0.0, low)) * kRoundDown;
    const float told = code == kMaxDistanceCode ? reach : smallest;
    known_of_code_[code] = told;
    squared_of_code_[code] = told * told * kRoundDown;
  }
  tight_low_ = to_vec(h.origin_voxel) - to_vec(h.directory_origin);
  tight_high_ = tight_low_ + glm::dvec3(static_cast<double>(h.dims_voxels[0]),
                                        static_cast<double>(h.dims_voxels[1]),
                                        static_cast<double>(h.dims_voxels[2]));
  const auto bricks = static_cast<std::int32_t>(std::ceil(cap_ / 8)) + 1;
  std::vector<std::pair<float, BrickIndex>> sorted;
  for (std::int32_t x = -bricks; x <= bricks; ++x) {
    for (std::int32_t y = -bricks; y <= bricks; ++y) {
      for (std::int32_t z = -bricks; z <= bricks; ++z) {
        const float smallest = min_between({x, y, z});
        if (smallest <= cap_) sorted.push_back({smallest, {x, y, z}});
      }
    }
  }
  std::sort(sorted.begin(), sorted.end());
  for (const auto& [smallest, offset] : sorted) {
    offsets_.push_back(offset);
    offset_min_.push_back(smallest);
  }
}

// How far inside the box of the known voxels a place lies; infinity where nothing is cropped.
double CenterDistances::side_distance(const glm::dvec3& place) const {
  double inside = std::numeric_limits<double>::infinity();
  if (!cropped_) return inside;
  for (int axis = 0; axis < 3; ++axis) {
    const auto low = static_cast<double>(known_.low[static_cast<std::size_t>(axis)]);
    const auto high = static_cast<double>(known_.high[static_cast<std::size_t>(axis)]);
    inside = std::min({inside, place[axis] - low, high - place[axis]});
  }
  return inside;
}

bool CenterDistances::is_of_side(const glm::dvec3& place, double voxels) const {
  return side_distance(place) < voxels + kInterpolated;
}

double CenterDistances::free_around(const glm::dvec3& p) const {
  const double side = side_distance(p);
  if (side < 0) return 0;
  double around = -1;
  if (all_free_) {
    around = std::numeric_limits<double>::infinity();
  } else {
    const glm::dvec3 gap = glm::max(glm::max(tight_low_ - p, p - tight_high_), glm::dvec3(0));
    const double outside = glm::length(gap);
    if (outside > 0) around = outside;
  }
  const VoxmapView& view = voxmap_.view();
  if (is_within(p, kMaxInteger)) {
    const std::int32_t v[3] = {floor_of(p.x), floor_of(p.y), floor_of(p.z)};
    if (view.contains(v[0], v[1], v[2])) {
      const VoxelLookup found = view.lookup(v[0], v[1], v[2]);
      if (found.code != static_cast<std::uint32_t>(VoxelValue::kFree)) return 0;
      double inside = found.edge_voxels == 1 ? 0 : std::numeric_limits<double>::infinity();
      if (found.edge_voxels > 1) {
        for (int axis = 0; axis < 3; ++axis) {
          const double low = v[axis] & -static_cast<std::int32_t>(found.edge_voxels);
          inside = std::min({inside, p[axis] - low, low + found.edge_voxels - p[axis]});
        }
        inside += std::max(1u, found.clearance) - 1.0;
      }
      around = std::max(around, inside);
    }
  }
  around = std::min(around, side);
  return around < 0 ? 0 : around + free_;
}

// Squared lower bounds of what is stored; unknown where a search can tell more.
void CenterDistances::read(const BrickIndex& brick, Block& block) const {
  const DistanceView& distances = *voxmap_.distances();
  const ObjectView* const objects = leaves_out_ ? voxmap_.objects() : nullptr;
  std::array<std::array<std::uint16_t, kNodeEntries>, 8> codes, numbers;
  for (std::int32_t n = 0; n < 8; ++n) {
    const BrickIndex b{brick[0] + (n >> 2), brick[1] + (n >> 1 & 1), brick[2] + (n & 1)};
    const auto i = static_cast<std::size_t>(n);
    codes[i] = distances.brick_codes(entry_of(distances, b, uniform_entry(kMaxDistanceCode)));
    if (objects != nullptr) {
      numbers[i] = objects->brick_codes(entry_of(*objects, b, uniform_entry(0)));
    }
  }
  if (!searches_ && !cropped_) {
    for (std::int32_t x = 0; x < 9; ++x) {
      for (std::int32_t y = 0; y < 9; ++y) {
        const auto n = static_cast<std::size_t>(x >> 3 << 2 | y >> 3 << 1);
        const std::uint32_t row = in_brick(x, y, 0);
        std::uint8_t* const to = &block.code[static_cast<std::size_t>(in_block(x, y, 0))];
        for (std::uint32_t z = 0; z < 8; ++z) to[z] = static_cast<std::uint8_t>(codes[n][row + z]);
        to[8] = static_cast<std::uint8_t>(codes[n + 1][row]);
      }
    }
    return;
  }
  if (searches_) block.searched = std::make_unique<Searched>();
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 9; ++y) {
      for (int z = 0; z < 9; ++z) {
        const auto i = static_cast<std::size_t>(in_block(x, y, z));
        const auto n = static_cast<std::size_t>(x >> 3 << 2 | y >> 3 << 1 | z >> 3);
        const std::uint32_t code = codes[n][in_brick(x, y, z)];
        const glm::dvec3 center(8.0 * brick[0] + x + 0.5, 8.0 * brick[1] + y + 0.5,
                                8.0 * brick[2] + z + 0.5);
        const bool unknown = cropped_ && side_distance(center) < 0;
        if (!searches_) {
          block.code[i] = static_cast<std::uint8_t>(unknown ? 0 : code);  // 0 has the distance 0
          continue;
        }
        bool is_stored = code != kMaxDistanceCode;
        if (is_stored && objects != nullptr) {
          const std::uint32_t object = numbers[n][in_brick(x, y, z)];
          is_stored = object >= left_out_.size() || left_out_[object] == 0;
        }
        block.searched->known[i] = known_of_code_[code];
        block.searched->squared[i] = unknown     ? 0
                                     : is_stored ? squared_of_code_[code]
                                                 : Searched::kUnknown;
      }
    }
  }
}

CenterDistances::Block& CenterDistances::block_of(const BrickIndex& brick, std::uint64_t key) {
  auto found = blocks_.find(key);
  if (found == blocks_.end()) {
    if (blocks_.size() >= (searches_ ? kMaxSearched : kMaxStored)) {
      blocks_.clear();
      slots_.fill({});
      fronts_.forget();
      mesh_fronts_.forget();
    }
    found = blocks_.emplace(key, std::make_unique<Block>()).first;
    read(brick, *found->second);
  }
  slots_[slot_of(key)] = {key, found->second.get()};
  return *found->second;
}

void CenterDistances::find_near(const BrickIndex& brick, Searched& block) {
  block.has_near = true;
  for (std::size_t i = 0; i < offsets_.size(); ++i) {
    if (offset_min_[i] + fronts_.min_voxels() > cap_) break;
    const BrickIndex& o = offsets_[i];
    const Front* const front = fronts_.of({brick[0] + o[0], brick[1] + o[1], brick[2] + o[2]});
    if (front == nullptr) continue;
    block.near.push_back({front, {8 * o[0], 8 * o[1], 8 * o[2]}, offset_min_[i]});
  }
}

// The center's distance, from the fronts around.
float CenterDistances::search(const BrickIndex& brick, Searched& block, int at) {
  if (!block.has_near) find_near(brick, block);
  const glm::vec3 center(static_cast<float>(at / 81) + 0.5f, static_cast<float>(at / 9 % 9) + 0.5f,
                         static_cast<float>(at % 9) + 0.5f);
  const auto min_of_front = static_cast<float>(fronts_.min_voxels());
  auto best = static_cast<float>(cap_);
  for (const Searched::Near& near : block.near) {
    if (near.smallest + min_of_front >= best) break;
    const Front& f = *near.front;
    const glm::vec3 from = center - near.low;
    best = min_sum({f.x.data(), f.y.data(), f.z.data(), f.smallest.data(), f.x.size()}, from.x,
                   from.y, from.z, best);
  }
  const auto i = static_cast<std::size_t>(at);
  double distance = fronts_.distance_voxels(best, block.known[i]);
  if (cropped_) {
    const glm::dvec3 place =
        glm::dvec3(8.0 * brick[0], 8.0 * brick[1], 8.0 * brick[2]) + glm::dvec3(center);
    distance = std::max(0.0, std::min(distance, side_distance(place)));
  }
  const auto rounded = static_cast<float>(distance) * kRoundDown;
  return block.squared[i] = rounded * rounded * kRoundDown;
}

double CenterDistances::at(const glm::dvec3& place) {
  if (!is_within(place, kMaxVoxel)) return std::min(cap_, free_around(place));
  const glm::dvec3 from_center = place - 0.5;
  const std::int32_t v[3] = {floor_of(from_center.x), floor_of(from_center.y),
                             floor_of(from_center.z)};
  const BrickIndex brick{v[0] >> 3, v[1] >> 3, v[2] >> 3};
  const std::uint64_t key = key_of(brick);
  const Slot& slot = slots_[slot_of(key)];
  Block& block = slot.key == key ? *slot.block : block_of(brick, key);
  const int first = in_block(v[0] & 7, v[1] & 7, v[2] & 7);
  double corner[8];
  for (int n = 0; n < 8; ++n) {
    const int at = first + in_block(n >> 2, n >> 1 & 1, n & 1);
    if (!searches_) {
      corner[n] = squared_of_code_[block.code[static_cast<std::size_t>(at)]];
      continue;
    }
    float squared = block.searched->squared[static_cast<std::size_t>(at)];
    if (squared < 0) squared = search(brick, *block.searched, at);
    corner[n] = static_cast<double>(squared);
  }
  const double x = from_center.x - v[0], y = from_center.y - v[1], z = from_center.z - v[2];
  const auto mix = [](double a, double b, double fraction) { return a + (b - a) * fraction; };
  const double low = mix(mix(corner[0], corner[1], z), mix(corner[2], corner[3], z), y);
  const double high = mix(mix(corner[4], corner[5], z), mix(corner[6], corner[7], z), y);
  const double lost = x * (1 - x) + y * (1 - y) + z * (1 - z) + kSumRounding;
  return std::sqrt(std::max(0.0, mix(low, high, x) - lost));
}

CenterDistances::Nearest CenterDistances::nearest(const glm::dvec3& place) {
  Nearest nearest{0, std::numeric_limits<double>::infinity()};
  if (!is_within(place, kMaxVoxel)) return nearest;
  const glm::dvec3 low = glm::floor(place / 8.0);
  const BrickIndex brick{static_cast<std::int32_t>(low.x), static_cast<std::int32_t>(low.y),
                         static_cast<std::int32_t>(low.z)};
  for (std::size_t i = 0; i < offsets_.size(); ++i) {
    if (offset_min_[i] > nearest.max_voxels + 1) break;
    const BrickIndex& o = offsets_[i];
    const Front* const front = mesh_fronts_.of({brick[0] + o[0], brick[1] + o[1], brick[2] + o[2]});
    if (front == nullptr) continue;
    const glm::dvec3 from = place - 8.0 * low - glm::dvec3(8 * o[0], 8 * o[1], 8 * o[2]);
    for (std::size_t n = 0; n < front->x.size(); ++n) {
      const double sum = glm::length(glm::dvec3(front->x[n], front->y[n], front->z[n]) - from) +
                         double{front->largest[n]};
      if (sum >= nearest.max_voxels || front->smallest[n] >= Front::kFar) continue;
      nearest = {front->object[n], sum};
    }
  }
  return nearest;
}

}  // namespace forcelayer::clearance
