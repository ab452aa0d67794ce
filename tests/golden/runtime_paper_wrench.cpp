// The paper's force, bit for bit: what a later field or a faster query must leave as it is.
//
// At each pose the part is at rest and its handle is registered there, so the velocity after one
// step is the force field's and nothing else.
#include <gtest/gtest.h>

#include "runtime/model/simulation.h"
#include "tests/support/golden_sequence.h"
#include "tests/support/point_part.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.004;

// A floor, a wall at one of its ends, and a step in the corner.
VoxelScene scene() {
  return offset_scene(kS, {-24, -24, -6}, {48, 48, 40}, 2, [](Voxel v) {
    return v[2] <= 0 || v[0] >= 12 || (v[1] >= 6 && v[2] <= 5 && v[0] + v[1] >= 9);
  });
}

PointPart part() {
  PointPart part;
  part.voxel_size_m = kS;
  Sequence random;
  while (part.points.size() < 400) {
    const std::array<double, 3> d{random.next(), random.next(), random.next()};
    const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    if (length < 0.1 || length > 1) continue;
    const double r = 5 * kS / length;
    part.add({d[0] * r, d[1] * r, d[2] * r}, {-d[0], -d[1], -d[2]});
  }
  return part;
}

Parameters parameters() {
  Parameters p;
  p.model = Model::kPaper;
  p.force = ForceKind::kTangentPlane;
  p.voxel_size_m = kS;
  p.part_radius_m = 5 * kS;
  p.mass_kg = 0.012;
  p.inertia_kgm2 = glm::dmat3(0.4 * p.mass_kg * p.part_radius_m * p.part_radius_m);
  p.coupling_n_per_m = 1000;
  p.coupling_ns_per_m = 5;
  p.coupling_nm_per_rad = 1;
  p.coupling_nms_per_rad = 0.01;
  p.coupling_force_limit_n = p.coupling_torque_limit_nm = 10;
  p.field_n_per_m = 4000;
  p.max_force_n = p.max_torque_nm = 10;
  return p;
}

TEST(PaperGolden, WrenchesOfFourHundredPosesKeepTheirBits) {
  auto simulation =
      model::Simulation::create(make_voxmap(scene()), make_pshell(part()), parameters());
  ASSERT_TRUE(simulation) << to_line(simulation.error());
  Sequence random;
  GoldenHash hash;
  std::uint64_t contacts = 0, loaded = 0;
  for (int i = 0; i < 400; ++i) {
    Pose pose;
    // One after the other: compilers evaluate a call's arguments in orders of their own.
    const double qz = 0.5 + random.next() * 0.25, qy = random.next(), qx = random.next();
    const glm::dquat q(random.next(), qx, qy, qz);
    pose.orientation = q / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    const double z = 7.5 + random.next(), y = 8 * random.next();
    pose.position_m = kS * glm::dvec3(3 + 3 * random.next(), y, z);
    State state = (*simulation)->registered(pose, pose);
    StepInput input;
    input.valid = 1;
    input.world_from_handle = pose;
    const StepResult result = (*simulation)->step(state, input, 0.001);
    const double impulse[] = {state.velocity.linear_mps.x,    state.velocity.linear_mps.y,
                              state.velocity.linear_mps.z,    state.velocity.angular_radps.x,
                              state.velocity.angular_radps.y, state.velocity.angular_radps.z};
    const std::uint32_t counts[] = {result.report.interior, result.report.surface,
                                    result.report.proximity, result.report.contacts};
    hash.add(impulse);
    hash.add(counts);
    contacts += result.report.contacts;
    loaded += impulse[2] != 0;
  }
  // The poses are worth hashing: most of them press on something.
  EXPECT_GT(loaded, 200u);
  EXPECT_GT(contacts, 2000u);
  EXPECT_EQ(hash.value(), 8093137438003303288u)
      << "impulses or counts of the paper's model changed";
}

}  // namespace
}  // namespace forcelayer::test
