#include "pointshell/certificate/surface_losses.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include "pointshell/certificate/convex_combination.h"
#include "pointshell/certificate/flat_patches.h"
#include "pointshell/certificate/hidden_surface.h"
#include "pointshell/certificate/point_grid.h"
#include "pointshell/part/parallel.h"
#include "pointshell/part/pieces.h"

namespace forcelayer::certificate {
namespace {

// In radii.
constexpr double kTileEdge = 3;  // triangles are bisected to this edge first
// Stored losses may be this much above the largest at a corner, and above that of a plane.
constexpr double kTolerance = 0.01, kPlaneTolerance = 0.03;
constexpr double kSmallest = 0.02;       // a piece smaller than this is not bisected
constexpr double kSmallestHidden = 0.1;  // an open piece that might be hidden is bisected to this
// A tile that reaches less deep into the box of every solid is not hidden.
constexpr double kMinDepth = kSmallestHidden / 2;
constexpr double kSmallestOfPatch = 0.1;  // the pieces of a patch are not bisected below this
constexpr double kStoredMargin = 1e-4;    // outweighs that another machine rounds another way
// Claims are proven down to smaller pieces than those that they were found with.
constexpr double kSmallestClaimed = 0.005;
constexpr std::size_t kMaxEstimated = 64;  // pieces of a group that the estimate looks at
// Distances of the table, in aimed distances: each is this factor above the one before. Between
// them the losses of neighbors lose less than a hundredth of a voxel.
constexpr std::size_t kLosses = 12;
constexpr double kFirstLoss = 0.5920802773, kLossRatio = 1.14;
// The distance at which points are to prove much: the middle of the force layer, and no less than
// it is for the covering radius of voxel centers.
constexpr double kAimedVoxels = 1.64, kAimedRadii = 1.894;

struct Corner {
  part::Vec3 place;
  Combination combination;
};
using CornerPiece = std::array<Corner, 3>;

double edge_squared(const CornerPiece& piece, int corner) {
  return part::length_squared(piece[(corner + 1) % 3].place - piece[corner].place);
}

int longest_edge(const CornerPiece& piece) {
  int longest = 0;
  for (int corner = 1; corner < 3; ++corner) {
    if (edge_squared(piece, corner) > edge_squared(piece, longest)) longest = corner;
  }
  return longest;
}

// The second moments of a piece's corners about one place o, which is chosen to make the largest of
// them small.
std::array<double, 3> moments_about_common_place(const CornerPiece& piece) {
  const auto about = [&](const part::Vec3& o) {
    std::array<double, 3> moments;
    for (int n = 0; n < 3; ++n) {
      const Combination& c = piece[n].combination;
      moments[n] = c.second_moment + part::length_squared(c.place - o);
    }
    return moments;
  };
  const auto largest_of = [](const std::array<double, 3>& m) {
    return std::max({m[0], m[1], m[2]});
  };
  const part::Vec3& c0 = piece[0].combination.place;
  std::array<double, 3> best = about(c0);
  const auto consider = [&](const part::Vec3& o) {
    const std::array<double, 3> moments = about(o);
    if (largest_of(moments) < largest_of(best)) best = moments;
  };
  for (int n = 0; n < 3; ++n) {
    const Combination &a = piece[n].combination, &b = piece[(n + 1) % 3].combination;
    const part::Vec3 along = b.place - a.place;
    const double squared = part::length_squared(along);
    if (!(squared > 0)) continue;
    const double fraction = 0.5 + (b.second_moment - a.second_moment) / (2 * squared);
    consider(a.place + std::clamp(fraction, 0.0, 1.0) * along);
  }
  // The place in the corners' plane about which all three have the same moment.
  const part::Vec3 u = piece[1].combination.place - c0, v = piece[2].combination.place - c0;
  const double uu = part::dot(u, u), vv = part::dot(v, v), uv = part::dot(u, v);
  const double determinant = uu * vv - uv * uv;
  if (determinant > 1e-12 * uu * vv) {
    const double m0 = piece[0].combination.second_moment;
    const double ru = (uu + piece[1].combination.second_moment - m0) / 2;
    const double rv = (vv + piece[2].combination.second_moment - m0) / 2;
    consider(c0 + ((ru * vv - rv * uv) / determinant) * u +
             ((rv * uu - ru * uv) / determinant) * v);
  }
  return best;
}

// The same for any number of corners, about the mean of their combinations' places.
void moments_about_common_place(std::span<const Corner> corners, std::span<double> moments) {
  part::Vec3 mean;
  for (const Corner& corner : corners) mean += corner.combination.place;
  mean = (1.0 / static_cast<double>(corners.size())) * mean;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const Combination& c = corners[n].combination;
    moments[n] = c.second_moment + part::length_squared(c.place - mean);
  }
}

// The combinations of places that were asked for last, as neighboring pieces share corners.
class CornerCache {
 public:
  CornerCache(const PointGrid& grid, double radius, double point_distance)
      : finder_(grid, radius, point_distance), known_(kSlots) {}

