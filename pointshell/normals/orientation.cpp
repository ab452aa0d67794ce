#include "pointshell/normals/orientation.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <vector>

#include "pointshell/part/mass_properties.h"
#include "pointshell/part/parallel.h"
#include "pointshell/part/pieces.h"
#include "pointshell/part/triangle_tree.h"

namespace forcelayer::normals {
namespace {

constexpr double kDecisive = 0.15;
// A patch with a smaller fraction of leaving rays is hidden; a few rays slip through gaps.
constexpr double kHidden = 0.005;
// The first samples are enough where they leave no doubt, or the second; a negligible patch gets
// fewer. In doubt a patch gets one for each triangle, or for each square of the negligible size
// where those are more. So few triangles are looked at all over, and a soup costs few rays.
constexpr std::size_t kSamplesPerPatch = 128, kFirstSamples = 8, kFirstOfNegligible = 2,
                      kSecondSamples = 16;
constexpr double kNoDoubt = 0.5, kNoDoubtSky = 0.05;
constexpr int kRaysPerSample = 64;
// In negligible sizes. Bodies farther apart than this do not shade each other.
constexpr double kFarGroups = 2;
// In sizes of the part. A hit nearer to a ray's origin is the surface that it starts on.
constexpr double kSelfHit = 1e-10;

// The side of a triangle that runs between two vertices.
struct Side {
  std::uint32_t body, low, high;
  std::uint32_t triangle;
  bool forwards;  // from low to high

  bool same_edge(const Side& other) const {
    return body == other.body && low == other.low && high == other.high;
  }
  friend bool operator<(const Side& a, const Side& b) {
    return std::tie(a.body, a.low, a.high, a.triangle) <
           std::tie(b.body, b.low, b.high, b.triangle);
  }
};

// Two triangles that share an edge of exactly two; `agree` when they run through it in opposite
// directions, as they do on a consistently oriented surface.
struct Link {
  std::uint32_t a, b;
  bool agree;
};

std::vector<Side> sorted_sides(const part::Part& part) {
  std::vector<Side> sides;
  sides.reserve(3 * part.triangles.size());
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
    const mesh::Triangle& corners = part.triangles[t];
    // A triangle with two equal corners runs through its one edge forwards and backwards.
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    for (int n = 0; n < 3; ++n) {
      const std::uint32_t from = corners[n], to = corners[(n + 1) % 3];
      sides.push_back({part.body[t], std::min(from, to), std::max(from, to), t, from < to});
    }
  }
  tbb::parallel_sort(sides.begin(), sides.end());
  return sides;
}

std::vector<Link> find_links(const part::Part& part, OrientationReport& report) {
  const std::vector<Side> sides = sorted_sides(part);
  std::vector<Link> links;
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t end = first + 1;
    while (end < sides.size() && sides[end].same_edge(sides[first])) ++end;
    if (end - first == 1) ++report.boundary_edges;
    if (end - first > 2) ++report.nonmanifold_edges;
    if (end - first == 2) {
      const Side &a = sides[first], &b = sides[first + 1];
      if (a.triangle != b.triangle) {
        links.push_back({a.triangle, b.triangle, a.forwards != b.forwards});
      }
    }
    first = end;
  }
  return links;
}

// Triangles by patch, and whether each is turned round in its patch.
struct Patches {
  std::vector<std::vector<std::uint32_t>> triangles;  // [patch], ascending
  std::vector<bool> turned;                           // [triangle]
};

// Links of each triangle, as one array with offsets.
struct Neighbors {
  std::vector<std::size_t> first;                        // [triangles + 1]
  std::vector<std::pair<std::uint32_t, bool>> to_agree;  // neighbor, agree

