#include "pointshell/certificate/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "pointshell/certificate/convex_polygon.h"
#include "pointshell/certificate/flat_patches.h"
#include "pointshell/certificate/hidden_surface.h"
#include "pointshell/certificate/point_grid.h"
#include "pointshell/part/parallel.h"
#include "pointshell/part/pieces.h"

namespace forcelayer::certificate {
namespace {

// In radii. Triangles are bisected to this edge before candidates for their balls are gathered.
constexpr double kTileEdge = 5;
constexpr double kGridCell = 4;
constexpr std::size_t kTilesPerTask = 32;
// In radii. An open piece whose ball is smaller than this is not cut further to find out whether it
// is hidden.
constexpr double kSmallestHidden = 0.1;
// In radii. Boxes of many pieces are not halved below this.
constexpr double kSmallestBox = 0.04;
// Proves single tiles; one of it per task, as it keeps scratch memory.
class TileProver {
 public:
  TileProver(const PointGrid& grid, double radius, const HiddenSurface* hidden)
      : grid_(grid), whole_radius_(radius), radius_(radius), hidden_(hidden) {}

  void prove(std::span<const part::Vec3> tile) {
    ConvexPolygon polygon(tile);
    const part::Vec3 middle = middle_of(tile);
    const double reach = radius_ + std::sqrt(polygon.farthest_squared(middle));
    candidates_.clear();
    grid_.visit_near(middle, reach, [&](std::uint32_t, const part::Vec3& point) {
      if (part::length_squared(point - middle) <= reach * reach) candidates_.push_back(point);
    });
    prove(polygon, 0, candidates_.size());
  }

  void prove(const SurfacePieces& dense) {
    bound_by_patches(
        dense, whole_radius_, [&](const FlatPatch& patch) { return covers(patch); },
        [&](const OrientedBox& box, const SurfacePieces& inside) { return covers(box, inside); },
        [&](std::span<const part::Vec3> polygon) { prove(polygon); });
  }

  std::vector<Hole> holes;
  std::uint64_t pieces = 0;

 private:
  // Whether points cover the rectangle with so much to spare that they cover all near it.
  bool covers(const FlatPatch& patch) {
    const std::size_t known = holes.size();
    radius_ = whole_radius_ - patch.gap;
    prove(patch.corners);
    radius_ = whole_radius_;
    const bool covered = holes.size() == known;
    holes.resize(known);
    return covered;
  }

  // Whether points cover the box. Where it is small, in smaller boxes around its pieces: of most
  // boxes without a hole no piece is looked at.
  bool covers(const OrientedBox& box, const SurfacePieces& pieces_inside) const {
    if (covers(box)) return true;
    if (box.radius() >= kSmallestHalved * whole_radius_) return false;
    if (box.radius() < kSmallestBox * whole_radius_) return false;
    for (const SurfacePieces& side :
         pieces_inside.split(box.half[0], part::dot(box.half[0], box.middle))) {
      if (side.size() > 0 && !covers(box_around(side), side)) return false;
    }
    return true;
  }

  // Whether the ball of one point holds the box: it then holds all surface inside.
  bool covers(const OrientedBox& box) const {
    const std::array<part::Vec3, 8> corners = box.corners();
    bool is_held = false;
    grid_.visit_near(box.middle, radius_, [&](std::uint32_t, const part::Vec3& point) {
      is_held = is_held || std::all_of(corners.begin(), corners.end(), [&](const part::Vec3& c) {
                  return part::length_squared(c - point) <= radius_ * radius_;
                });
    });
    return is_held;
  }

  static part::Vec3 middle_of(std::span<const part::Vec3> corners) {
    part::Vec3 sum;
    for (const part::Vec3& corner : corners) sum += corner;
    return (1.0 / static_cast<double>(corners.size())) * sum;
  }