  Corner at(const part::Vec3& place) {
    const auto bits = std::bit_cast<Bits>(place);
    Slot& slot = known_[slot_of(bits)];
    if (!slot.used || std::bit_cast<Bits>(slot.corner.place) != bits) {
      slot = {{place, finder_.at(place)}, true};
    }
    return slot.corner;
  }

 private:
  static constexpr std::size_t kSlots = 2048;
  struct Slot {
    Corner corner;
    bool used = false;
  };

  using Bits = std::array<std::uint64_t, 3>;  // of a place

  static std::size_t slot_of(const Bits& bits) {
    std::uint64_t hash = bits[0];
    hash = hash * 0x9e3779b97f4a7c15u + bits[1];
    hash = hash * 0x9e3779b97f4a7c15u + bits[2];
    return (hash * 0x9e3779b97f4a7c15u) >> 53;
  }

  CombinationFinder finder_;
  std::vector<Slot> known_;
};

// One for each thread. A corner is the same whoever asked before.
class CornerCaches {
 public:
  explicit CornerCaches(const CoveredPart& covered)
      : grid_(covered.points, CombinationFinder::kReach * covered.radius),
        of_thread_([this, &covered] {
          return CornerCache(grid_, covered.radius, aimed_distance(covered));
        }) {}

  CornerCache& own() { return of_thread_.local(); }

 private:
  const PointGrid grid_;
  tbb::enumerable_thread_specific<CornerCache> of_thread_;
};

using CornerBox = std::array<Corner, 8>;

// Bounds of the convex hull of three corners, or of a box's. Margins outweigh all rounding.
class PieceBounds {
 public:
  PieceBounds(const CornerPiece& piece, const CoveredPart& covered, double margin)
      : PieceBounds(piece, std::sqrt(edge_squared(piece, longest_edge(piece))), covered, margin) {
    const std::array<double, 3> moments = moments_about_common_place(piece);
    for (std::size_t n = 0; n < 3; ++n) moments_[n] = rounded_up(moments[n]);
  }
  // `size`: the longest edge, m.
  PieceBounds(const CornerBox& box, double size, const CoveredPart& covered, double margin)
      : PieceBounds(std::span<const Corner>(box), size, covered, margin) {
    moments_about_common_place(box, moments_);
    for (double& moment : moments_) moment = rounded_up(moment);
  }

  // The loss of every place of the piece is at most this. Every place is also within the radius of
  // a point.
  double loss(double point_distance) const {
    double largest = 0;
    for (std::size_t n = 0; n < corners_.size(); ++n) {
      largest = std::max(largest, distance_loss(point_distance, moments_[n], gap(n)));
    }
    return std::min(largest, radius_);
  }

  // The largest loss at a corner, which no bisection makes smaller.
  double corner_loss(double point_distance) const {
    double largest = 0;
    for (std::size_t n = 0; n < corners_.size(); ++n) {
      largest = std::max(largest, corner_loss(n, point_distance));
    }
    return std::min(largest, radius_);
  }
  double corner_loss(std::size_t n, double point_distance) const {
    return distance_loss(point_distance, rounded_up(corners_[n].combination.second_moment), gap(n));
  }

