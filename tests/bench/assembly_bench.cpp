// Assembly tasks that others can run with their own renderer:
//
//   assembly_bench peg [SEEDS]      a peg into a hole, by clearance, chamfer and tilt
//   assembly_bench nut [SEEDS]      a nut turned and pulled on an M20 thread, by play
//   assembly_bench meshes FOLDER    the meshes of both, as OBJ files in millimeters
//
// --short makes fewer of each. Seeds run from 1. --json FILE writes the report elsewhere.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <stdexcept>

#include "formats/guard.h"
#include "runtime/coupling/coupling.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/run/separation.h"
#include "tests/bench/assembly_bench_meshes.h"
#include "tests/bench/bench_report.h"
#include "tests/stress/exact_distance.h"
#include "tests/stress/shapes.h"
#include "tests/stress/trial.h"
#include "tests/support/random_numbers.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;
using stress::BakedPart;
using stress::BakedScene;
using test::Random;
using test::random_direction;
using test::uniform;

constexpr double kDtS = 1e-3;

struct Choice {
  std::string what, folder, json;
  int seeds = 0;  // 0: as the task has it
  bool brief = false;

  int seeds_or(int usual, int few) const { return seeds > 0 ? seeds : brief ? few : usual; }
};

// A scene stands anywhere on the grid, turned at random.
Pose random_frame(Random& random) {
  const glm::dvec3 origin(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
  return {origin, coupling::rotation_by(random_direction(random) * uniform(random, 0, M_PI))};
}

mesh::Mesh moved(const mesh::Mesh& mesh, const Pose& pose) {
  mesh::Mesh result;
  result.single_precision = false;
  stress::append(result, mesh, pose);
  return result;
}

double guaranteed_m(const model::Simulation& simulation) {
  const VoxmapHeader& scene = simulation.voxmap().header();
  const DistanceGuard guard{guard_distance_m(scene), simulation.shell().surface_distance_terms()};
  return separation_guarantee(scene, simulation.shell().header(),
                              simulation.query().rounding_bound_m(), guard)
      .tested_m.value_or(0);
}

// --- the peg

constexpr double kPegVoxelM = 0.0002, kStandoffVoxels = 1.3;
constexpr double kMissM = 0.001, kAboveM = 0.003, kDeepM = 0.018, kInM = 0.015;

// The hand draws the peg down with its tip aside of the axis and the peg aslant, and does not mend
// either: what guides the peg is the hole.
stress::Trial peg_trial(double clearance_m, double chamfer_m, double tilt_deg, double standoff_m,
                        const std::shared_ptr<const BakedPart>& part, int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  const Pose frame = random_frame(random);
  const double toward = uniform(random, 0, 2 * M_PI), miss = uniform(random, 0, kMissM);
  const double about = uniform(random, 0, 2 * M_PI);
  const glm::dvec3 aside = miss * glm::dvec3(std::cos(toward), std::sin(toward), 0);
  const glm::dquat aslant = coupling::rotation_by(tilt_deg * M_PI / 180 *
                                                  glm::dvec3(std::cos(about), std::sin(about), 0));
  stress::Trial trial;
  trial.scene = std::make_shared<BakedScene>(moved(plate_with_hole(clearance_m, chamfer_m), frame),
                                             kPegVoxelM, standoff_m);
  trial.part = part;
  trial.hand.emplace();
  trial.duration_s = 0.8;
  trial.slide_from_s = 0;
  trial.slide_direction = frame.orientation * glm::dvec3(0, 0, -1);
  trial.target = [=](double t) {
    const double depth = std::min(kDeepM, -kAboveM + 0.04 * t);
    const glm::dvec3 tip = aside + glm::dvec3(0, 0, -depth);
    return frame * Pose{tip + aslant * glm::dvec3(0, 0, kPegLengthM / 2), aslant};
  };
  trial.start = trial.target(0);
  return trial;
}

Json peg_table(const Choice& choice) {
  const std::vector<double> clearances_mm =
      choice.brief ? std::vector{0.6, 1.2} : std::vector{0.3, 0.5, 0.6, 0.8, 1.2, 1.6};
  const std::vector<double> chamfers_mm =
      choice.brief ? std::vector{0.0, 1.0} : std::vector{0.0, 0.5, 1.0, 2.0};
  const std::vector<double> tilts_deg =
      choice.brief ? std::vector{0.0, 2.0} : std::vector{0.0, 2.0, 4.0};
  const int seeds = choice.seeds_or(20, 2);
  const auto part = std::make_shared<const BakedPart>(peg(), kPegVoxelM);
  Json rows = Json::array();
  for (const double standoff : {0.0, kStandoffVoxels}) {
    for (const double clearance_mm : clearances_mm) {
      for (const double chamfer_mm : chamfers_mm) {
        for (const double tilt_deg : tilts_deg) {
          stress::Metrics sum;
          int in = 0;
          for (int seed = 1; seed <= seeds; ++seed) {
            stress::Trial trial = peg_trial(clearance_mm * 1e-3, chamfer_mm * 1e-3, tilt_deg,
                                            standoff * kPegVoxelM, part, seed);
            trial.exact_distance = seed == 1 && tilt_deg == tilts_deg.back();  // seconds each
            const stress::Metrics m = stress::run(trial, Model::kDefault);
            in += !m.progress.empty() && m.progress[0] * (kDeepM + kAboveM) > kInM + kAboveM;
            sum.add(m);
          }
          rows.push_back({{"map", standoff > 0 ? "standoff 1.3" : "two layers"},
                          {"voxel_m", kPegVoxelM},
                          {"clearance_m", clearance_mm * 1e-3},
                          {"chamfer_m", chamfer_mm * 1e-3},
                          {"tilt_deg", tilt_deg},
                          {"trials", seeds},
                          {"in", in},
                          {"frames", sum.frames},
                          {"penetrating_frames", sum.penetration_frames},
                          {"nearest_m", sum.distances_visited > 0 ? Json(sum.smallest_distance_m)
                                                                  : Json(nullptr)},
                          {"guaranteed_m", sum.guaranteed_m}});
          std::printf(
              "peg: %-12s clearance %.1f mm chamfer %.1f mm tilt %g deg: %d of %d in, %llu "
              "penetrating, proven %.3f mm\n",
              standoff > 0 ? "standoff 1.3" : "two layers", clearance_mm, chamfer_mm, tilt_deg, in,
              seeds, static_cast<unsigned long long>(sum.penetration_frames),
              1e3 * sum.guaranteed_m);
          std::fflush(stdout);
        }
      }
    }
  }
  return rows;
}

// --- the nut

struct NutRow {
  double play_m, voxel_m, standoff_voxels;
};
constexpr NutRow kNutRows[] = {{0.0012, 0.0001, 0},
                               {0.0008, 0.0001, 0},
                               {0.0008, 0.0001, 1.3},
                               {0.0006, 0.0001, 1.3},
                               {0.000436, 0.000075, 1.3}};

constexpr int kJudgedEvery = 150;  // frames: between threads an exact distance takes a second

struct Screwed {
  double turned_rad = 0, advance_m = 0;
  std::uint64_t frames = 0, penetrating = 0;
  double nearest_m = 1e300, guaranteed_m = 0;
  std::vector<double> step_us;  // of processor time
  bool starts_inside = false;   // the guard bars the start: nothing was simulated
};

// A hand on the nut wants what `wanted` says, in the bolt's frame.
template <class Wanted>
Screwed screw(const stress::Trial& trial, const Pose& frame, double seconds, const Wanted& wanted) {
  const auto simulation = stress::make_simulation(trial, Model::kDefault);
  const stress::ExactDistance exact(trial.scene->mesh(), trial.part->mesh());
  devices::SimHand hand({}, frame);
  State state = simulation->registered(frame, frame);
  Screwed out;
  out.guaranteed_m = guaranteed_m(*simulation);
  loop::HandleVelocity velocity;
  Wrench felt;
  Pose last;
  for (int i = 0; i < static_cast<int>(seconds / kDtS); ++i) {
    StepInput input;
    input.world_from_handle = hand.step(frame * wanted(i * kDtS), felt, kDtS);
    input.handle_velocity = velocity.update(input.world_from_handle, kDtS);
    input.valid = kInputValid;
    const double before_s = cpu_s();
    const StepResult result = simulation->step(state, input, kDtS);
    out.step_us.push_back(1e6 * (cpu_s() - before_s));
    if (i == 0 && result.report.interior > 0) {
      out.starts_inside = true;
      return out;
    }
    felt = result.at_handle;
    ++out.frames;
    out.penetrating += result.report.interior > 0;
    const Pose at = simulation->world_from_part(result.report.world_from_center);
    if (i % kJudgedEvery == 0) out.nearest_m = std::min(out.nearest_m, exact.at(at, out.nearest_m));
    const Pose in_bolt = inverse(frame) * at;
    out.turned_rad +=
        coupling::rotation_vector(in_bolt.orientation * glm::conjugate(last.orientation)).z;
    out.advance_m = in_bolt.position_m.z;
    last = in_bolt;
  }
  return out;
}

Json nut_table(const Choice& choice) {
  Json rows = Json::array();
  const int seeds = choice.seeds_or(8, 1);
  for (const NutRow& row : kNutRows) {
    if (choice.brief && row.play_m != 0.0012) continue;
    const auto part = std::make_shared<const BakedPart>(nut(row.play_m), row.voxel_m);
    int turned = 0, held = 0, refused = 0;
    std::vector<double> lead, pulled_m;
    Screwed sum;
    for (int seed = 1; seed <= seeds; ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const Pose frame = random_frame(random);
      stress::Trial trial;
      trial.scene = std::make_shared<BakedScene>(moved(bolt(), frame), row.voxel_m,
                                                 row.standoff_voxels * row.voxel_m);
      trial.part = part;
      trial.voxels = test::VoxelKind::kFull;
      // Half a turn in half a second, without a pull along the axis: the thread leads the nut.
      const Screwed turn = screw(trial, frame, 0.6, [](double t) {
        return Pose{glm::dvec3(0), coupling::rotation_by({0, 0, 2 * M_PI * std::min(t, 0.5)})};
      });
      if (turn.starts_inside) {
        ++refused;
        sum.guaranteed_m = turn.guaranteed_m;
        continue;
      }
      // As hard along the axis as hand and device can, without a turn.
      const Screwed pull = screw(trial, frame, 0.3, [](double t) {
        return Pose{glm::dvec3(0, 0, 0.1 * std::min(1.0, t / 0.2)), {1, 0, 0, 0}};
      });
      const double turns = turn.turned_rad / (2 * M_PI);
      turned += turns > 0.475;
      held += std::abs(pull.advance_m) < kPitchM / 2;
      if (turns > 0.1) lead.push_back(turn.advance_m / turns / kPitchM);
      pulled_m.push_back(std::abs(pull.advance_m));
      for (const Screwed& one : {turn, pull}) {
        sum.frames += one.frames, sum.penetrating += one.penetrating;
        sum.nearest_m = std::min(sum.nearest_m, one.nearest_m);
        sum.guaranteed_m = one.guaranteed_m;
        sum.step_us.insert(sum.step_us.end(), one.step_us.begin(), one.step_us.end());
      }
    }
    const double median_lead = lead.empty() ? NAN : percentiles(lead).p50;
    rows.push_back(
        {{"map", row.standoff_voxels > 0 ? "standoff 1.3" : "two layers"},
         {"voxel_m", row.voxel_m},
         {"play_m", row.play_m},
         {"room_voxels", row.play_m / 2 / row.voxel_m},
         {"points", part->open().header().point_count},
         {"trials", seeds},
         {"starts_inside", refused},
         {"turned", turned},
         {"lead_pitches", lead.empty() ? Json(nullptr) : Json(median_lead)},
         {"held", held},
         {"pulled_m", pulled_m.empty() ? Json(nullptr) : Json(percentiles(pulled_m).max)},
         {"frames", sum.frames},
         {"frame_p50_us", sum.step_us.empty() ? Json(nullptr) : Json(percentiles(sum.step_us).p50)},
         {"penetrating_frames", sum.penetrating},
         {"nearest_m", sum.frames > 0 ? Json(sum.nearest_m) : Json(nullptr)},
         {"guaranteed_m", sum.guaranteed_m}});
    if (sum.frames == 0) {
      std::printf("nut: voxel %.3f mm play %.3f mm: the start is inside\n", 1e3 * row.voxel_m,
                  1e3 * row.play_m);
      continue;
    }
    std::printf(
        "nut: %-12s voxel %.3f mm play %.3f mm (%.1f voxels): %d of %d turned, %.3f pitches "
        "a turn, %d held within %.3f mm, %llu penetrating, nearest %.4f mm, proven %.4f mm; frame "
        "%.0f us\n",
        row.standoff_voxels > 0 ? "standoff 1.3" : "two layers", 1e3 * row.voxel_m,
        1e3 * row.play_m, row.play_m / 2 / row.voxel_m, turned, seeds, median_lead, held,
        1e3 * percentiles(pulled_m).max, static_cast<unsigned long long>(sum.penetrating),
        1e3 * sum.nearest_m, 1e3 * sum.guaranteed_m, percentiles(sum.step_us).p50);
    std::fflush(stdout);
  }
  return rows;
}

void write_meshes(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_obj(peg(), folder / "peg.obj");
  for (const int clearance_um : {300, 500, 600, 800, 1200, 1600}) {
    for (const int chamfer_um : {0, 500, 1000, 2000}) {
      write_obj(plate_with_hole(1e-6 * clearance_um, 1e-6 * chamfer_um),
                folder / ("plate_" + std::to_string(clearance_um) + "um_chamfer_" +
                          std::to_string(chamfer_um) + "um.obj"));
    }
  }
  write_obj(bolt(), folder / "bolt_m20.obj");
  for (const NutRow& row : kNutRows) {
    write_obj(nut(row.play_m),
              folder / ("nut_m20_" + std::to_string(std::lround(1e6 * row.play_m)) + "um.obj"));
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Assembly tasks that others can run", "assembly_bench"};
  Choice choice;
  std::string amount;
  app.add_option("task", choice.what, "peg, nut or meshes")
      ->required()
      ->check(CLI::IsMember({"peg", "nut", "meshes"}));
  app.add_option("amount", amount, "seeds; of meshes, the folder");
  app.add_flag("--short", choice.brief, "fewer of each");
  app.add_option("--json", choice.json, "report; by default under build/bench");
  CLI11_PARSE(app, argc, argv);
  if (choice.what == "meshes") {
    write_meshes(amount.empty() ? "." : amount);
    return 0;
  }
  if (!amount.empty()) choice.seeds = std::stoi(amount);
  const Json results = choice.what == "peg" ? peg_table(choice) : nut_table(choice);
  write_report("assembly_" + choice.what, argc, argv, results, choice.json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("assembly_bench", forcelayer::bench::run, argc, argv);
}
