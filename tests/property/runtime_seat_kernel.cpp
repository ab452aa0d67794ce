// The seat's look-ups by vectors: bit for bit those of one point after the other, at any width.
#include "runtime/guard/seat_kernel.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <random>

#include "runtime/coupling/coupling.h"
#include "runtime/field/distance_field.h"
#include "tests/support/distance_scene.h"
#include "tests/support/every_target.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shape_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;
constexpr glm::dvec3 kHalf{0.021, 0.017, 0.013};

// A pocket, open above, in which a block stands with its edges in the corners; four objects.
Voxmap pocket(bool names_objects) {
  const VoxelScene scene = distance_scene(
      kS, {-14, -14, -12}, {28, 28, 24},
      [](const glm::dvec3& p) {
        const double beside_m =
            std::min(kHalf.x + 0.0004 - std::abs(p.x), kHalf.y + 0.0003 - std::abs(p.y));
        return std::min(p.z + kHalf.z, std::max(beside_m, p.z - 0.003));
      },
      2, DistanceDefinition(2));
  if (!names_objects) return make_voxmap(scene);
  return make_voxmap_of_objects(scene, {"a", "b", "c", "d"}, [](const Voxel& v) {
    return 1 + static_cast<std::uint32_t>(v[0] + v[1] > 1) +
           2 * static_cast<std::uint32_t>(v[2] + v[1] % 3 > 0);
  });
}

// A look-up, with all that a seat remembers of the points.
struct Look {
  Look(const Voxmap& map, const Pshell& shell, std::mt19937_64& random)
      : query(map, shell), field(map), probe(query, field, points, samples), objects(probe) {
    const std::size_t count = shell.view().point_count;
    points.reserve(count), samples.reserve(count);
    objects.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      in_seat_m.push_back(static_cast<float>(uniform(random, -0.3, 0.1) * kS));
      const bool in_corner = random() % 4 == 0;
      in_seat_steepness.push_back(in_corner ? static_cast<float>(uniform(random, 0.2, 0.95)) : 1);
    }
    for (const std::uint32_t number : {0u, 1u, 2u, 4u}) {
      guard::SeatObject& object = seat.at(number);
      object.contact_m = static_cast<float>(uniform(random, -0.2, 0.15) * kS);
      object.floor_m = object.contact_m - static_cast<float>(0.3 * kS);
      object.corner_floor_m = object.floor_m - static_cast<float>(uniform(random, 0, 0.3) * kS);
    }
  }

  // Looks at a pose; fills a set as the guard does before the rule of the seat.
  void at(const Pose& pose, field::ContactSet& out, std::mt19937_64& random) {
    probe.query_pose(pose);
    probe.copy_contacts(out);
    out.barred = out.seated = 0;
    out.seat_open = true;
    for (std::uint32_t i = 0; i < out.count; ++i) {
      out.is_barred[i] = random() % 5 == 0;
      out.barred += out.is_barred[i];
    }
  }

  query::ContactQuery query;
  field::DistanceField field;
  query::CollectedPoints points;
  field::FieldSamples samples;
  field::FieldProbe probe;
  guard::NearestObjects objects;
  guard::Seat seat;
  std::vector<float> in_seat_m, in_seat_steepness;
};

// The rule of the seat for one point after the other.
void press_plainly(const Look& look, const guard::SeatPress& press, field::ContactSet& out) {
  const field::FieldProbe& probe = look.probe;
  for (std::uint32_t i = 0; i < out.count; ++i) {
    const guard::SeatObject* const object = look.seat.find(probe.object_of(i));
    out.of_seat[i] = object != nullptr;
    if (object == nullptr) continue;
    const glm::vec3 g = probe.slope(i), n = probe.normal(i), e = probe.gradient(i);
    const float steepness = glm::length(g), distance_m = probe.stored_distance_m(i);
    const float there =
        press.in_seat_steepness == nullptr ? 1 : press.in_seat_steepness[probe.point(i)];
    const bool in_corner = press.in_corners && there < 1 && distance_m < press.corner_m &&
                           steepness <= guard::kFaceSlope;
    const bool barred = distance_m < (in_corner ? object->corner_floor_m : object->floor_m);
    if (out.is_barred[i] != 0 || out.depth_m[i] > 0) ++out.seated;
    const bool interior = press.by_value ? field::is_interior(out.value[i]) : out.is_barred[i] != 0;
    if (interior && !barred) --out.interior, ++out.surface;
    if (out.is_barred[i] != 0) --out.barred;
    if (barred) ++out.barred;
    out.is_barred[i] = barred;
    const glm::vec3 direction = steepness < field::kMinSlope ? n : g / steepness;
    const float fall = glm::length(e);
    const glm::vec3 push = glm::dot(e, direction) > 0.7f * fall ? e / fall : direction;
    out.ux[i] = push.x, out.uy[i] = push.y, out.uz[i] = push.z;
    float contact_m = object->contact_m;
    if (there < 1) {
      const float fraction = press.in_corners ? (1 - steepness) / (1 - there) : 0;
      contact_m = std::lerp(contact_m, std::min(contact_m, press.in_seat_m[probe.point(i)]),
                            std::clamp(fraction, 0.0f, 1.0f));
    }
    out.depth_m[i] = contact_m - distance_m;
    if (direction == glm::vec3(0)) out.depth_m[i] = std::min(out.depth_m[i], 0.0f);
    const float sure = n == glm::vec3(0) ? field::kSideSlope : guard::kSureSlope;
    const glm::vec3 side = steepness < sure ? n : direction;
    out.sx[i] = side.x, out.sy[i] = side.y, out.sz[i] = side.z;
    out.gx[i] = g.x, out.gy[i] = g.y, out.gz[i] = g.z;
    out.from_surface_m[i] = distance_m;
  }
}