  double largest_moment() const {
    return *std::max_element(moments_.begin(), moments_.begin() + std::ssize(corners_));
  }
  double largest_gap() const {
    double largest = gap(0);
    for (std::size_t n = 1; n < corners_.size(); ++n) largest = std::max(largest, gap(n));
    return largest;
  }
  double largest_corner_moment() const {
    double largest = 0;
    for (const Corner& corner : corners_) {
      largest = std::max(largest, rounded_up(corner.combination.second_moment));
    }
    return largest;
  }

  double size() const { return size_; }
  part::Vec3 middle() const {  // of a piece
    return (1.0 / 3) * (corners_[0].place + corners_[1].place + corners_[2].place);
  }
  std::span<const Corner> corners() const { return corners_; }

 private:
  PieceBounds(std::span<const Corner> corners, double size, const CoveredPart& covered,
              double margin)
      : corners_(corners),
        size_(size),
        radius_(covered.radius),
        margin_(margin),
        slack_(covered.slack) {}

  double gap(std::size_t n) const { return corners_[n].combination.gap + margin_ + slack_; }
  double rounded_up(double moment) const {
    constexpr double kReach = CombinationFinder::kReach;
    if (slack_ > 0) {
      const double farther = std::sqrt(moment) + slack_;
      moment = farther * farther;
    }
    return moment * (1 + 0x1p-44) + 0x1p-44 * kReach * kReach * radius_ * radius_;
  }

  const std::span<const Corner> corners_;
  const double size_, radius_, margin_, slack_;
  std::array<double, 8> moments_{};
};

enum class Verdict { kDone, kBisect, kOpen };

// Bisects pieces until `judge` is done with each. Hidden pieces are left out; one that the judge
// does not want to have bisected, and that is not hidden, is handed to judge.open(). One of it per
// task.
template <typename Judge>
class PieceProver {
 public:
  PieceProver(const CoveredPart& covered, CornerCache& corners, Judge& judge)
      : covered_(covered),
        margin_(proof_margin(covered.part, covered.radius)),
        aim_(aimed_distance(covered)),
        corners_(corners),
        judge_(judge) {}

  void prove(std::span<const part::Vec3> tile) {
    tell_hideable(tile);
    prove({corners_.at(tile[0]), corners_.at(tile[1]), corners_.at(tile[2])});
  }

  void prove(const SurfacePieces& dense) {
    if constexpr (Judge::kOnlyLooks) {
      const std::size_t step = (dense.size() + kMaxEstimated - 1) / kMaxEstimated;
      for (std::size_t n = 0; n < dense.size(); n += step) prove(dense[n].first(3));
    } else {
      bound_by_patches(
          dense, covered_.radius,
          [&](const FlatPatch& patch) {
            hideable_ = covered_.hidden != nullptr;
            return is_done(patch);
          },
          [&](const OrientedBox& box, const SurfacePieces&) { return is_done(box); },
          [&](std::span<const part::Vec3> polygon) {
            tell_hideable(polygon);
            for (std::size_t n = 2; n < polygon.size(); ++n) {
              prove(
                  {corners_.at(polygon[0]), corners_.at(polygon[n - 1]), corners_.at(polygon[n])});
            }
          });
    }
  }

  std::uint64_t pieces = 0;

 private:
  bool is_done(const FlatPatch& patch) {
    const Corner a = corners_.at(patch.corners[0]), b = corners_.at(patch.corners[1]),
                 c = corners_.at(patch.corners[2]), d = corners_.at(patch.corners[3]);
    return is_done({a, b, c}, patch.gap) && is_done({a, c, d}, patch.gap);
  }

