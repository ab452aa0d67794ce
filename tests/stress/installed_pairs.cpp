#include "tests/stress/installed_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"
#include "tests/stress/shapes.h"

namespace forcelayer::stress {
namespace {

constexpr double kMm = 1e-3;
constexpr int kSegments = 48;  // flat to 0.2% of a radius

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  glm::dvec3 vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  glm::dquat turn(double max_rad) {
    return coupling::rotation_by(glm::normalize(vector(1)) * uniform(0, max_rad));
  }

 private:
  std::mt19937_64 engine_;
};

Pose at(double x, double y, double z) { return {{x, y, z}, {1, 0, 0, 0}}; }

using Depth = std::function<double(const glm::dvec3&)>;

Depth in_box(const glm::dvec3& middle, const glm::dvec3& half) {
  return [=](const glm::dvec3& p) {
    const glm::dvec3 in = half - glm::abs(p - middle);
    return std::min({in.x, in.y, in.z});
  };
}

// A cylinder of `outer` about z between two heights, with a bore of `bore`; below 0: none.
Depth in_tube(double bore, double outer, double low, double high) {
  return [=](const glm::dvec3& p) {
    const double r = std::hypot(p.x, p.y);
    const double in_bore = bore < 0 ? outer : r - bore;
    return std::min({in_bore, outer - r, p.z - low, high - p.z});
  };
}

Depth in_either(Depth a, Depth b) {
  return [a = std::move(a), b = std::move(b)](const glm::dvec3& p) { return std::max(a(p), b(p)); };
}

constexpr double kNoBore = -1;

InstalledPair block_on_slab(double unit, double gap, Random& random) {
  const glm::dvec3 half{random.uniform(10, 25) * unit, random.uniform(10, 25) * unit,
                        random.uniform(1, 15) * unit};
  InstalledPair pair;
  pair.kind = "block on slab";
  pair.part = box(half);
  pair.pair_from_part = at(0, 0, half.z + gap);
  pair.removal_m = 40 * unit;
  const glm::dvec3 slab{60 * unit, 60 * unit, 12 * unit};
  append(pair.scene, box(slab), at(0, 0, -slab.z));
  pair.depth_in_scene_m = in_box({0, 0, -slab.z}, slab);
  pair.depth_in_part_m = in_box({0, 0, 0}, half);
  return pair;
}

InstalledPair bracket_on_sheet(double unit, double gap, Random& random) {
  const double a = random.uniform(20, 40) * unit, t = random.uniform(3, 8) * unit;
  InstalledPair pair;
  pair.kind = "bracket on sheet";
  pair.scene = sheet(60 * unit, 60 * unit);
  pair.part = prism({{0, 0}, {a, 0}, {a, t}, {t, t}, {t, a}, {0, a}}, 15 * unit);
  pair.pair_from_part = at(-a / 2, 0, gap);
  pair.removal_m = 40 * unit;
  pair.depth_in_scene_m = [unit](const glm::dvec3& p) {
    return std::max(std::abs(p.x), std::abs(p.y)) < 60 * unit ? -p.z : -1;
  };
  pair.depth_in_part_m = in_either(in_box({a / 2, 0, t / 2}, {a / 2, 15 * unit, t / 2}),
                                   in_box({t / 2, 0, a / 2}, {t / 2, 15 * unit, a / 2}));
  return pair;
}

InstalledPair pin_in_blind_hole(double unit, double gap, Random& random) {
  const double bore = random.uniform(6, 15) * unit, deep = random.uniform(10, 30) * unit;
  const double outer = 40 * unit, low = -deep - 15 * unit;
  InstalledPair pair;
  pair.kind = "pin in blind hole";
  pair.scene = revolved({{0, low}, {outer, low}, {outer, 0}, {bore, 0}, {bore, -deep}, {0, -deep}},
                        kSegments);
  pair.part = cylinder(bore - gap, deep, kSegments);
  pair.pair_from_part = at(0, 0, gap);
  pair.removal_m = deep + 25 * unit;
  pair.depth_in_scene_m = [=](const glm::dvec3& p) {
    const double r = std::hypot(p.x, p.y);
    const double to_hole = std::hypot(std::max(r - bore, 0.0), std::max(-deep - p.z, 0.0));
    return std::min({outer - r, p.z - low, -p.z, r < bore && p.z > -deep ? -1.0 : to_hole});
  };
  pair.depth_in_part_m = in_tube(kNoBore, bore - gap, -deep, deep);
  return pair;
}

InstalledPair pin_in_through_hole(double unit, double gap, Random& random) {
  const double bore = random.uniform(5, 15) * unit, half = random.uniform(5, 15) * unit;
  InstalledPair pair;
  pair.kind = "pin in through hole";
  pair.scene = tube(bore, 40 * unit, half, kSegments);
  pair.part = cylinder(bore - gap, half + 10 * unit, kSegments);
  pair.removal_m = 2 * half + 40 * unit;
  pair.depth_in_scene_m = in_tube(bore, 40 * unit, -half, half);
  pair.depth_in_part_m = in_tube(kNoBore, bore - gap, -half - 10 * unit, half + 10 * unit);
  return pair;
}

InstalledPair ring_on_shaft(double unit, double gap, Random& random) {
  const double shaft = random.uniform(5, 15) * unit, half = 25 * unit;
  const double height = random.uniform(3, 8) * unit;
  InstalledPair pair;
  pair.kind = "ring on shaft";
  pair.scene = cylinder(shaft, half, kSegments);
  pair.part = tube(shaft + gap, shaft + gap + 8 * unit, height, kSegments);
  pair.pair_from_part = at(0, 0, random.uniform(-10, 10) * unit);
  pair.removal_m = half + 45 * unit;
  pair.depth_in_scene_m = in_tube(kNoBore, shaft, -half, half);
  pair.depth_in_part_m = in_tube(shaft + gap, shaft + gap + 8 * unit, -height, height);
  return pair;
}

InstalledPair cover_on_box(double unit, double gap, Random& random) {
  const double post = random.uniform(12, 25) * unit, rim = random.uniform(8, 20) * unit;
  const double wall = random.uniform(2, 6) * unit, inner = post + gap;
  InstalledPair pair;
  pair.kind = "cover on box";
  pair.part = revolved(
      {{inner, -rim}, {inner + wall, -rim}, {inner + wall, wall}, {0, wall}, {0, 0}, {inner, 0}},
      kSegments);
  pair.pair_from_part = at(0, 0, gap);
  pair.removal_m = rim + 30 * unit;
  append(pair.scene, cylinder(post, 20 * unit, kSegments), at(0, 0, -20 * unit));
  pair.depth_in_scene_m = in_tube(kNoBore, post, -40 * unit, 0);
  pair.depth_in_part_m =
      in_either(in_tube(inner, inner + wall, -rim, wall), in_tube(kNoBore, inner + wall, 0, wall));
  return pair;
}

InstalledPair bolt_through_plates(double unit, double gap, Random& random) {
  const double bore = random.uniform(5, 10) * unit, shank = bore - gap, head = bore + 6 * unit;
  InstalledPair pair;
  pair.kind = "bolt through plates";
  pair.part = revolved({{0, -36 * unit},
                        {shank, -36 * unit},
                        {shank, 0},
                        {head, 0},
                        {head, 8 * unit},
                        {0, 8 * unit}},
                       kSegments);
  pair.pair_from_part = at(0, 0, gap);
  pair.removal_m = 70 * unit;
  append(pair.scene, tube(bore, 35 * unit, 6 * unit, kSegments), at(0, 0, -6 * unit));
  append(pair.scene, tube(bore, 35 * unit, 6 * unit, kSegments), at(0, 0, -24 * unit));
  pair.depth_in_scene_m = in_either(in_tube(bore, 35 * unit, -12 * unit, 0),
                                    in_tube(bore, 35 * unit, -30 * unit, -18 * unit));
  pair.depth_in_part_m =
      in_either(in_tube(kNoBore, shank, -36 * unit, 8 * unit), in_tube(kNoBore, head, 0, 8 * unit));
  return pair;
}

constexpr std::array<InstalledPair (*)(double, double, Random&), kInstalledKinds> kMakers = {
    block_on_slab, bracket_on_sheet, pin_in_blind_hole,  pin_in_through_hole,
    ring_on_shaft, cover_on_box,     bolt_through_plates};

}  // namespace

InstalledPair installed_pair(std::uint64_t seed) {
  Random random(seed + 1);
  const double voxel_size_m = random.uniform(1, 5) * kMm;
  const double gap_m = random.uniform(0, 1) * kMm;
  InstalledPair pair =
      kMakers[static_cast<std::size_t>(seed) % kMakers.size()](0.5 * voxel_size_m, gap_m, random);
  pair.gap_m = gap_m;
  pair.voxel_size_m = voxel_size_m;
  const glm::dvec3 position_m = random.vector(0.1);
  pair.world_from_pair = {position_m, random.turn(3)};
  return pair;
}

}  // namespace forcelayer::stress
