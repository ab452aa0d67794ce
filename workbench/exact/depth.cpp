#include "workbench/exact/depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "pointshell/part/pieces.h"
#include "workbench/exact/push_out.h"
#include "workbench/exact/watch.h"

namespace forcelayer::exact {
namespace {

using part::Piece;
using part::Vec3;

// Times that a piece is cut along the solid's triangles before it is cut in two.
constexpr int kMaxCuts = 3;
constexpr double kSameSide = 1 - 1e-9;  // exceeds the rounding of two distances

// A place of which it is known on which side it lies; so does all that is nearer than the surface.
struct Sided {
  Vec3 place;
  double distance_m = -1;  // from the surface; negative: nothing is known
  bool is_inside = false;
  bool all = false;  // of the piece lies there
};

// A node of the surface's tree that is to be searched yet, or a piece of a triangle of it, in the
// solid's frame.
struct Open {
  double at_most_m;
  std::size_t pair;
  bool is_piece;
  std::uint32_t node;
  Piece piece;
  Piece nearest;  // triangle of the solid, to the middle of a piece
  Sided sided;
  int cuts;  // along triangles of the solid, since it was last cut in two
  bool operator<(const Open& other) const { return at_most_m < other.at_most_m; }
};

double reach_of_m(const Piece& piece, const Vec3& center) {
  double reach = 0;
  for (const Vec3& corner : piece) reach = std::max(reach, part::length(corner - center));
  return reach;
}

// The corner that is farthest from a triangle, and its distance.
std::pair<Vec3, double> farthest_of(const Piece& piece, const Piece& triangle) {
  std::pair<Vec3, double> farthest{piece[0], -1};
  for (const Vec3& p : piece) {
    const Vec3 foot = part::nearest_on_triangle(p, triangle[0], triangle[1], triangle[2]);
    const double distance_m = part::length(p - foot);
    if (distance_m > farthest.second) farthest = {p, distance_m};
  }
  return farthest;
}

// How far a piece reaches from the plane of a triangle.
double off_plane_m(const Piece& piece, const Piece& triangle) {
  const Vec3 normal = part::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  const double length = part::length(normal);
  double off = length > 0 ? 0 : std::numeric_limits<double>::infinity();
  for (const Vec3& p : piece) {
    off = std::max(off, std::abs(part::dot(normal, p - triangle[0])) / length);
  }
  return off;
}

// The plane through an edge of a triangle and along its normal beyond which on either side a piece
// reaches farthest: how far its corners are from it. Nothing where it reaches no farther than
// `min_m` across any.
std::optional<std::array<double, 3>> straddled(const Piece& piece, const Piece& triangle,
                                               double min_m) {
  const Vec3 normal = part::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  std::optional<std::array<double, 3>> found;
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 inward = part::cross(normal, triangle[(n + 1) % 3] - triangle[n]);
    const double length = part::length(inward);
    if (length == 0) return std::nullopt;
    std::array<double, 3> off;
    for (std::size_t i = 0; i < 3; ++i) off[i] = part::dot(inward, piece[i] - triangle[n]) / length;
    const auto [low, high] = std::minmax_element(off.begin(), off.end());
    const double across = std::min(-*low, *high);
    if (across > min_m) min_m = across, found = off;
  }
  return found;
}

// Cuts a piece where what is given at its corners is zero. It is more and less than that there.
void cut_at_zero(const Piece& piece, const std::array<double, 3>& off, std::vector<Piece>& out) {
  const auto is_alone = [&](std::size_t n) {
    const bool side = off[n] > 0;
    return (off[(n + 1) % 3] > 0) != side && (off[(n + 2) % 3] > 0) != side;
  };
  std::size_t n = 0;
  while (!is_alone(n)) ++n;
  const std::size_t next = (n + 1) % 3, last = (n + 2) % 3;
  const auto cut = [&](std::size_t to) {
    return piece[n] + off[n] / (off[n] - off[to]) * (piece[to] - piece[n]);
  };
  const Vec3 a = cut(next), b = cut(last);
  out.push_back({piece[n], a, b});
  out.push_back({a, piece[next], piece[last]});
  out.push_back({a, piece[last], b});
}

// No place of a piece is farther from both triangles than this: the piece is cut where it is as far
// from one as from the other, and what is nearer to one is no farther from that than its corners.
double farthest_of_both_m(const Piece& piece, const Piece& one, const Piece& other) {
  std::array<double, 3> off;
  double to_one_m = 0, to_other_m = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto distance_m = [&](const Piece& t) {
      return part::length(piece[n] - part::nearest_on_triangle(piece[n], t[0], t[1], t[2]));
    };
    const double a = distance_m(one), b = distance_m(other);
    off[n] = a - b;
    to_one_m = std::max(to_one_m, a), to_other_m = std::max(to_other_m, b);
  }
  double farthest_m = std::min(to_one_m, to_other_m);
  const auto [low, high] = std::minmax_element(off.begin(), off.end());
  if (!(*low <= 0 && *high > 0)) return farthest_m;
  std::vector<Piece> halves;
  cut_at_zero(piece, off, halves);
  double of_halves_m = 0;
  for (const Piece& half : halves) {
    of_halves_m = std::max(
        of_halves_m, std::min(farthest_of(half, one).second, farthest_of(half, other).second));
  }
  return std::min(farthest_m, of_halves_m);
}