  // Whether the judge is done with all surface in the box, or it is hidden.
  bool is_done(const OrientedBox& box) {
    if (judge_.given_up()) return true;
    ++pieces;
    CornerBox corners;
    const std::array<part::Vec3, 8> places = box.corners();
    for (std::size_t n = 0; n < places.size(); ++n) corners[n] = corners_.at(places[n]);
    const PieceBounds bounds(corners, 2 * part::length(box.half[0]), covered_, margin_);
    if (judge_.judge(bounds) == Verdict::kDone) return true;
    return covered_.hidden != nullptr && covered_.hidden->holds_ball(box.middle, box.radius());
  }

  // Whether the judge is done with the piece and all that is within `gap` of it.
  bool is_done(const CornerPiece& piece, double gap) {
    if (judge_.given_up()) return true;
    ++pieces;
    const PieceBounds bounds(piece, covered_, margin_ + gap);
    if (judge_.judge(bounds) == Verdict::kDone) return true;
    if (is_hidden(bounds, gap)) return true;
    if (bounds.size() < kSmallestOfPatch * covered_.radius) return false;
    const auto [first, second] = halves(piece);
    return is_done(first, gap) && is_done(second, gap);
  }

  void prove(const CornerPiece& piece) {
    if (judge_.given_up()) return;
    ++pieces;
    const PieceBounds bounds(piece, covered_, margin_);
    const Verdict verdict = judge_.judge(bounds);
    if (verdict == Verdict::kDone) return;
    if (is_hidden(bounds, 0)) return;
    const bool enough = !hideable_ || bounds.size() <= kSmallestHidden * covered_.radius;
    if (verdict == Verdict::kOpen && enough) return judge_.open(bounds);
    const auto [first, second] = halves(piece);
    prove(first);
    prove(second);
  }

  void tell_hideable(std::span<const part::Vec3> polygon) {
    hideable_ = false;
    if (covered_.hidden == nullptr) return;
    part::Box box;
    for (const part::Vec3& corner : polygon) box.grow(corner);
    hideable_ = covered_.hidden->may_hold(box, kMinDepth * covered_.radius);
  }

  bool is_hidden(const PieceBounds& bounds, double gap) const {
    return hideable_ && bounds.size() <= covered_.radius &&
           covered_.hidden->holds_ball(bounds.middle(), bounds.size() + gap);
  }

  std::array<CornerPiece, 2> halves(const CornerPiece& piece) {
    const int from = longest_edge(piece);
    const Corner &a = piece[from], &b = piece[(from + 1) % 3], &c = piece[(from + 2) % 3];
    const Corner middle = better(corners_.at(0.5 * (a.place + b.place)), a, b);
    return {CornerPiece{a, middle, c}, CornerPiece{middle, b, c}};
  }

  // The corner halfway between two others, with its own combination or with the mean of theirs.
  Corner better(Corner own, const Corner& a, const Corner& b) const {
    const Combination &ca = a.combination, &cb = b.combination;
    const part::Vec3 middle = 0.5 * (ca.place + cb.place);
    const Combination mean{middle,
                           0.5 * (ca.second_moment + cb.second_moment) +
                               0.25 * part::length_squared(ca.place - cb.place),
                           part::length(own.place - middle)};
    const auto loss = [&](const Combination& c) {
      return distance_loss(aim_, c.second_moment, c.gap);
    };
    if (loss(mean) < loss(own.combination)) own.combination = mean;
    return own;
  }