  // The candidate of [first, last), not empty, that is nearest to `place`.
  std::size_t nearest_candidate(const part::Vec3& place, std::size_t first,
                                std::size_t last) const {
    std::size_t nearest = first;
    double squared = part::length_squared(candidates_[first] - place);
    for (std::size_t n = first + 1; n < last; ++n) {
      const double other = part::length_squared(candidates_[n] - place);
      if (other < squared) nearest = n, squared = other;
    }
    return nearest;
  }

  // The candidates of a piece are candidates_[first, last): all points whose balls can reach it,
  // except those that are farther from every place of it than another candidate. So a corner's
  // nearest candidate is its nearest point, and with every cut each side loses a candidate.
  void prove(ConvexPolygon& piece, std::size_t first, std::size_t last) {
    if (piece.empty()) return;
    ++pieces;
    const part::Vec3 middle = middle_of(piece.corners());
    if (first == last)
      return prove_hidden(piece, piece.corners().front(), 2 * radius_, first, last);
    const std::size_t inner = nearest_candidate(middle, first, last);
    const part::Vec3 inner_point = candidates_[inner];
    const part::Vec3* outermost = nullptr;
    double outermost_squared = radius_ * radius_;
    for (const part::Vec3& corner : piece.corners()) {
      const double squared = part::length_squared(corner - inner_point);
      if (squared > outermost_squared) outermost = &corner, outermost_squared = squared;
    }
    if (!outermost) return;
    const std::size_t outer = nearest_candidate(*outermost, first, last);
    const part::Vec3 outer_point = candidates_[outer];
    const double distance_squared = part::length_squared(*outermost - outer_point);
    if (distance_squared > radius_ * radius_) {
      return prove_hidden(piece, *outermost, std::sqrt(distance_squared), first, last);
    }
    if (piece.farthest_squared(outer_point) <= radius_ * radius_) return;
    // The outermost corner is nearer to the outer point and the middle to the inner one (or the
    // same to both): the plane between them cuts the piece.
    const part::Vec3 normal = outer_point - inner_point;
    ConvexPolygon rest;
    piece.split(normal, part::dot(normal, 0.5 * (inner_point + outer_point)), rest);
    prove_with(piece, first, last, outer);
    prove_with(rest, first, last, inner);
  }

  // Proves `piece` with those of the candidates that can reach it, and without candidate `dropped`.
  void prove_with(ConvexPolygon& piece, std::size_t first, std::size_t last, std::size_t dropped) {
    if (piece.empty()) return;
    const part::Vec3 middle = middle_of(piece.corners());
    const double reach = radius_ + std::sqrt(piece.farthest_squared(middle));
    const std::size_t own_first = candidates_.size();
    for (std::size_t n = first; n < last; ++n) {
      const part::Vec3 point = candidates_[n];
      if (n != dropped && part::length_squared(point - middle) <= reach * reach) {
        candidates_.push_back(point);
      }
    }
    prove(piece, own_first, candidates_.size());
    candidates_.resize(own_first);
  }

  // A corner of the piece is out of reach of all points, so the open part of the piece must be
  // hidden. Cuts the piece to prove that, or adds a hole. A single hole fails the whole proof, so
  // after the first one pieces are not cut any smaller.
  void prove_hidden(ConvexPolygon& piece, const part::Vec3& corner, double distance,
                    std::size_t first, std::size_t last) {
    if (!hidden_ || !holes.empty()) return add_hole(piece, corner, distance);
    const part::Vec3 middle = middle_of(piece.corners());
    const double size = std::sqrt(piece.farthest_squared(middle));
    if (hidden_->holds_ball(middle, size)) return;
    if (size <= kSmallestHidden * radius_) return add_hole(piece, corner, distance);
    part::Vec3 farthest = middle;
    for (const part::Vec3& other : piece.corners()) {
      if (part::length_squared(other - middle) > part::length_squared(farthest - middle))
        farthest = other;
    }
    ConvexPolygon rest;
    const bool cut = piece.split(farthest - middle, part::dot(farthest - middle, middle), rest);
    if (!cut || rest.empty()) return add_hole(piece, corner, distance);
    prove_with(piece, first, last, last);
    prove_with(rest, first, last, last);
  }

