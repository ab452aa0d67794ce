#include "runtime/guard/flush_walls.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>

namespace forcelayer::guard {
namespace {

using Distances = std::array<float, 8>;  // of a cell, z fastest

// The product of two slopes below which they are of two sides of a plane: each is almost 1.
constexpr float kOpposite = -0.9f;
// A wall thicker than this, in voxels, is a solid: stored distances in it are deep.
constexpr float kMaxThickness = 1.74f;
constexpr float kDeep = -0.9f, kInSolid = 1.2f;  // so far behind the surface there are such
// The stored distances of a cell through which a wall goes are off by so much at most, in voxels.
// Where they are off by no more than rounding explains, no other direction can fit better.
constexpr float kTolerance = 0.06f, kRounding = 0.02f;
// The slope in a cell leads to the wall, if it is this steep; from the wall's surface to its middle
// it may be so far, in voxels.
constexpr float kLeads = 0.5f, kBehindSurface = 0.5f;

// The eight cells around a cell that have a corner of it each hold 64 distances, z fastest.
constexpr int kRow = 4, kLayer = 16;
constexpr std::array<int, 8> kInBlock{0,      1,          kRow,          kRow + 1,
                                      kLayer, kLayer + 1, kLayer + kRow, kLayer + kRow + 1};

// Half of the directions from a cell to the cells around it; the first ones are the farthest.
constexpr std::array<std::array<int, 3>, 13> kAside{{{1, 1, 1},
                                                     {1, 1, -1},
                                                     {1, -1, 1},
                                                     {1, -1, -1},
                                                     {0, 1, 1},
                                                     {0, 1, -1},
                                                     {1, 0, 1},
                                                     {1, 0, -1},
                                                     {1, 1, 0},
                                                     {1, -1, 0},
                                                     {1, 0, 0},
                                                     {0, 1, 0},
                                                     {0, 0, 1}}};

// From a cell's middle to a corner of it, doubled.
glm::vec3 corner(std::size_t n) {
  return {(n & 4) != 0 ? 1 : -1, (n & 2) != 0 ? 1 : -1, (n & 1) != 0 ? 1 : -1};
}

float mean_of(const Distances& distances) {
  float sum = 0;
  for (const float distance : distances) sum += distance;
  return 0.125f * sum;
}

glm::vec3 slope_of(const Distances& d) {
  const float a = d[7] - d[0], b = d[6] - d[1], c = d[5] - d[2], e = d[4] - d[3];
  return 0.25f * glm::vec3(a + b + c + e, a + b - c - e, a - b + c - e);
}

Distances cell_of(std::span<const float, 64> block, const glm::ivec3& aside) {
  const int first = (aside.x + 1) * kLayer + (aside.y + 1) * kRow + aside.z + 1;
  Distances distances;
  for (std::size_t n = 0; n < 8; ++n) {
    distances[n] = block[static_cast<std::size_t>(first + kInBlock[n])];
  }
  return distances;
}

}  // namespace

FlushWalls::FlushWalls(const field::FieldProbe& probe) : probe_(probe), cells_(1) {}

void FlushWalls::reserve(std::size_t points) {
  constexpr std::size_t kMin = 256, kMax = 32768;
  cells_.assign(std::bit_ceil(std::clamp(4 * points, kMin, kMax)), Cell{});
}

FlushWall FlushWalls::beside(std::uint32_t i) const noexcept {
  const glm::vec3 in_voxel = probe_.in_voxel(i) - 0.5f, low = glm::floor(in_voxel);
  const glm::ivec3 voxel = probe_.voxel(i) + glm::ivec3(low);
  const std::uint32_t hash = static_cast<std::uint32_t>(voxel.x) * 0x9e3779b1u ^
                             static_cast<std::uint32_t>(voxel.y) * 0x85ebca6bu ^
                             static_cast<std::uint32_t>(voxel.z) * 0xc2b2ae35u;
  Cell& cell = cells_[(hash ^ hash >> 15) & (cells_.size() - 1)];
  if (cell.voxel != voxel) cell = {voxel, near_cell(voxel)};
  const FlushWall& wall = cell.wall;
  return {wall.direction, wall.height + glm::dot(wall.direction, in_voxel - low - 0.5f)};
}

// Where the wall does not go through the cell itself, the cell's slope leads to the one that it
// goes through.
FlushWall FlushWalls::near_cell(const glm::ivec3& voxel) const noexcept {
  constexpr int kReach = 5;
  if (!probe_.has_distances(voxel - kReach, voxel + kReach)) return {};
  const Distances own = probe_.cell_distances(voxel);
  const glm::vec3 slope = slope_of(own);
  const float steepness = glm::length(slope);
  if (steepness < kLeads) return through_cell(voxel);
  // As far behind the surface as that, or before it.
  const auto cell_at = [&](float behind) {
    const float way = std::clamp(mean_of(own) + behind, -1.0f, 3.0f);
    return glm::ivec3(glm::floor(0.5f - way / steepness * slope));
  };
  if (std::ranges::min(probe_.cell_distances(voxel + cell_at(kInSolid))) < kDeep) return {};
  FlushWall wall;
  glm::ivec3 last(kReach);
  for (const glm::ivec3& to : {glm::ivec3(0), cell_at(0), cell_at(kBehindSurface)}) {
    if (to == last) continue;
    last = to;
    wall = through_cell(voxel + to);
    if (!wall.is_known()) continue;
    wall.height -= glm::dot(wall.direction, glm::vec3(to));
    break;
  }
  return wall;
}

// Two opposite ones of the cells around a cell lie on both sides of a wall that goes through it:
// their slopes are opposite, and their distances tell direction, middle and thickness. The cell's
// own distances must be those of this wall, so its end is not there, nor another wall. Near an end
// the cells of some directions lie beyond it: the direction that fits best counts.
FlushWall FlushWalls::through_cell(const glm::ivec3& voxel) const noexcept {
  std::array<float, 64> block;
  for (std::size_t n = 0; n < 8; ++n) {
    const glm::ivec3 to(corner(n));
    const Distances part = probe_.cell_distances(voxel + to);
    const int first = (to.x + 1) * kLayer + (to.y + 1) * kRow + to.z + 1;
    for (std::size_t k = 0; k < 8; ++k) {
      block[static_cast<std::size_t>(first + kInBlock[k])] = part[k];
    }
  }
  const Distances own = cell_of(block, glm::ivec3(0));
  FlushWall best;
  float least = kTolerance;
  for (const auto& [x, y, z] : kAside) {
    const glm::ivec3 aside(x, y, z);
    const Distances there = cell_of(block, aside), back = cell_of(block, -aside);
    const glm::vec3 rise = slope_of(there), fall = slope_of(back);
    if (!(glm::dot(rise, fall) < kOpposite)) continue;
    const glm::vec3 direction = glm::normalize(rise - fall);
    const float high = mean_of(there), low = mean_of(back);
    const float thickness = 2 * glm::dot(direction, glm::vec3(aside)) - high - low;
    if (!(thickness > -kTolerance && thickness < kMaxThickness)) continue;
    const FlushWall wall{direction, 0.5f * (high - low)};
    float off = 0;
    for (std::size_t n = 0; n < 8; ++n) {
      const float height = wall.height + 0.5f * glm::dot(direction, corner(n));
      off = std::max(off, std::abs(own[n] - (std::abs(height) - 0.5f * thickness)));
    }
    if (!(off < least)) continue;
    least = off, best = wall;
    if (off < kRounding) break;
  }
  return best;
}

}  // namespace forcelayer::guard