  const CoveredPart& covered_;
  const double margin_, aim_;
  CornerCache& corners_;
  Judge& judge_;
  bool hideable_ = false;  // whether the tile in hand may be hidden, in part or whole
};

// Runs a judge over tiles [0, count), one copy of `judge` for each task of so many; returns the
// copies in order.
template <typename Judge, typename Tile>
std::vector<Judge> judge_tiles(const CoveredPart& covered, CornerCaches& corners,
                               const Judge& judge, std::size_t count, std::size_t tiles_per_task,
                               const Tile& tile, std::uint64_t& pieces,
                               const std::function<void(std::size_t)>& judged = {}) {
  const std::size_t tasks = (count + tiles_per_task - 1) / tiles_per_task;
  std::vector<Judge> judges(tasks, judge);
  std::vector<std::uint64_t> pieces_of(tasks);
  part::parallel_for_each_index(tasks, 1, [&](std::size_t task) {
    PieceProver<Judge> prover(covered, corners.own(), judges[task]);
    const std::size_t end = std::min((task + 1) * tiles_per_task, count);
    for (std::size_t n = task * tiles_per_task; n < end; ++n) prover.prove(tile(n));
    pieces_of[task] = prover.pieces;
    if (judged) judged(end - task * tiles_per_task);
  });
  for (const std::uint64_t n : pieces_of) pieces += n;
  return judges;
}

double area_of(std::span<const part::Piece> tiles) {
  double area = 0;
  for (const part::Piece& tile : tiles) {
    area += part::length(part::cross(tile[1] - tile[0], tile[2] - tile[0])) / 2;
  }
  return area;
}

// The same over the whole part; merge(judge) takes each copy, and ends it by returning false. How
// far it is goes by area, and within a batch by tiles.
template <typename Judge, typename Merge>
void judge_part(const CoveredPart& covered, const Judge& judge, std::uint64_t& pieces,
                const part::Progress& progress, const Merge& merge) {
  part::DoneWork done(progress, part::area(covered.part));
  CornerCaches corners(covered);
  part::for_each_tile_batch(
      covered.part, kTileEdge * covered.radius, [&](std::span<const part::Piece> tiles) {
        const TileGroups groups = group_tiles(tiles, kTileEdge * covered.radius);
        const double each_m2 =
            area_of(tiles) / static_cast<double>(groups.sparse.size() + groups.dense.size());
        const auto judged = [&](std::size_t count) {
          done.add(each_m2 * static_cast<double>(count));
        };
        const auto sparse = [&](std::size_t n) {
          return std::span<const part::Vec3>(tiles[groups.sparse[n]]);
        };
        const auto dense = [&](std::size_t n) -> const SurfacePieces& { return groups.dense[n]; };
        for (Judge& own : judge_tiles(covered, corners, judge, groups.sparse.size(),
                                      Judge::kTilesPerTask, sparse, pieces, judged)) {
          if (!merge(own)) return false;
        }
        for (Judge& own :
             judge_tiles(covered, corners, judge, groups.dense.size(), 1, dense, pieces, judged)) {
          if (!merge(own)) return false;
        }
        return true;
      });
}

// Looks for corners above a loss, and piece by piece for the largest loss at corners.
struct SearchJudge {
  double point_distance, limit;
  double smallest;  // m, of pieces without a corner above the limit
  std::vector<Hole> holes;
  static constexpr bool kOnlyLooks = false;
  static constexpr std::size_t kTilesPerTask = 64;

  bool given_up() const { return false; }
  Verdict judge(const PieceBounds& piece) const {
    if (piece.loss(point_distance) <= limit) return Verdict::kDone;
    if (piece.corner_loss(point_distance) > limit) return Verdict::kOpen;
    return piece.size() <= smallest ? Verdict::kDone : Verdict::kBisect;
  }
  void open(const PieceBounds& bounds) {
    const std::span<const Corner> piece = bounds.corners();
    std::size_t worst = 0;
    for (std::size_t n = 1; n < 3; ++n) {
      if (bounds.corner_loss(n, point_distance) > bounds.corner_loss(worst, point_distance))
        worst = n;
    }
    holes.push_back({piece[worst].place,
                     bounds.corner_loss(worst, point_distance),
                     {piece[0].place, piece[1].place, piece[2].place}});
  }
};

SearchJudge search_for(const CoveredPart& covered, double limit) {
  return {aimed_distance(covered), limit, kSmallest * covered.radius, {}};
}

void append(std::vector<Hole>& to, std::vector<Hole>& from) {
  std::move(from.begin(), from.end(), std::back_inserter(to));
}

using Distances = std::array<double, kLosses>;

Distances table_distances(const CoveredPart& covered) {
  Distances distances;
  double distance = kFirstLoss * aimed_distance(covered);
  for (double& own : distances) own = distance, distance *= kLossRatio;
  return distances;
}

// The largest losses at the corners of tiles, from which find_losses() sets out.
struct EstimateJudge {
  Distances distances;
  Distances losses{};
  static constexpr bool kOnlyLooks = true;
  static constexpr std::size_t kTilesPerTask = 64;