void expect_same(const field::ContactSet& one, const field::ContactSet& other) {
  ASSERT_EQ(one.count, other.count);
  EXPECT_EQ(one.interior, other.interior);
  EXPECT_EQ(one.surface, other.surface);
  EXPECT_EQ(one.barred, other.barred);
  EXPECT_EQ(one.seated, other.seated);
  const auto same = [&](const auto& a, const auto& b) {
    return std::memcmp(a.data(), b.data(), one.count * sizeof a[0]) == 0;
  };
  EXPECT_TRUE(same(one.of_seat, other.of_seat));
  EXPECT_TRUE(same(one.is_barred, other.is_barred));
  EXPECT_TRUE(same(one.depth_m, other.depth_m));
  EXPECT_TRUE(same(one.ux, other.ux) && same(one.uy, other.uy) && same(one.uz, other.uz));
  for (std::uint32_t i = 0; i < one.count; ++i) {
    if (one.of_seat[i] == 0) continue;
    const auto of = [i](const field::ContactSet& set) {
      return std::array{
          set.sx[i], set.sy[i], set.sz[i], set.gx[i], set.gy[i], set.gz[i], set.from_surface_m[i]};
    };
    const auto a = of(one), b = of(other);
    EXPECT_EQ(0, std::memcmp(&a, &b, sizeof a)) << i;
  }
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> turned_plainly(
    const field::FieldProbe& probe, const field::ContactSet& earlier,
    const field::ContactSet& later, float sheet_m, float clear_slope, bool all_near) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t i = 0; i < later.count; ++i) {
    for (std::uint32_t at = 0; at < earlier.count; ++at) {
      if (earlier.point[at] != later.point[i]) continue;
      if (later.of_seat[i] == 0 || earlier.of_seat[at] == 0) continue;
      if (!(probe.stored_distance_m(i) < sheet_m)) continue;
      const glm::vec3 side(earlier.sx[at], earlier.sy[at], earlier.sz[at]);
      if (all_near || glm::dot(probe.slope(i), side) < 0 ||
          glm::dot(probe.slope(i), probe.normal(i)) < clear_slope) {
        pairs.emplace_back(at, i);
      }
    }
  }
  return pairs;
}

void expect_tilted(const field::FieldProbe& probe, const guard::TiltedSearch& s) {
  std::vector<std::uint32_t> steep, gentle;
  for (std::uint32_t i = 0; i < probe.count(); ++i) {
    const float distance_m = probe.stored_distance_m(i);
    if (!(distance_m < s.near_m)) continue;
    const glm::vec3 g = probe.slope(i);
    const float squared = glm::dot(g, g), out = glm::dot(g, probe.normal(i));
    const float tilt = squared - out * out;
    if (!(tilt > s.gentle2)) continue;
    const bool is_gentle = !(tilt > s.flat2);
    if (is_gentle && !(distance_m < s.gentle_m)) continue;
    const float above_m = distance_m - s.highest_m;
    if (above_m > 0 && above_m * above_m > s.reach2_m2 * squared) continue;
    (is_gentle ? gentle : steep).push_back(i);
  }
  std::vector<std::uint32_t> found_steep(probe.count()), found_gentle(probe.count());
  const guard::TiltedPoints found =
      guard::find_tilted(probe, s, found_steep.data(), found_gentle.data());
  found_steep.resize(found.steep), found_gentle.resize(found.gentle);
  EXPECT_EQ(found_steep, steep);
  EXPECT_EQ(found_gentle, gentle);
}

using SeatKernel = EveryTarget;

// How often each of the searches found something: a test of nothing shows nothing.
struct Found {
  std::size_t pressed = 0, freed = 0, turned = 0, undirected = 0, in_corners = 0, far = 0;
};