  Neighbors(std::size_t triangles, const std::vector<Link>& links)
      : first(triangles + 1, 0), to_agree(2 * links.size()) {
    for (const Link& link : links) ++first[link.a + 1], ++first[link.b + 1];
    for (std::size_t t = 0; t < triangles; ++t) first[t + 1] += first[t];
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (const Link& link : links) {
      to_agree[next[link.a]++] = {link.b, link.agree};
      to_agree[next[link.b]++] = {link.a, link.agree};
    }
  }
};

// The area of each triangle; 0 for a flat one, whose sides are only rounding.
std::vector<double> areas_of(const part::Part& part) {
  std::vector<double> areas(part.triangles.size());
  for (std::size_t t = 0; t < areas.size(); ++t) {
    if (part::is_flat(part::triangle_piece(part, t))) continue;
    areas[t] = part::length(part::doubled_area_normal(part, t)) / 2;
  }
  return areas;
}

double sum_of(const std::vector<double>& areas, const std::vector<std::uint32_t>& triangles) {
  double area = 0;
  for (const std::uint32_t t : triangles) area += areas[t];
  return area;
}

// Turns the smaller area of the patch, so that the larger keeps its orientation.
void keep_larger_area(const std::vector<double>& areas, const std::vector<std::uint32_t>& patch,
                      std::vector<bool>& turned) {
  double kept_area = 0, turned_area = 0;
  for (const std::uint32_t t : patch) (turned[t] ? turned_area : kept_area) += areas[t];
  if (turned_area <= kept_area) return;
  for (const std::uint32_t t : patch) turned[t] = !turned[t];
}

Patches find_patches(const std::vector<double>& areas, const std::vector<Link>& links) {
  const std::size_t count = areas.size();
  const Neighbors neighbors(count, links);
  Patches patches;
  patches.turned.assign(count, false);
  std::vector<bool> reached(count, false);
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (reached[seed]) continue;
    std::vector<std::uint32_t> patch{seed};
    reached[seed] = true;
    for (std::size_t n = 0; n < patch.size(); ++n) {
      const std::uint32_t t = patch[n];
      for (std::size_t l = neighbors.first[t]; l < neighbors.first[t + 1]; ++l) {
        const auto [other, agree] = neighbors.to_agree[l];
        if (reached[other]) continue;
        reached[other] = true;
        patches.turned[other] = patches.turned[t] != !agree;
        patch.push_back(other);
      }
    }
    std::sort(patch.begin(), patch.end());
    keep_larger_area(areas, patch, patches.turned);
    patches.triangles.push_back(std::move(patch));
  }
  return patches;
}

// The diagonal of the box around the patch.
double size_of(const part::Part& part, const std::vector<std::uint32_t>& patch) {
  const part::Box box = part::box_of(part, patch);
  return part::length(box.high - box.low);
}

void turn(part::Part& part, std::uint32_t t) {
  std::swap(part.triangles[t][1], part.triangles[t][2]);
}

// Directions spread evenly over the sphere, none along an axis (Fibonacci lattice).
std::array<part::Vec3, kRaysPerSample> ray_directions() {
  std::array<part::Vec3, kRaysPerSample> directions;
  for (int n = 0; n < kRaysPerSample; ++n) {
    const double z = 1 - (2 * n + 1.0) / kRaysPerSample;
    const double turn = 2 * std::numbers::pi * (n + 0.37) / std::numbers::phi;
    const double ring = std::sqrt(1 - z * z);
    directions[n] = {ring * std::cos(turn), ring * std::sin(turn), z};
  }
  return directions;
}

// Fractions of the rays from each side of a patch that leave the part.
struct Sky {
  double front = 0, back = 0;

  bool hidden() const { return front + back < kHidden; }
  bool leaves_no_doubt() const {
    return front + back >= kNoDoubtSky && std::abs(decisiveness()) >= kNoDoubt;
  }
  double decisiveness() const { return hidden() ? 0 : (front - back) / (front + back); }
};