class Search {
 public:
  Search(std::span<const SurfaceInSolid> pairs, std::optional<double> allowed_m, double within_m,
         double within_fraction, const Depth& known)
      : pairs_(pairs),
        allowed_m_(allowed_m),
        within_m_(within_m),
        within_fraction_(within_fraction),
        found_(known) {
    for (const SurfaceInSolid& pair : pairs) {
      solid_from_surface_.push_back(inverse(pair.world_from_solid) * pair.world_from_surface);
    }
  }

  Depth run(const DepthProgress& progress) {
    double widest_m = 0;  // between what was found and what is known
    for (std::size_t pair = 0; pair < pairs_.size(); ++pair) {
      for (const std::uint32_t node : pairs_[pair].parts->nodes) open_node(pair, node, 1e300);
      for (const Piece& own : pairs_[pair].parts->pieces) {
        open_piece(pair, placed(pair, own), 1e300, {}, 0);
      }
    }
    while (!open_.empty() && !is_settled(open_.top().at_most_m) && !is_deeper()) {
      keep_going();
      if (progress) {
        const double gap_m = open_.top().at_most_m - enough_m();
        widest_m = std::max(widest_m, gap_m);
        if (widest_m > 0) progress(1 - gap_m / widest_m);
      }
      const Open top = open_.top();
      open_.pop();
      if (top.is_piece) {
        cut(top);
      } else {
        open_below(top);
      }
    }
    found_.at_most_m = std::max(settled_m_, found_.found_m);
    if (!open_.empty()) found_.at_most_m = std::max(found_.at_most_m, open_.top().at_most_m);
    found_.looked_at = looked_at_;
    return found_;
  }

 private:
  // The largest possible depth where no more need be known: one far from the depth that matters
  // need not be known closely.
  double enough_m() const {
    const double found_m = found_.found_m;
    double enough_m = found_m + std::max(within_m_, within_fraction_ * found_m);
    if (allowed_m_) enough_m = std::max(enough_m, (found_m + *allowed_m_) / 2);
    return enough_m;
  }
  // Whether a place is known to be deeper than allowed: that is all there is to know then.
  bool is_deeper() const { return allowed_m_ && found_.found_m > *allowed_m_; }
  bool is_settled(double at_most_m) const { return at_most_m <= enough_m(); }

  Vec3 placed(std::size_t pair, const Vec3& p) const {
    const Pose& pose = solid_from_surface_[pair];
    return vec3_of(pose.position_m + pose.orientation * dvec3_of(p));
  }

  Piece placed(std::size_t pair, const Piece& own) const {
    return {placed(pair, own[0]), placed(pair, own[1]), placed(pair, own[2])};
  }

  void open_below(const Open& top) {
    const part::TriangleTree& tree = pairs_[top.pair].surface->tree();
    const part::TriangleTree::Node& node = tree.nodes()[top.node];
    if (node.count == 0) {
      open_node(top.pair, top.node + 1, top.at_most_m);
      open_node(top.pair, node.first, top.at_most_m);
    }
    for (std::uint32_t n = 0; n < node.count; ++n) {
      const Piece own = part::triangle_piece(tree.part(), tree.ordered_triangles()[node.first + n]);
      open_piece(top.pair, placed(top.pair, own), top.at_most_m, {}, 0);
    }
  }

  // Along the triangle of the solid that is nearest, where that settles what lies on it; else, and
  // now and then, in two.
  void cut(const Open& top) {
    pieces_.clear();
    int cuts = 0;
    std::optional<std::array<double, 3>> off;
    if (top.cuts < kMaxCuts && is_settled(off_plane_m(top.piece, top.nearest))) {
      off = straddled(top.piece, top.nearest, within_m_ / 4);
    }
    if (off) {
      cut_at_zero(top.piece, *off, pieces_);
      cuts = top.cuts + 1;
    } else {
      for (const Piece& half : part::bisected(top.piece, part::longest_edge(top.piece).from)) {
        pieces_.push_back(half);
      }
    }
    for (const Piece& piece : pieces_) {
      open_piece(top.pair, piece, top.at_most_m, top.sided, cuts);
    }
  }