void try_poses(std::uint64_t seed, Found& found) {
  std::mt19937_64 random(seed);
  const Voxmap map = pocket(seed % 4 != 0);
  PointPart part = box_part(kHalf, 0.5 * kS, kS);
  part.two_sided = seed % 5 == 0;
  const Pshell shell = make_pshell(part);
  Look look(map, shell, random);
  const guard::SeatTables tables(look.seat);
  const auto s = static_cast<float>(kS);
  const bool has_corners = seed % 3 != 0;
  field::ContactSet earlier, later, plain;
  for (field::ContactSet* set : {&earlier, &later, &plain}) set->reserve(part.points.size());
  std::vector<guard::PointPair> pairs(part.points.size());
  for (int n = 0; n < 12; ++n) {
    // Most poses follow each other closely; some are so high that points leave the scene.
    const glm::dvec3 up(0, 0, n % 5 == 4 ? uniform(random, 2, 6) : 0);
    const Pose pose{kS * (up + uniform(random, 0, 0.3) * random_direction(random)),
                    coupling::rotation_by(0.03 * random_direction(random))};
    std::swap(earlier, later);
    look.at(pose, later, random);
    // Some points have no slope, and some of those no side either, as a sheet's.
    for (std::uint32_t i = 0; i < later.count; ++i) {
      if (random() % 16 != 0) continue;
      look.samples.gx[i] = look.samples.gy[i] = look.samples.gz[i] = 0;
      if (random() % 2 == 0) look.points.nx[i] = look.points.ny[i] = look.points.nz[i] = 0;
    }
    plain = later;
    const std::int32_t* const object = look.objects.find();
    for (std::uint32_t i = 0; i < later.count; ++i) {
      ASSERT_EQ(static_cast<std::uint32_t>(object[i]), look.probe.object_of(i)) << i;
    }
    const float corner_m = 0.25f * s;
    const guard::SeatPress press{object,
                                 tables,
                                 look.in_seat_m.data(),
                                 has_corners ? look.in_seat_steepness.data() : nullptr,
                                 has_corners && n % 2 == 0,
                                 corner_m,
                                 n % 3 != 0};
    guard::press_points(look.probe, press, later);
    press_plainly(look, press, plain);
    expect_same(later, plain);
    found.pressed += later.seated;
    for (std::uint32_t i = 0; i < later.count; ++i) {
      found.undirected += later.of_seat[i] != 0 && later.depth_m[i] == 0 &&
                          look.probe.slope(i) == glm::vec3(0) &&
                          look.probe.normal(i) == glm::vec3(0);
    }
    found.freed += plain.surface > look.points.surface_count;
    std::uint32_t in_corners = 0;
    for (std::uint32_t i = 0; i < later.count; ++i) {
      in_corners += look.in_seat_steepness[look.probe.point(i)] < 1 &&
                    look.probe.stored_distance_m(i) < corner_m &&
                    glm::length(look.probe.slope(i)) <= guard::kFaceSlope;
    }
    EXPECT_EQ(guard::count_in_corners(look.probe, look.in_seat_steepness.data(), corner_m),
              in_corners);
    found.in_corners += in_corners;
    expect_tilted(look.probe, {1.2f * s, 0.4f * s, 0.01f, 0.04f, 0.2f * s, s * s});
    if (n == 0) continue;
    // Behind the end of the earlier set stand points that are in the later one.
    earlier.count -= static_cast<std::uint32_t>(random() % 20 % (earlier.count + 1));
    const auto expected =
        turned_plainly(look.probe, earlier, later, 0.87f * s, 0.9f, part.two_sided);
    const std::size_t count =
        guard::find_turned(look.probe, earlier, later, 0.87f * s, 0.9f, pairs.data());
    ASSERT_EQ(count, expected.size());
    for (std::size_t k = 0; k < count; ++k) {
      EXPECT_EQ(pairs[k].earlier, expected[k].first);
      EXPECT_EQ(pairs[k].later, expected[k].second);
    }
    found.turned += count;
    found.far += earlier.count != later.count;
  }
}

TEST_P(SeatKernel, IsThatOfSinglePoints) {
  Found found;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    try_poses(seed, found);
  }
  EXPECT_GT(found.pressed, 1000u);
  EXPECT_GT(found.freed, 10u);
  EXPECT_GT(found.turned, 1000u);
  EXPECT_GT(found.in_corners, 100u);
  EXPECT_GT(found.undirected, 100u);
  EXPECT_GT(found.far, 20u);
}

INSTANTIATE_TEST_SUITE_P(Targets, SeatKernel,
                         ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

}  // namespace
}  // namespace forcelayer::test