  bool given_up() const { return false; }
  Verdict judge(const PieceBounds& piece) {
    for (std::size_t i = 0; i < kLosses; ++i) {
      losses[i] = std::max(losses[i], piece.corner_loss(distances[i]));
    }
    return Verdict::kDone;
  }
  void open(const PieceBounds&) {}
};

// Finds losses that hold: pieces are bisected until they are as good as the estimate, as pieces
// before them, or about as their own corners.
struct FindJudge {
  struct Pair {
    double moment = -1, gap = -1;
    bool bounds(const Pair& other) const { return other.moment <= moment && other.gap <= gap; }
  };
  Distances distances, wanted;
  double slack;
  double smallest;  // m
  double radius;
  Distances losses{};
  double moment = 0, gap = 0;
  Pair known{};  // with this pair no loss is above those kept
  static constexpr bool kOnlyLooks = false;
  static constexpr std::size_t kTilesPerTask = 256;  // which the losses depend on

  bool given_up() const { return false; }
  Verdict judge(const PieceBounds& piece) {
    const Pair largest{piece.largest_moment(), piece.largest_gap()};
    if (changes_no_loss(largest)) {
      keep(largest);
      return Verdict::kDone;
    }
    Distances own;
    bool good = true, as_good_as_corners = true;
    for (std::size_t i = 0; i < kLosses; ++i) {
      own[i] = piece.loss(distances[i]);
      if (own[i] <= std::max(wanted[i], losses[i])) continue;
      good = false;
      as_good_as_corners = own[i] <= piece.corner_loss(distances[i]) + slack;
      if (!as_good_as_corners) break;  // nothing else is asked
    }
    if (good) {
      keep(own);
      keep(largest);
      return Verdict::kDone;
    }
    return as_good_as_corners || piece.size() <= smallest ? Verdict::kOpen : Verdict::kBisect;
  }
  // Keeps what holds for the piece.
  void open(const PieceBounds& piece) {
    Distances own;
    for (std::size_t i = 0; i < kLosses; ++i) own[i] = piece.loss(distances[i]);
    keep(own);
    keep(Pair{piece.largest_moment(), piece.largest_gap()});
  }

  // Whether the losses of a piece with no more than this moment and gap are known already. It is so
  // for most pieces, and asked with a twelfth of the roots.
  bool changes_no_loss(const Pair& largest) {
    if (known.bounds(largest)) return true;
    for (std::size_t i = 0; i < kLosses; ++i) {
      const double loss = distance_loss(distances[i], largest.moment, largest.gap);
      if (std::min(loss, radius) > losses[i]) return false;
    }
    known = largest;
    return true;
  }
  void keep(const Distances& own) {
    for (std::size_t i = 0; i < kLosses; ++i) losses[i] = std::max(losses[i], own[i]);
  }
  void keep(const Pair& largest) {
    if (largest.gap < radius) {
      moment = std::max(moment, largest.moment);
      gap = std::max(gap, largest.gap);
    } else {
      gap = std::max(gap, radius);  // the nearest point alone
    }
  }
};

struct ClaimJudge {
  const SurfaceDistanceTerms& claimed;
  double smallest;
  std::vector<part::Vec3> places;
  static constexpr bool kOnlyLooks = false;
  static constexpr std::size_t kTilesPerTask = 64;

