// The default model's motion, bit for bit, on every width of vectors that this machine has: a
// change of these hashes is a change of what a hand feels.
//
// A part, held aside of its centroid, is pressed on a floor, thrown into a wall, turned there, led
// over a step and lifted off.
// Scene, part and hand are computed here (golden_sequence.h). The step itself calls sin, cos, atan2
// and exp of the C library, whose last bits depend on whether the processor has FMA. The library is
// recognized by a hash of those functions' own results; with an unknown one the test is skipped.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "forcelayer/run.h"
#include "runtime/model/simulation.h"
#include "tests/support/distance_scene.h"
#include "tests/support/every_target.h"
#include "tests/support/golden_sequence.h"
#include "tests/support/point_part.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.004, kDt = 0.001;
constexpr int kFrames = 4000;
const Voxel kMin{-24, -24, -6}, kDims{64, 48, 40};

// A floor, a wall at one of its ends, and a step along one side.
double distance_m(const glm::dvec3& p) {
  const double step = std::max(p.z - 4.3 * kS, 7.6 * kS - p.y);
  return std::min({p.z - 0.3 * kS, 18.6 * kS - p.x, step});
}

Voxmap map_with_distances() {
  return make_voxmap(distance_scene(kS, kMin, kDims, distance_m, 2, DistanceDefinition(2)));
}

Voxmap map_of_two_bits() {
  return make_voxmap(offset_scene(kS, kMin, kDims, 2, [](Voxel v) {
    return v[2] <= 0 || v[0] >= 18 || (v[1] >= 7 && v[2] <= 4);
  }));
}

// An ellipsoid: turned against the wall it is pushed back.
PointPart part() {
  PointPart part;
  part.voxel_size_m = kS;
  part.covering_radius_m = 0.8 * kS;
  const glm::dvec3 axes_m = kS * glm::dvec3(7, 4, 3);
  Sequence random;
  while (part.points.size() < 500) {
    const double x = random.next(), y = random.next(), z = random.next();
    const glm::dvec3 d(x, y, z);
    const double length = glm::length(d);
    if (length < 0.1 || length > 1) continue;
    const glm::dvec3 point = axes_m * (d / length), inward = -(d / length) / axes_m;
    part.add({point.x, point.y, point.z}, {inward.x, inward.y, inward.z});
  }
  for (int axis = 0; axis < 3; ++axis) {
    part.inertia_m2[axis] = (glm::dot(axes_m, axes_m) - axes_m[axis] * axes_m[axis]) / 5;
  }
  return part;
}

struct Way {
  int frame;
  glm::dvec3 position_voxels;
  glm::dquat orientation;  // of any length
};

// Between two of these the hand goes straight, and turns at almost constant speed.
const Way kWays[] = {
    {0, {0, -6, 12}, {1, 0, 0, 0}},
    {400, {0, -6, 4}, {1, 0, 0, 0}},
    {800, {4, -5, 4.5}, {1, 0, 0.1, 0}},
    {820, {16, -5, 4}, {1, 0, 0.2, 0.1}},  // 2.4 m/s
    {1600, {15, -4, 5}, {0.8, 0.1, 0.1, 0.6}},
    {2400, {4, 3, 4}, {0.9, -0.4, 0.2, 0.3}},
    {3000, {2, 9, 7}, {1, 0.1, -0.3, 0.2}},
    {3010, {2, 9, 13}, {1, 0.1, -0.3, 0.2}},
    {3020, {2, 10, 3}, {1, 0.1, -0.1, 0.2}},  // 4 m/s
    {3600, {-4, 8, 8}, {1, 0.3, 0.2, -0.1}},
    {kFrames, {-4, 0, 18}, {1, 0, 0, 0}},
};

Pose hand_at(int frame) {
  const Way* to = kWays + 1;
  while (to->frame < frame) ++to;
  const Way& from = to[-1];
  const double t = double(frame - from.frame) / (to->frame - from.frame);
  const auto mixed = [t](const auto& a, const auto& b) { return a * (1 - t) + b * t; };
  const glm::dquat q = mixed(from.orientation, to->orientation);
  return {kS * mixed(from.position_voxels, to->position_voxels), q / glm::length(q)};
}