// Place `number` of a sequence that fills the triangle evenly, the same on either side of it
// (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
part::Vec3 place_on(const part::Part& part, std::uint32_t t, std::size_t number) {
  constexpr double kU = 0.7548776662466927, kV = 0.5698402909980532;
  double whole = 0;
  double u = std::modf(0.5 + kU * static_cast<double>(number + 1), &whole);
  double v = std::modf(0.5 + kV * static_cast<double>(number + 1), &whole);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const auto [low, b, c] = part.triangles[t];
  const part::Vec3 &from = part.vertices[low], &to_u = part.vertices[std::min(b, c)],
                   &to_v = part.vertices[std::max(b, c)];
  return from + u * (to_u - from) + v * (to_v - from);
}

class SkySampler {
 public:
  SkySampler(const part::Part& part, const std::vector<double>& areas, double negligible_size_m)
      : part_(part),
        areas_(areas),
        negligible_size_m_(negligible_size_m),
        directions_(ray_directions()) {
    part::Box box;
    for (const part::Vec3& v : part.vertices) box.grow(v);
    self_hit_ = kSelfHit * part::length(box.high - box.low);
  }

  // The sky of patch `triangles`, which has an area, past the triangles of `tree`.
  Sky look(const part::TriangleTree& tree, const std::vector<std::uint32_t>& triangles) const {
    const std::size_t all = samples_of(triangles);
    const std::size_t few =
        size_of(part_, triangles) <= negligible_size_m_ ? kFirstOfNegligible : kFirstSamples;
    Sky sky;
    for (const std::size_t samples : {few, kSecondSamples, kSamplesPerPatch}) {
      sky = look(tree, triangles, std::min(all, samples));
      if (all <= samples || sky.leaves_no_doubt()) break;
    }
    return sky;
  }

 private:
  std::size_t samples_of(const std::vector<std::uint32_t>& triangles) const {
    constexpr double kAll = kSamplesPerPatch;
    const double square = negligible_size_m_ * negligible_size_m_;
    const double squares = std::ceil(std::min(sum_of(areas_, triangles) / square, kAll));
    return std::clamp(static_cast<std::size_t>(squares),
                      std::min(triangles.size(), kSamplesPerPatch), kSamplesPerPatch);
  }

  // Samples stand for equal areas.
  Sky look(const part::TriangleTree& tree, const std::vector<std::uint32_t>& triangles,
           std::size_t samples) const {
    const double area = sum_of(areas_, triangles);
    Sky sky;
    double area_so_far = 0;
    std::size_t taken = 0;
    for (const std::uint32_t t : triangles) {
      area_so_far += areas_[t];
      // The triangle that the middle of the next equal fraction of the area falls into.
      std::size_t own = 0;
      while (taken < samples && (static_cast<double>(taken) + 0.5) * area <=
                                    area_so_far * static_cast<double>(samples)) {
        ++taken;
        ++own;
      }
      if (own == 1) add_sample(tree, t, part::centroid(part::triangle_piece(part_, t)), sky);
      for (std::size_t n = 0; own > 1 && n < own; ++n) {
        add_sample(tree, t, place_on(part_, t, n), sky);
      }
    }
    const double rays = static_cast<double>(taken) * kRaysPerSample / 2;
    return taken > 0 ? Sky{sky.front / rays, sky.back / rays} : Sky{};
  }

  void add_sample(const part::TriangleTree& tree, std::uint32_t t, const part::Vec3& origin,
                  Sky& sky) const {
    const part::Vec3 normal = part::doubled_area_normal(part_, t);
    for (const part::Vec3& direction : directions_) {
      if (tree.ray_hits(origin, direction, t, self_hit_)) continue;
      (part::dot(direction, normal) > 0 ? sky.front : sky.back) += 1;
    }
  }

  const part::Part& part_;
  const std::vector<double>& areas_;  // of the triangles
  const double negligible_size_m_;
  const std::array<part::Vec3, kRaysPerSample> directions_;
  double self_hit_ = 0;
};