  bool given_up() const { return !places.empty(); }
  Verdict judge(const PieceBounds& piece) const {
    const bool pair_holds =
        (piece.largest_gap() <= claimed.convex_gap_m &&
         piece.largest_moment() <= claimed.convex_radius_m * claimed.convex_radius_m) ||
        claimed.convex_gap_m >= claimed.covering_radius_m;
    const bool losses_hold = std::all_of(
        claimed.losses.begin(), claimed.losses.end(),
        [&](const DistanceLoss& entry) { return piece.loss(entry.distance_m) <= entry.loss_m; });
    if (pair_holds && losses_hold) return Verdict::kDone;
    return piece.size() > smallest ? Verdict::kBisect : Verdict::kOpen;
  }
  void open(const PieceBounds& piece) { places.push_back(piece.corners()[0].place); }
};

}  // namespace

double aimed_distance(const CoveredPart& covered) {
  return std::max(kAimedVoxels * covered.voxel_size, kAimedRadii * covered.radius);
}

std::vector<Hole> places_above_loss(const CoveredPart& covered, double limit,
                                    const part::Progress& progress) {
  std::vector<Hole> holes;
  std::uint64_t pieces = 0;
  judge_part(covered, search_for(covered, limit), pieces, progress, [&](SearchJudge& judge) {
    append(holes, judge.holes);
    return true;
  });
  return holes;
}

std::vector<Hole> places_above_loss(const CoveredPart& covered, double limit,
                                    std::span<const Hole> from) {
  std::vector<Hole> holes;
  std::uint64_t pieces = 0;
  CornerCaches corners(covered);
  const auto tile = [&](std::size_t n) { return std::span<const part::Vec3>(from[n].piece); };
  for (SearchJudge& judge : judge_tiles(covered, corners, search_for(covered, limit), from.size(),
                                        SearchJudge::kTilesPerTask, tile, pieces)) {
    append(holes, judge.holes);
  }
  return holes;
}

SurfaceLosses find_losses(const CoveredPart& covered, const part::Progress& progress) {
  SurfaceLosses found;
  const double radius = covered.radius;
  EstimateJudge estimate{table_distances(covered)};
  constexpr double kEstimateFraction = 0.3;  // of the time
  const auto estimated = [&](double done) { progress(kEstimateFraction * done); };
  judge_part(covered, estimate, found.pieces, estimated, [&](EstimateJudge& judge) {
    for (std::size_t i = 0; i < kLosses; ++i) {
      estimate.losses[i] = std::max(estimate.losses[i], judge.losses[i]);
    }
    return true;
  });
  FindJudge all{.distances = estimate.distances,
                .wanted = estimate.losses,
                .slack = kTolerance * radius,
                .smallest = kSmallest * radius,
                .radius = radius};
  for (std::size_t i = 0; i < kLosses; ++i) {
    const double of_plane = distance_loss(all.distances[i], radius * radius, 0);
    all.wanted[i] =
        std::max(all.wanted[i] + kTolerance * radius, of_plane + kPlaneTolerance * radius);
  }
  const FindJudge fresh = all;
  const auto proven = [&](double done) {
    progress(kEstimateFraction + (1 - kEstimateFraction) * done);
  };
  judge_part(covered, fresh, found.pieces, proven, [&](FindJudge& judge) {
    for (std::size_t i = 0; i < kLosses; ++i) {
      all.losses[i] = std::max(all.losses[i], judge.losses[i]);
    }
    all.moment = std::max(all.moment, judge.moment);
    all.gap = std::max(all.gap, judge.gap);
    return true;
  });
  const double margin = kStoredMargin * radius;
  found.convex_radius = std::sqrt(all.moment) + margin;
  found.convex_gap = all.gap + margin;
  for (std::size_t i = 0; i < kLosses; ++i) {
    found.losses.push_back({all.distances[i], std::min(all.losses[i] + margin, radius)});
  }
  return found;
}

LossProof prove_losses(const CoveredPart& covered, const SurfaceDistanceTerms& claimed) {
  LossProof proof;
  proof.proven = true;
  judge_part(covered, ClaimJudge{claimed, kSmallestClaimed * covered.radius, {}}, proof.pieces, {},
             [&](ClaimJudge& judge) {
               if (judge.places.empty()) return true;
               proof.proven = false;
               proof.open = judge.places.front();
               return false;
             });
  return proof;
}

}  // namespace forcelayer::certificate
