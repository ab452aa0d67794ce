#include "workbench/pairs/pair_check.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "formats/command/text.h"
#include "formats/command/verdict/verdict.h"
#include "workbench/exact/depth.h"
#include "workbench/exact/watch.h"
#include "workbench/pairs/inside_places.h"
#include "workbench/pairs/near_boxes.h"

namespace forcelayer::pairs {
namespace {

using exact::Body;
using part::Vec3;

const Pose kWorld{glm::dvec3(0), {1, 0, 0, 0}};

// How closely a depth is found that is more than allowed, m and as a fraction of it.
constexpr double kDepthM = 1e-6, kDepthFraction = 1.0 / 256;
// How closely the bound of a contact is proven, as a fraction of it: at first, and for a depth that
// is near the bound.
constexpr double kWithin = 1.0 / 8, kClosely = 1.0 / 256;
// How often a search for a depth is asked whether it goes on, at some microseconds each: so the
// answer is the same on each machine. Two flat faces of 100,000 triangles take a tenth of it.
constexpr std::uint64_t kMaxAsked = 1 << 15;

std::array<double, 3> array_of(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

// The triangles that hang together, in the order of their lowest corners.
std::vector<Shape::Piece> pieces_of(const part::Part& part) {
  std::vector<std::uint32_t> parent(part.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root_of = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const mesh::Triangle& t : part.triangles) {
    for (const std::uint32_t corner : t) {
      const std::uint32_t a = root_of(t[0]), b = root_of(corner);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::map<std::uint32_t, Shape::Piece> pieces;
  for (const mesh::Triangle& t : part.triangles) {
    for (const std::uint32_t corner : t) {
      const Vec3& v = part.vertices[corner];
      const auto [at, is_new] = pieces.try_emplace(root_of(corner));
      if (is_new) at->second = {v, mesh::empty_box()};
      mesh::extend(at->second.box_m, mesh::Vec3d{v.x, v.y, v.z});
    }
  }
  std::vector<Shape::Piece> all;
  for (const auto& [root, piece] : pieces) all.push_back(piece);
  return all;
}

std::string open_text(const NamedShape& named) {
  const std::string name = named.name();
  if (named.shape.body() == nullptr) return name + " has no triangle with an area";
  const Body::OpenEdges open = named.shape.body()->open_edges();
  return "the mesh of " + name + " is open (" + command::length_text(open.length_m) +
         " of open edges)";
}

class PairSearch {
 public:
  PairSearch(const NamedShape& first, const NamedShape& second, double margin_m)
      : first_(first), second_(second), margin_m_(margin_m) {}

  std::optional<PairMeasure> run(double beyond_m) {
    // The tree of the part with fewer triangles is placed anew for each search.
    const bool swapped = first_.shape.triangles() > second_.shape.triangles();
    const Shape &few = swapped ? second_.shape : first_.shape,
                &many = swapped ? first_.shape : second_.shape;
    const exact::MeshPair pair(many.mesh(), few.mesh());
    const auto nearest = pair.nearer_than(kWorld, beyond_m);
    if (nearest) {
      found_.distance_m = nearest->distance_m;
      found_.at_m = array_of(0.5 * (nearest->part_m + nearest->scene_m));
      if (nearest->distance_m <= margin_m_) found_.contact = Contact::kTouch;
    }
    if (nearest && nearest->distance_m == 0) {
      look_into_contact();
      return found_;
    }
    const bool is_told = look_inside_both();
    if (!nearest && !is_told) return std::nullopt;
    if (!nearest) {
      found_.distance_m = pair.at(kWorld, std::numeric_limits<double>::infinity()).distance_m;
    }
    return found_;
  }

 private:
  // The surfaces do not meet. Whether one part lies in the other one, or may.
  bool look_inside_both() {
    bool is_told = look_inside(first_, second_, true);
    if (found_.contact == Contact::kOverlap) return true;
    const PairMeasure other_way = found_;
    const bool is_second_told = look_inside(second_, first_, false);
    if (found_.contact == Contact::kOverlap) return true;
    if (is_told && other_way.contact == Contact::kUndecided) found_ = other_way;
    is_told = is_told || is_second_told;
    if (found_.contact == Contact::kTouch) find_common_ball();
    return is_told;
  }

  // One place of a piece tells whether it lies inside a solid. Many are asked where the other part
  // is open or has cracks: a piece may reach in through these.
  bool look_inside(const NamedShape& inner, const NamedShape& outer, bool is_first) {
    if (distance_of(outer.shape.box_m(), inner.shape.box_m()) > 0) return false;
    if (outer.shape.body() == nullptr || inner.shape.body() == nullptr) return false;
    if (!outer.shape.is_solid()) return look_inside_open(inner, outer, is_first);
    const auto place = place_in_solid(inner.shape, outer.shape);
    if (!place) return false;
    const Deep deep = deepest_of({&inner.shape, &outer.shape}, *place, is_first);
    const double crack_m = outer.shape.body()->crack_near_m(exact::vec3_of(deep.depth.place_m),
                                                            std::max(0.0, deep.depth.found_m));
    take_depth(deep, margin_m_ + crack_m);
    found_.crack_m = crack_m;
    return true;
  }

  std::optional<Vec3> place_in_solid(const Shape& inner, const Shape& outer) const {
    for (const Shape::Piece& piece : inner.pieces()) {
      if (!contains(outer.box_m(), piece.box_m)) continue;
      if (outer.body()->holds(piece.place_m)) return piece.place_m;
    }
    return outer.body()->crack_m() > 0 ? place_inside(inner, outer, margin_m_) : std::nullopt;
  }

  bool look_inside_open(const NamedShape& inner, const NamedShape& outer, bool is_first) {
    const auto place = place_inside(inner.shape, outer.shape, margin_m_);
    if (place) set_undecided(outer, *place, is_first);
    return place.has_value();
  }

  void set_undecided(const NamedShape& open, const Vec3& place, bool is_first) {
    found_.contact = Contact::kUndecided;
    found_.doubt = "it may be inside: " + open_text(open);
    found_.is_first_deep = is_first;
    found_.at_m = {place.x, place.y, place.z};
  }

  void look_into_contact() {
    const bool first_solid = first_.shape.is_solid(), second_solid = second_.shape.is_solid();
    if (!first_solid && !second_solid) {
      found_.contact = Contact::kUndecided;
      found_.doubt = "the surfaces meet: " + open_text(first_) + ", and " + open_text(second_);
      return;
    }
    if (first_.shape.body() == nullptr || second_.shape.body() == nullptr) return;  // lines touch
    find_depth(first_solid, second_solid);
    // The surface of the solid may be inside the open mesh where no depth is known.
    if (found_.contact == Contact::kTouch && !second_solid) look_inside_open(first_, second_, true);
    if (found_.contact == Contact::kTouch && !first_solid) look_inside_open(second_, first_, false);
    if (found_.contact == Contact::kTouch) find_common_ball();
  }

  struct SurfacePairs {
    std::vector<exact::SurfaceInSolid> pairs;
    std::vector<bool> is_first;  // the surface is that of the first part
  };

  // Whether a place of either surface is deeper in the other part than is allowed, and then how
  // deep. Cracks explain a depth only of places near them.
  void find_depth(bool first_solid, bool second_solid) {
    const exact::Parts whole = exact::whole_surface();
    SurfacePairs all, away;
    std::vector<exact::AwayFromCracks> parts;
    parts.reserve(2);
    double cracks_m = 0;
    const auto add = [&](const Shape& surface, const Shape& solid, bool is_first) {
      all.pairs.push_back({surface.body(), solid.body(), kWorld, kWorld, &whole});
      all.is_first.push_back(is_first);
      cracks_m = std::max({cracks_m, surface.body()->crack_m(), solid.body()->crack_m()});
      parts.push_back(exact::away_from_cracks(*surface.body(), *solid.body()));
      away.pairs.push_back({surface.body(), solid.body(), kWorld, kWorld, &parts.back().parts});
      away.is_first.push_back(is_first);
    };
    if (second_solid) add(first_.shape, second_.shape, true);
    if (first_solid) add(second_.shape, first_.shape, false);
    const bool near_cracks =
        std::any_of(parts.begin(), parts.end(), [](const auto& part) { return !part.is_all; });
    bound_depth(away, margin_m_);
    if (near_cracks && found_.contact == Contact::kTouch) {
      found_.crack_m = cracks_m;
      bound_depth(all, margin_m_ + cracks_m);
    }
    if (found_.contact == Contact::kOverlap && !(first_solid && second_solid)) {
      found_.is_at_least = true;  // of a surface in the solid: the other way round none is known
    }
  }

  void bound_depth(const SurfacePairs& surfaces, double most_m) {
    const auto& [pairs, is_first] = surfaces;
    exact::Depth met;  // where surfaces meet, that is a place of both, and no depth
    met.found_m = met.at_most_m = 0;
    met.place_m = met.foot_m = {found_.at_m[0], found_.at_m[1], found_.at_m[2]};
    auto bounded = search(pairs, most_m, kWithin * most_m, 0, met);
    if (bounded && bounded->found_m <= most_m && bounded->at_most_m > most_m) {
      const double within_m = std::max((most_m - bounded->found_m) / 2, kClosely * most_m);
      bounded = search(pairs, most_m, within_m, 0, *bounded);
    }
    if (!bounded) {
      found_.contact = Contact::kClose;
      found_.doubt = "the search for the depth of the contact was too long";
      return;
    }
    if (bounded->found_m > most_m) {
      const auto deep = search(pairs, std::nullopt, kDepthM, kDepthFraction, *bounded);
      found_.is_at_least = !deep;
      take_depth({deep ? *deep : *bounded, is_first[(deep ? *deep : *bounded).pair]}, most_m);
    } else if (bounded->at_most_m > most_m) {
      found_.contact = Contact::kClose;
    }
  }

  // None where the search takes too long.
  static std::optional<exact::Depth> search(std::span<const exact::SurfaceInSolid> pairs,
                                            std::optional<double> allowed_m, double within_m,
                                            double within_fraction, const exact::Depth& known) {
    std::uint64_t asked = 0;
    const exact::Watch watch([&] { return ++asked < kMaxAsked; });
    try {
      return exact::deepest(pairs, allowed_m, within_m, within_fraction, {}, known);
    } catch (const exact::Stopped&) {
      return std::nullopt;
    }
  }

  struct Deep {
    exact::Depth depth;
    bool is_first = true;
  };

  // The depth of a part that lies inside another one.
  Deep deepest_of(const std::pair<const Shape*, const Shape*>& inner_outer, const Vec3& place_m,
                  bool is_first) {
    const auto [inner, outer] = inner_outer;
    const exact::Parts whole = exact::whole_surface();
    const exact::SurfaceInSolid pairs[] = {{inner->body(), outer->body(), kWorld, kWorld, &whole}};
    exact::Depth known;
    known.place_m = exact::dvec3_of(place_m);
    const auto nearest = outer->body()->tree().nearest(place_m);
    known.found_m = known.at_most_m = std::sqrt(nearest.distance_squared);
    known.foot_m = exact::dvec3_of(nearest.point.position);
    const auto deep = search(pairs, std::nullopt, kDepthM, kDepthFraction, known);
    found_.is_at_least = !deep;
    return {deep ? *deep : known, is_first};
  }

  void take_depth(const Deep& deep, double allowed_m) {
    found_.doubt.clear();
    found_.depth_m = deep.depth.found_m;
    found_.at_m = array_of(deep.depth.place_m);
    found_.is_first_deep = deep.is_first;
    found_.contact = deep.depth.found_m > allowed_m ? Contact::kOverlap : Contact::kTouch;
  }

  // Parts of which the surfaces coincide have no place of a surface that is deep.
  void find_common_ball() {
    if (first_.shape.body() == nullptr || second_.shape.body() == nullptr) return;
    Ball ball = ball_in_both(first_.shape, second_.shape, margin_m_);
    const Ball other =
        ball_in_both(second_.shape, first_.shape, std::max(margin_m_, ball.radius_m));
    if (other.radius_m > ball.radius_m) ball = other;
    if (ball.radius_m <= margin_m_) return;
    if (!first_.shape.is_solid() || !second_.shape.is_solid()) {
      const bool is_first = !second_.shape.is_solid();
      set_undecided(is_first ? second_ : first_, ball.center, is_first);
      return;
    }
    found_.contact = Contact::kOverlap;
    found_.depth_m = ball.radius_m;
    found_.is_at_least = true;
    found_.at_m = {ball.center.x, ball.center.y, ball.center.z};
  }

  const NamedShape &first_, &second_;
  double margin_m_;
  PairMeasure found_;
};

}  // namespace

Shape::Shape(exact::Surface surface, const mesh::Box& box_m)
    : box_m_(box_m),
      triangles_(surface.triangles.size()),
      mesh_(exact::MeshPair::mesh_of(surface)),
      surface_(std::move(surface)) {}

const exact::Body* Shape::body() const {
  std::call_once(once_, [this] {
    bodies_ = exact::bodies_of(surface_, exact::widest_crack_m(surface_));
    surface_ = {};
    if (!bodies_.empty()) pieces_ = pieces_of(bodies_.front()->tree().part());
  });
  return bodies_.empty() ? nullptr : bodies_.front().get();
}

std::optional<PairMeasure> measure_pair(const NamedShape& first, const NamedShape& second,
                                        double beyond_m, double margin_m) {
  return PairSearch(first, second, margin_m).run(beyond_m);
}

}  // namespace forcelayer::pairs