// The patch that each is again, or itself: [patches].
std::vector<std::size_t> original_patches(const Patches& patches,
                                          std::span<const std::uint32_t> originals) {
  std::vector<std::size_t> original(patches.triangles.size());
  std::iota(original.begin(), original.end(), std::size_t{0});
  if (originals.empty()) return original;
  std::vector<std::size_t> patch_of(originals.size());
  for (std::size_t n = 0; n < original.size(); ++n) {
    for (const std::uint32_t t : patches.triangles[n]) patch_of[t] = n;
  }
  for (std::size_t n = 0; n < original.size(); ++n) {
    const std::size_t other = patch_of[originals[patches.triangles[n].front()]];
    if (patches.triangles[n].size() == patches.triangles[other].size()) original[n] = other;
  }
  return original;
}

// Gives the patches of copies the skies of their originals.
void copy_skies(const Patches& patches, std::span<const std::uint32_t> originals,
                std::span<const std::size_t> original, std::vector<Sky>& skies) {
  for (std::size_t n = 0; n < skies.size(); ++n) {
    if (original[n] == n) continue;
    skies[n] = skies[original[n]];
    const std::uint32_t t = patches.triangles[n].front();
    if (patches.turned[t] != patches.turned[originals[t]]) {
      std::swap(skies[n].front, skies[n].back);
    }
  }
}

// The sky of every patch past its group, or past its own body where the group hides it. A patch
// without area has none.
std::vector<Sky> look_around(const part::Part& part, const std::vector<double>& areas,
                             const Patches& patches, double negligible_size_m,
                             std::span<const part::CopiedGroup> copies) {
  const SkySampler sampler(part, areas, negligible_size_m);
  const std::vector<std::uint32_t> originals = part::original_triangles(part, copies);
  const std::vector<std::size_t> original = original_patches(patches, originals);
  const std::vector<std::vector<std::uint32_t>> of_body = part::triangles_by_body(part);
  const auto body_of = [&](std::size_t n) { return part.body[patches.triangles[n].front()]; };
  std::vector<Sky> skies(patches.triangles.size());
  const auto look = [&](const part::TriangleTree& tree, const std::vector<std::size_t>& chosen) {
    part::parallel_for_each_index(chosen.size(), 1, [&](std::size_t n) {
      const std::vector<std::uint32_t>& triangles = patches.triangles[chosen[n]];
      if (sum_of(areas, triangles) > 0) skies[chosen[n]] = sampler.look(tree, triangles);
    });
  };

  const auto groups = part::separate_groups(part, kFarGroups * negligible_size_m);
  std::vector<std::size_t> group_of(of_body.size());
  for (std::size_t group = 0; group < groups.size(); ++group) {
    for (const std::uint32_t body : groups[group]) group_of[body] = group;
  }
  std::vector<std::vector<std::size_t>> chosen(groups.size());  // patches, by group
  for (std::size_t n = 0; n < skies.size(); ++n) {
    if (original[n] == n) chosen[group_of[body_of(n)]].push_back(n);
  }
  for (std::size_t group = 0; group < groups.size(); ++group) {
    if (chosen[group].empty()) continue;
    std::vector<std::uint32_t> triangles;
    for (const std::uint32_t body : groups[group]) {
      triangles.insert(triangles.end(), of_body[body].begin(), of_body[body].end());
    }
    look(part::TriangleTree(part, std::move(triangles)), chosen[group]);
  }
  if (of_body.size() < 2) return skies;

  std::vector<std::vector<std::size_t>> hidden_of_body(of_body.size());
  for (std::size_t n = 0; n < skies.size(); ++n) {
    if (original[n] == n && skies[n].hidden()) hidden_of_body[body_of(n)].push_back(n);
  }
  for (std::size_t body = 0; body < of_body.size(); ++body) {
    if (hidden_of_body[body].empty()) continue;
    look(part::TriangleTree(part, of_body[body]), hidden_of_body[body]);
  }
  copy_skies(patches, originals, original, skies);
  return skies;
}