  void add_hole(const ConvexPolygon& piece, const part::Vec3& corner, double distance) {
    holes.push_back({corner, distance, {piece.corners().begin(), piece.corners().end()}});
  }

  const PointGrid& grid_;
  const double whole_radius_;
  double radius_;  // of the proof in hand
  const HiddenSurface* hidden_;
  std::vector<part::Vec3> candidates_;  // a stack, one range for every level of the recursion
};

// Proves tile(0) to tile(count - 1), so many in a task, and adds the outcome to `proof`.
template <typename Tile>
void prove_tiles(std::size_t count, std::size_t tiles_per_task, const Tile& tile,
                 const PointGrid& grid, double radius, const HiddenSurface* hidden,
                 CoveringProof& proof) {
  const std::size_t tasks = (count + tiles_per_task - 1) / tiles_per_task;
  std::vector<TileProver> provers(tasks, TileProver(grid, radius, hidden));
  part::parallel_for_each_index(tasks, 1, [&](std::size_t task) {
    const std::size_t end = std::min((task + 1) * tiles_per_task, count);
    for (std::size_t n = task * tiles_per_task; n < end; ++n) provers[task].prove(tile(n));
  });
  for (TileProver& prover : provers) {
    std::move(prover.holes.begin(), prover.holes.end(), std::back_inserter(proof.holes));
    proof.pieces += prover.pieces;
  }
}

}  // namespace

double proof_margin(const part::Part& part, double radius) {
  // Every source of error is a few units in the last place of the largest coordinate; midpoints and
  // cuts add a few for each of far fewer than 100 in a row. 2^-44 is 512 units.
  return std::ldexp(part.largest_coordinate + radius, -44);
}

CoveringProof prove_covering(const part::Part& part, std::span<const part::Vec3> points,
                             double radius, std::size_t max_holes) {
  const double proof_radius = radius - proof_margin(part, radius);
  CoveringProof proof;
  if (!(proof_radius > 0)) {
    const part::Piece piece = part::triangle_piece(part, 0);
    proof.holes.push_back({piece[0], 0, {piece.begin(), piece.end()}});
    proof.given_up = true;
    return proof;
  }
  const PointGrid grid(points, kGridCell * radius);
  part::for_each_tile_batch(
      part, kTileEdge * proof_radius, [&](std::span<const part::Piece> tiles) {
        const TileGroups groups = group_tiles(tiles, kTileEdge * proof_radius);
        const auto sparse = [&](std::size_t n) {
          return std::span<const part::Vec3>(tiles[groups.sparse[n]]);
        };
        const auto dense = [&](std::size_t n) -> const SurfacePieces& { return groups.dense[n]; };
        prove_tiles(groups.sparse.size(), kTilesPerTask, sparse, grid, proof_radius, nullptr,
                    proof);
        prove_tiles(groups.dense.size(), 1, dense, grid, proof_radius, nullptr, proof);
        proof.given_up = proof.holes.size() > max_holes;
        return !proof.given_up;
      });
  proof.proven = proof.holes.empty();
  return proof;
}

CoveringProof continue_proof(const part::Part& part, std::span<const part::Vec3> points,
                             double radius, const CoveringProof& failed,
                             const HiddenSurface* hidden) {
  const PointGrid grid(points, kGridCell * radius);
  CoveringProof proof;
  proof.pieces = failed.pieces;
  prove_tiles(
      failed.holes.size(), kTilesPerTask,
      [&](std::size_t n) { return std::span<const part::Vec3>(failed.holes[n].piece); }, grid,
      radius - proof_margin(part, radius), hidden, proof);
  proof.proven = proof.holes.empty();
  return proof;
}

}  // namespace forcelayer::certificate