  void open_node(std::size_t pair, std::uint32_t number, double at_most_m) {
    ++looked_at_;
    const part::TriangleTree::Node& node = pairs_[pair].surface->tree().nodes()[number];
    const Vec3 low{node.low[0], node.low[1], node.low[2]},
        high{node.high[0], node.high[1], node.high[2]};
    const Vec3 center = placed(pair, 0.5 * (low + high));
    const double reach_m = part::length(high - low) / 2;
    const auto nearest = pairs_[pair].solid->tree().nearest(center);
    const double distance_m = std::sqrt(nearest.distance_squared);
    at_most_m = std::min(at_most_m, distance_m + reach_m);
    if (!settles(at_most_m)) {
      if (!pairs_[pair].solid->holds(center)) {
        at_most_m = std::min(at_most_m, outside_m(pair, center, distance_m, reach_m));
      }
      open_.push({at_most_m, pair, false, number, {}, {}, {}, 0});
    }
  }

  void open_piece(std::size_t pair, const Piece& piece, double at_most_m, Sided sided, int cuts) {
    ++looked_at_;
    const Body& solid = *pairs_[pair].solid;
    const Vec3 center = part::centroid(piece);
    const double reach_m = reach_of_m(piece, center);
    const auto nearest = solid.tree().nearest(center);
    const double distance_m = std::sqrt(nearest.distance_squared);
    const Piece triangle = part::triangle_piece(solid.tree().part(), nearest.point.triangle);
    const auto [corner, farthest_m] = farthest_of(piece, triangle);
    at_most_m = std::min({at_most_m, distance_m + reach_m, farthest_m});
    if (settles(at_most_m)) return;  // be the place inside or not
    // To know whether it is inside takes the most time. Close to the surface it changes little.
    const double crack_m = solid.crack_near_m(center, reach_m);
    const bool changes_little =
        distance_m <= found_.found_m + within_m_ / 2 && 2 * distance_m - crack_m < reach_m / 2;
    if (!changes_little) {
      take(pair, center, nearest, sided);
      // Through a crack a way leads to the other side, and no piece needs to meet the surface.
      sided.all = sided.all || (crack_m == 0 && !solid.may_meet(piece));
      if (!sided.is_inside) {
        at_most_m = std::min(at_most_m, reach_m - distance_m + crack_m);
        if (sided.all) at_most_m = std::min(at_most_m, 0.0);
        // How far the part of it that came in through a crack goes need not be known.
        const bool is_allowed = !allowed_m_ || at_most_m <= *allowed_m_;
        if (is_allowed && is_settled(reach_m - distance_m)) {
          settled_m_ = std::max(settled_m_, at_most_m);
          return;
        }
      }
      if (settles(at_most_m)) return;
    }
    // As deep as it may be.
    if (farthest_m > found_.found_m + within_m_ / 2) {
      const auto there = solid.tree().nearest(corner);
      if (std::sqrt(there.distance_squared) > found_.found_m) {
        Sided of_corner = sided;
        take(pair, corner, there, of_corner);
      }
      const Piece beyond = part::triangle_piece(solid.tree().part(), there.point.triangle);
      at_most_m = std::min(at_most_m, farthest_of_both_m(piece, triangle, beyond));
      if (settles(at_most_m)) return;
    }
    const double enough = enough_m();
    if (enough > 0 && distance_m < reach_m + enough && comes_free(solid, Hull(piece), enough)) {
      settled_m_ = std::max(settled_m_, std::min(at_most_m, enough));
      return;
    }
    if (reach_m <= within_m_ / 4) {
      settled_m_ = std::max(settled_m_, at_most_m);
    } else {
      open_.push({at_most_m, pair, true, 0, piece, triangle, sided, cuts});
    }
  }

  // Finds on which side a place lies, from one whose side is known, and how deep.
  void take(std::size_t pair, const Vec3& place, const part::TriangleTree::Nearest& nearest,
            Sided& sided) {
    const Body& solid = *pairs_[pair].solid;
    const double distance_m = std::sqrt(nearest.distance_squared);
    const double way_m = part::length(place - sided.place);
    const bool is_known = sided.all || (way_m < kSameSide * sided.distance_m &&
                                        solid.crack_near_m(sided.place, way_m) == 0);
    sided = {place, distance_m, is_known ? sided.is_inside : solid.holds(place), sided.all};
    const double depth_m = sided.is_inside ? distance_m : -distance_m;
    if (depth_m > found_.found_m) found_ = found(pair, depth_m, place, nearest.point.position);
  }