// Turns the patches that see more sky from behind, and hidden patches with their body. A patch
// without area stays.
void turn_patches(part::Part& part, const std::vector<double>& areas, const Patches& patches,
                  const std::vector<Sky>& skies) {
  std::vector<double> area_to_keep(part.body_names.size());  // less that to turn, by body
  const auto turn_patch = [&](std::size_t n) {
    for (const std::uint32_t t : patches.triangles[n]) turn(part, t);
  };
  for (std::size_t n = 0; n < skies.size(); ++n) {
    if (std::abs(skies[n].decisiveness()) < kDecisive) continue;
    const double area = sum_of(areas, patches.triangles[n]);
    const bool keep = skies[n].decisiveness() > 0;
    area_to_keep[part.body[patches.triangles[n].front()]] += keep ? area : -area;
    if (!keep) turn_patch(n);
  }
  for (std::size_t n = 0; n < skies.size(); ++n) {
    if (skies[n].hidden() && sum_of(areas, patches.triangles[n]) > 0 &&
        area_to_keep[part.body[patches.triangles[n].front()]] < 0) {
      turn_patch(n);
    }
  }
}

bool is_closed(const part::Part& part, const std::vector<std::uint32_t>& patch) {
  std::vector<mesh::Triangle> triangles;
  for (const std::uint32_t t : patch) triangles.push_back(part.triangles[t]);
  return part::is_closed(triangles);
}

// Judges patch `patch` by its sky.
void classify(const part::Part& part, const std::vector<double>& areas,
              const std::vector<std::uint32_t>& patch, const Sky& sky, double negligible_size_m,
              OrientationReport& report) {
  const auto mark = [&](std::vector<bool>& triangles) {
    for (const std::uint32_t t : patch) triangles[t] = true;
  };
  const part::Box box = part::box_of(part, patch);
  const double size_m = part::length(box.high - box.low);
  const bool negligible = size_m <= negligible_size_m;
  if (sky.hidden()) report.hidden_triangles += patch.size();
  if ((sky.hidden() || negligible) && !is_closed(part, patch)) mark(report.loose);
  if (sky.hidden() || std::abs(sky.decisiveness()) >= kDecisive) return;
  if (negligible) {
    report.undecided_triangles += patch.size();
    return;
  }
  mark(report.of_sheet);
  report.sheets.push_back({part.body_names[part.body[patch.front()]], patch.size(),
                           sum_of(areas, patch), 0.5 * (box.low + box.high), size_m});
}

}  // namespace

OrientationReport orient_outwards(part::Part& part, double negligible_size_m,
                                  std::span<const part::CopiedGroup> copies) {
  OrientationReport report;
  const std::vector<mesh::Triangle> given = part.triangles;
  const std::vector<double> areas = areas_of(part);
  const Patches patches = find_patches(areas, find_links(part, report));
  report.patches = patches.triangles.size();
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
    if (patches.turned[t]) turn(part, t);
  }
  const std::vector<Sky> skies = look_around(part, areas, patches, negligible_size_m, copies);
  report.of_sheet.assign(given.size(), false);
  report.loose.assign(given.size(), false);
  for (std::size_t n = 0; n < skies.size(); ++n) {
    const std::vector<std::uint32_t>& patch = patches.triangles[n];
    if (sum_of(areas, patch) == 0) continue;
    classify(part, areas, patch, skies[n], negligible_size_m, report);
  }
  std::stable_sort(report.sheets.begin(), report.sheets.end(),
                   [](const Sheet& a, const Sheet& b) { return a.area_m2 > b.area_m2; });
  turn_patches(part, areas, patches, skies);
  for (std::size_t t = 0; t < given.size(); ++t) {
    report.flipped_triangles += areas[t] > 0 && given[t] != part.triangles[t];
  }
  return report;
}

}  // namespace forcelayer::normals