// The grip: two voxels above the centroid, aside, and turned.
Pose handle_from_part() {
  return {kS * glm::dvec3(1, -1, -2), glm::normalize(glm::dquat(1, 0.02, -0.04, 0.05))};
}

// The functions of the C library that a step calls.
enum class Libm { kGlibcFma, kGlibcPlain, kOther };

Libm libm() {
  GoldenHash hash;
  Sequence random;
  for (int i = 0; i < 10000; ++i) {
    const double a = random.next(), b = random.next();
    const double results[] = {std::sin(3 * a), std::cos(3 * a), std::atan2(a, std::abs(b)),
                              std::exp(b / 10)};
    hash.add(results);
  }
  switch (hash.value()) {
    case 3722961407646249911u:
      return Libm::kGlibcFma;
    case 6383897049871156538u:
      return Libm::kGlibcPlain;
    default:
      return Libm::kOther;
  }
}

class DefaultGolden : public EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, DefaultGolden,
                         testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

void expect_motion(Voxmap voxmap, ForceKind force, std::uint64_t with_fma,
                   std::uint64_t without_fma) {
  SCOPED_TRACE(to_text(force));
  auto run = open_run(std::move(voxmap), make_pshell(part()), {});
  ASSERT_TRUE(run) << to_line(run.error());
  ASSERT_EQ(run->parameters().force, force);
  model::Simulation& simulation = run->simulation();
  State state = simulation.registered(PartStart{{}, handle_from_part()}, hand_at(0));
  GoldenHash hash;
  int touching = 0, saturated = 0;
  for (int frame = 1; frame <= kFrames; ++frame) {
    const Pose last = hand_at(frame - 1);
    StepInput input;
    input.valid = kInputValid;
    input.world_from_handle = hand_at(frame);
    input.handle_velocity.linear_mps = (input.world_from_handle.position_m - last.position_m) / kDt;
    const glm::dquat turn = input.world_from_handle.orientation * glm::conjugate(last.orientation);
    input.handle_velocity.angular_radps = 2.0 * glm::dvec3(turn.x, turn.y, turn.z) / kDt;
    const StepResult result = simulation.step(state, input, kDt);
    const Pose& at = state.world_from_center;
    const Twist& v = state.velocity;
    const Wrench& w = result.wrench;
    const double moved[] = {
        at.position_m.x,   at.position_m.y,   at.position_m.z,   at.orientation.w, at.orientation.x,
        at.orientation.y,  at.orientation.z,  v.linear_mps.x,    v.linear_mps.y,   v.linear_mps.z,
        v.angular_radps.x, v.angular_radps.y, v.angular_radps.z, w.force_n.x,      w.force_n.y,
        w.force_n.z,       w.torque_nm.x,     w.torque_nm.y,     w.torque_nm.z};
    const StepReport& r = result.report;
    const std::uint32_t counts[] = {r.interior, r.surface,    r.proximity,
                                    r.contacts, r.guard_cuts, r.saturated};
    hash.add(moved);
    hash.add(counts);
    touching += r.contacts > 0;
    saturated += r.saturated > 0;
    ASSERT_EQ(r.interior, 0u) << frame;
  }
  // The motion is worth hashing.
  EXPECT_GT(touching, kFrames / 2);
  EXPECT_GT(saturated, 10);
  const Libm library = libm();
  if (library == Libm::kOther) GTEST_SKIP() << "unknown C library: hash " << hash.value();
  EXPECT_EQ(hash.value(), library == Libm::kGlibcFma ? with_fma : without_fma)
      << "the default model moves otherwise: " << touching << " frames in contact, " << saturated
      << " saturated";
}

TEST_P(DefaultGolden, MotionOverStoredDistancesKeepsItsBits) {
  expect_motion(map_with_distances(), ForceKind::kDistance, 2215155518966604185u,
                15183519394237055388u);
}

TEST_P(DefaultGolden, MotionOverTwoBitsKeepsItsBits) {
  expect_motion(map_of_two_bits(), ForceKind::kLevel, 16421272363196204810u, 97001755497834435u);
}

}  // namespace
}  // namespace forcelayer::test