  // No place within reach of one that is outside is deeper. It may come in through a crack.
  double outside_m(std::size_t pair, const Vec3& center, double distance_m, double reach_m) const {
    return reach_m - distance_m + pairs_[pair].solid->crack_near_m(center, reach_m);
  }

  Depth found(std::size_t pair, double depth_m, const Vec3& place, const Vec3& foot) const {
    const Pose& solid = pairs_[pair].world_from_solid;
    const auto world = [&](const Vec3& p) {
      return solid.position_m + solid.orientation * dvec3_of(p);
    };
    return {depth_m, 0, world(place), world(foot), pair, 0};
  }

  // Whether no more need be known of a piece.
  bool settles(double at_most_m) {
    if (!is_settled(at_most_m)) return false;
    settled_m_ = std::max(settled_m_, at_most_m);
    return true;
  }

  std::span<const SurfaceInSolid> pairs_;
  std::optional<double> allowed_m_;
  double within_m_, within_fraction_;
  std::vector<Pose> solid_from_surface_;
  std::priority_queue<Open> open_;
  std::vector<Piece> pieces_;                                    // of cut()
  double settled_m_ = -std::numeric_limits<double>::infinity();  // of what need not be cut further
  Depth found_;
  std::uint64_t looked_at_ = 0;
};

part::Box box_of(const part::TriangleTree::Node& node) {
  return {{node.low[0], node.low[1], node.low[2]}, {node.high[0], node.high[1], node.high[2]}};
}

// Whether two boxes have no place in common.
bool are_apart(const part::Box& a, const part::Box& b) {
  return a.low.x > b.high.x || b.low.x > a.high.x || a.low.y > b.high.y || b.low.y > a.high.y ||
         a.low.z > b.high.z || b.low.z > a.high.z;
}

}  // namespace

Depth deepest(std::span<const SurfaceInSolid> pairs, std::optional<double> allowed_m,
              double within_m, double within_fraction, const DepthProgress& progress,
              const Depth& known) {
  return Search(pairs, allowed_m, within_m, within_fraction, known).run(progress);
}

AwayFromCracks away_from_cracks(const Body& surface, const Body& solid) {
  // Pieces near a crack are cut until they reach no farther, in widths of the crack; and how many.
  constexpr double kReach = 4;
  constexpr std::size_t kMaxPieces = 1 << 14;
  AwayFromCracks away;
  const part::TriangleTree& tree = surface.tree();
  const part::Box solid_box = box_of(solid.tree().nodes()[0]);
  const auto crack_m = [&](const part::Box& box, const Vec3& center, double reach_m) {
    if (are_apart(box, solid_box)) return 0.0;
    return std::max(surface.crack_near_m(center, reach_m), solid.crack_near_m(center, reach_m));
  };
  std::vector<std::uint32_t> nodes{0};
  std::vector<Piece> pieces;
  while (!nodes.empty()) {
    const std::uint32_t number = nodes.back();
    nodes.pop_back();
    const part::TriangleTree::Node& node = tree.nodes()[number];
    const part::Box box = box_of(node);
    if (crack_m(box, 0.5 * (box.low + box.high), part::length(box.high - box.low) / 2) == 0) {
      away.parts.nodes.push_back(number);
      continue;
    }
    for (std::uint32_t n = 0; n < node.count; ++n) {
      pieces.push_back(part::triangle_piece(tree.part(), tree.ordered_triangles()[node.first + n]));
    }
    if (node.count == 0) nodes.push_back(node.first), nodes.push_back(number + 1);
  }
  for (std::size_t cuts = 0; !pieces.empty();) {
    const Piece piece = pieces.back();
    pieces.pop_back();
    part::Box box;
    for (const Vec3& corner : piece) box.grow(corner);
    const Vec3 center = part::centroid(piece);
    const double reach_m = reach_of_m(piece, center), near_m = crack_m(box, center, reach_m);
    if (cuts == kMaxPieces || near_m == 0) {
      away.parts.pieces.push_back(piece);
    } else if (reach_m <= kReach * near_m) {
      away.is_all = false;
    } else {
      ++cuts;
      for (const Piece& half : part::bisected(piece, part::longest_edge(piece).from)) {
        pieces.push_back(half);
      }
    }
  }
  return away;
}

}  // namespace forcelayer::exact
