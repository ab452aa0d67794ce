#include "pointshell/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pointshell/parallel.h"
#include "pointshell/pieces.h"
#include "pointshell/point_grid.h"

namespace forcelayer {
namespace {

// Pieces start at most this long (in radii); a ball seldom holds a larger one.
constexpr double kTileEdge = 1.5;
// A piece this small (in radii) that is still undecided counts as a hole: the two balls that share
// it leave less room than this.
constexpr double kSmallestEdge = 1e-8;
constexpr std::size_t kTilesPerTask = 128;

// Proves single tiles; one of it per task, as it keeps scratch memory.
class TileProver {
 public:
  TileProver(const PointGrid& grid, double radius) : grid_(grid), radius_(radius) {}

  void prove(const Piece& tile) {
    candidates_.clear();
    const Vec3 middle = centroid(tile);
    const double reach = radius_ + reach_from(middle, tile);
    grid_.visit_near(middle, reach, [&](std::uint32_t, const Vec3& point) {
      if (length_squared(point - middle) <= reach * reach) candidates_.push_back(point);
    });
    prove(tile, 0, candidates_.size());
  }

  std::vector<Hole> holes;
  std::uint64_t pieces = 0;

 private:
  // The candidates of a piece are candidates_[first, last).
  void prove(const Piece& piece, std::size_t first, std::size_t last) {
    ++pieces;
    std::array<double, 3> nearest;
    if (one_ball_holds(piece, first, last, nearest)) return;
    const auto farthest = std::max_element(nearest.begin(), nearest.end());
    const LongestEdge longest = longest_edge(piece);
    const bool too_small =
        longest.length_squared < kSmallestEdge * kSmallestEdge * radius_ * radius_;
    if (*farthest > radius_ * radius_ || too_small) {
      holes.push_back({piece[farthest - nearest.begin()], std::sqrt(*farthest)});
      return;
    }
    for (const Piece& half : bisected(piece, longest.from)) {
      const std::size_t half_first = candidates_.size();
      narrow(half, first, last);
      prove(half, half_first, candidates_.size());
      candidates_.resize(half_first);
    }
  }

  // Whether one candidate is within the radius of all corners; if not, the squared distance of each
  // corner to its nearest candidate.
  bool one_ball_holds(const Piece& piece, std::size_t first, std::size_t last,
                      std::array<double, 3>& nearest) const {
    const double beyond = 4 * radius_ * radius_;  // farther than the reach of any candidate
    nearest = {beyond, beyond, beyond};
    for (std::size_t n = first; n < last; ++n) {
      const Vec3& point = candidates_[n];
      const double a = length_squared(piece[0] - point);
      const double b = length_squared(piece[1] - point);
      const double c = length_squared(piece[2] - point);
      if (std::max({a, b, c}) <= radius_ * radius_) return true;
      nearest = {std::min(nearest[0], a), std::min(nearest[1], b), std::min(nearest[2], c)};
    }
    return false;
  }

  // Appends those of candidates_[first, last) whose balls reach `piece`.
  void narrow(const Piece& piece, std::size_t first, std::size_t last) {
    const Vec3 middle = centroid(piece);
    const double reach = radius_ + reach_from(middle, piece);
    for (std::size_t n = first; n < last; ++n) {
      const Vec3 point = candidates_[n];
      if (length_squared(point - middle) <= reach * reach) candidates_.push_back(point);
    }
  }

  const PointGrid& grid_;
  const double radius_;
  std::vector<Vec3> candidates_;  // a stack, one range for every level of the recursion
};

void prove_batch(std::span<const Piece> tiles, const PointGrid& grid, double radius,
                 CoveringProof& proof) {
  const std::size_t tasks = (tiles.size() + kTilesPerTask - 1) / kTilesPerTask;
  std::vector<TileProver> provers(tasks, TileProver(grid, radius));
  parallel_for_each_index(tasks, 1, [&](std::size_t task) {
    const std::size_t end = std::min((task + 1) * kTilesPerTask, tiles.size());
    for (std::size_t n = task * kTilesPerTask; n < end; ++n) provers[task].prove(tiles[n]);
  });
  for (const TileProver& prover : provers) {
    proof.holes.insert(proof.holes.end(), prover.holes.begin(), prover.holes.end());
    proof.pieces += prover.pieces;
  }
}

}  // namespace

double proof_margin(const Part& part, double radius) {
  // Every source of error is a few units in the last place of the largest coordinate; midpoints add
  // one for each of at most 64 bisections. 2^-44 is 512 units.
  return std::ldexp(part.largest_coordinate + radius, -44);
}

CoveringProof prove_covering(const Part& part, std::span<const Vec3> points, double radius) {
  const double proof_radius = radius - proof_margin(part, radius);
  const PointGrid grid(points, kTileEdge * radius);
  CoveringProof proof;
  for_each_tile_batch(part, kTileEdge * proof_radius, [&](std::span<const Piece> tiles) {
    prove_batch(tiles, grid, proof_radius, proof);
  });
  proof.proven = proof.holes.empty();
  return proof;
}

}  // namespace forcelayer
