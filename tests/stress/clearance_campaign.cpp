#include "tests/stress/clearance_campaign.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "runtime/model/simulation.h"
#include "runtime/run/derive_parameters.h"
#include "tests/stress/provable_distance.h"

namespace forcelayer::stress {
namespace {

// Shell points from which on the slow twin is asked at one pose in ten.
constexpr std::uint64_t kManyPoints = 2000;
// Rounding of the slow twin, in voxels.
constexpr double kRoundingVoxels = 1e-6;

std::unique_ptr<model::Simulation> simulation_of(const BakedClearance& baked) {
  Voxmap map = baked.open_scene();
  Pshell shell = baked.open_part();
  const auto derived = derive_parameters(RunRequest{}, map, shell);
  if (!derived) throw std::runtime_error(to_line(derived.error()));
  auto simulation = model::Simulation::create(std::move(map), std::move(shell), derived->values);
  if (!simulation) throw std::runtime_error(to_line(simulation.error()));
  return std::move(*simulation);
}

double band_end_m(const model::Simulation& simulation) {
  const VoxmapHeader& scene = simulation.voxmap().header();
  const PshellHeader& part = simulation.shell().header();
  const double bound_m =
      surface_distance_bound_m(simulation.shell().surface_distance_terms(), free_distance_m(scene));
  return bound_m - scene.static_deviation_m - part.part_deviation_m -
         simulation.query().rounding_bound_m();
}

}  // namespace

std::vector<JudgedPose> judge_scene(const ClearanceScene& scene, std::uint64_t seed, int poses) {
  const BakedClearance baked(scene);
  const auto simulation = simulation_of(baked);
  const ClearanceJudge judge(scene.objects, scene.part, scene.voxel_size_m);
  const ProvableDistance provable(simulation->voxmap(), simulation->shell());
  const double s = scene.voxel_size_m, band_end = band_end_m(*simulation) / s;
  const std::uint64_t points = simulation->shell().view().point_count;
  Approach approach(scene, seed);
  std::vector<JudgedPose> judged;
  std::uint64_t near_poses = 0;
  Pose pose = approach.begin();
  while (judged.size() < static_cast<std::size_t>(poses)) {
    State state = simulation->registered(pose, pose);
    StepInput input;
    input.world_from_handle = pose;
    input.valid = kInputValid;
    const StepReport report = simulation->step(state, input, 0.001).report;
    // Where the frame was: contacts may have moved the part.
    const Pose at = simulation->world_from_part(report.world_from_center);
    const JudgedClearance truth = judge.judge(at, claim_of(report));
    JudgedPose frame;
    frame.exact = truth.exact_m / s;
    frame.claimed = report.clearance_m / s;
    frame.band_end = band_end;
    frame.kind = report.clearance_kind;
    frame.premise_failed = report.outside_map != 0 || provable.touches_cropped_side(at);
    frame.too_much = truth.too_much;
    frame.object = truth.object;
    const bool near = frame.exact < kNearVoxels && !frame.premise_failed;
    if (near && (points < kManyPoints || near_poses++ % 10 == 0)) {
      frame.provable = provable.of_part_m(at) / s;
      frame.too_much |= frame.claimed > frame.provable + kRoundingVoxels;
    }
    if (frame.exact < kFarVoxels || frame.too_much) judged.push_back(frame);
    pose = approach.next(at, truth.exact_m);
  }
  return judged;
}

Spread spread_of(std::vector<double> sample) {
  if (sample.empty()) return {};
  std::sort(sample.begin(), sample.end());
  return {sample[sample.size() / 2], sample[sample.size() * 99 / 100], sample.back()};
}

ClearanceSummary summary_of(std::span<const JudgedPose> poses, double from, double to) {
  ClearanceSummary summary;
  std::vector<double> slack;
  for (const JudgedPose& pose : poses) {
    const double end = to > 0 ? to : pose.band_end;
    if (pose.premise_failed || pose.exact < from || pose.exact >= end) continue;
    ++summary.poses;
    summary.without += pose.kind == ClearanceKind::kNone;
    summary.too_much += pose.too_much;
    slack.push_back(pose.exact - pose.claimed);
  }
  summary.slack = spread_of(std::move(slack));
  return summary;
}

ObjectSummary objects_of(std::span<const JudgedPose> poses) {
  ObjectSummary summary;
  for (const JudgedPose& pose : poses) {
    summary.right += pose.object == ObjectVerdict::kRight;
    summary.wrong += pose.object == ObjectVerdict::kWrong;
    summary.ties += pose.object == ObjectVerdict::kTie;
  }
  return summary;
}

}  // namespace forcelayer::stress
