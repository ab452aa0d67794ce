// The paper's model against its double-precision brute-force twin, along random motions.
#include <gtest/gtest.h>

#include <stdexcept>

#include "forcelayer/run.h"
#include "runtime/model/simulation.h"
#include "tests/support/random_scenes.h"
#include "tests/support/reference_step.h"

namespace forcelayer::test {
namespace {

constexpr double kDt = 0.001;

Run random_run(Random& random, const VoxelScene& scene, const PointPart& part) {
  RunRequest request;
  request.model = Model::kPaper;
  request.braking = random() % 2 == 0;
  request.device = {};
  request.device.max_force_n = request.device.max_torque_nm = 100;
  request.without_guarantee = true;
  auto run = open_run(make_voxmap(scene), make_pshell(part), request);
  if (!run) throw std::runtime_error(to_line(run.error()));
  return std::move(*run);
}

StepInput random_input(Random& random, const VoxelScene& scene, const Pose& around) {
  StepInput input;
  input.valid = 1;
  input.world_from_handle = around;
  input.world_from_handle.position_m +=
      random_direction(random) * scene.voxel_size_m * uniform(random, 0, 3);
  input.world_from_handle.orientation = glm::normalize(
      glm::angleAxis(uniform(random, 0, 3), random_direction(random)) * around.orientation);
  input.handle_velocity.linear_mps = random_direction(random) * uniform(random, 0, 1);
  input.handle_velocity.angular_radps = random_direction(random) * uniform(random, 0, 10);
  return input;
}

// Whether every point stands in the same voxel in both precisions.
bool voxels_agree(const std::vector<TwinPoint>& single, const std::vector<TwinPoint>& all) {
  std::size_t at = 0;
  for (const TwinPoint& t : all) {
    if (t.value == VoxelValue::kFree) continue;
    if (at == single.size() || single[at].index != t.index || single[at].voxel != t.voxel) {
      return false;
    }
    ++at;
  }
  return at == single.size();
}

struct Outcome {
  int compared = 0, touching = 0, averaged = 0, braked = 0;
};

void compare_frames(std::uint64_t seed, Outcome& outcome) {
  Random random(seed);
  const VoxelScene scene = random_scene(random, seed % 4 == 0 ? 1'000'000 : 0);
  const PointPart part = random_part(random, scene.voxel_size_m);
  Run run = random_run(random, scene, part);
  const Parameters& p = run.parameters();
  model::Simulation& simulation = run.simulation();
  for (int i = 0; i < 20; ++i) {
    const Pose start = random_pose(random, scene);
    State state = simulation.registered(start, start);
    state.velocity.linear_mps = random_direction(random) * uniform(random, 0, 2);
    state.velocity.angular_radps = random_direction(random) * uniform(random, 0, 20);
    const StepInput input = random_input(random, scene, start);
    const ReferenceFrame truth = reference_step(scene, part, p, state, input, kDt);
    if (!voxels_agree(float_twin(scene, part, state.world_from_center), truth.points)) continue;
    const State before = state;
    const StepResult result = simulation.step(state, input, kDt);
    ASSERT_EQ(result.report.faults, 0u);
    ++outcome.compared;
    outcome.touching += truth.contacts > 0;
    outcome.averaged += truth.surface >= 10;
    outcome.braked += p.braking && truth.proximity > 0;

    // Depth is wrong by the rounding bound and by s times the normal's rounding (4 units of 2^-24),
    // the direction by the latter; at most N / (N/10) = 10 forces of at most K_ff s sqrt(3)/2
    // count.
    const double s = p.voxel_size_m;
    const double depth_error_m = simulation.query().rounding_bound_m() + 8 * 0x1p-24 * s;
    const double forces = std::min<double>(truth.surface, 10);
    const double force_error_n = forces * p.field_n_per_m * (depth_error_m + 8 * 0x1p-24 * s);
    // Arms err by the rounding bound times the largest force; a millionth for the double
    // arithmetic.
    const double torque_error_nm =
        p.part_radius_m * force_error_n +
        forces * p.field_n_per_m * s * simulation.query().rounding_bound_m();
    // Braking changes with the direction of its sum, which the points' speeds (float arms) turn.
    const double braking_error_mps = p.braking ? 1e-4 * glm::length(before.velocity.linear_mps) : 0;
    const double velocity_scale =
        1 + glm::length(truth.velocity_mps) + glm::length(truth.angular_radps);
    const double inertia = p.inertia_kgm2[0][0];
    EXPECT_LE(glm::length(state.velocity.linear_mps - truth.velocity_mps),
              kDt / p.mass_kg * force_error_n + braking_error_mps + 1e-12 * velocity_scale);
    EXPECT_LE(glm::length(state.velocity.angular_radps - truth.angular_radps),
              kDt / inertia * torque_error_nm + 1e-9 * velocity_scale);
    EXPECT_LE(glm::length(result.wrench.force_n - truth.on_hand.force_n), 1e-9);
    EXPECT_LE(glm::length(result.wrench.torque_nm - truth.on_hand.torque_nm), 1e-9);
    EXPECT_EQ(result.report.interior, truth.interior);
    EXPECT_EQ(result.report.surface, truth.surface);
    EXPECT_EQ(result.report.proximity, truth.proximity);
  }
}

TEST(PaperModelProperty, AgreesWithTheDoubleReference) {
  Outcome outcome;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    compare_frames(seed, outcome);
    if (HasFailure()) return;
  }
  // The comparison must have met every case that it is about.
  EXPECT_GT(outcome.compared, 1000);
  EXPECT_GT(outcome.touching, 300);
  EXPECT_GT(outcome.averaged, 100);
  EXPECT_GT(outcome.braked, 300);
}

}  // namespace
}  // namespace forcelayer::test
